#include "sim_board/engine/ode/touch.h"

#include <algorithm>
#include <cmath>

#include "sim_board/engine/common/model_constants.h"
#include "sim_board/engine/ode/eigen.h"
#include "sim_board/engine/ode/library.h"

namespace koboshi::sim_board {
namespace {

// A smaller normal force is rounding.
constexpr double kMinNormal_N = 1e-6;

// A surface without friction along the first direction exchanges the directions, since a law has always a
// first one.
bool exchanges_directions(const dSurfaceParameters& surface) { return !(surface.mu > 0.0); }

Eigen::Vector2d along(const std::array<Eigen::Vector3d, 2>& axes_W, const Eigen::Vector3d& vector_W) {
  return {axes_W[0].dot(vector_W), axes_W[1].dot(vector_W)};
}

}  // namespace

double Touch::mass_kg() const {
  dMass mass;
  dBodyGetMass(body, &mass);
  return mass.mass;
}

Eigen::Vector3d Touch::velocity_after(double step_s) const {
  const Eigen::Vector3d p_W = vector_of(contact.geom.pos);
  const auto velocity = [&](dBodyID of) {
    const Eigen::Vector3d v_WCom_W = vector_of(dBodyGetLinearVel(of));
    const Eigen::Vector3d p_WCom_W = vector_of(dBodyGetPosition(of)) - step_s * v_WCom_W;
    return Eigen::Vector3d(v_WCom_W + vector_of(dBodyGetAngularVel(of)).cross(p_W - p_WCom_W));
  };
  Eigen::Vector3d velocity_W = velocity(body);
  if (other_body != nullptr) velocity_W -= velocity(other_body);
  return velocity_W;
}

// With force-dependent slip, the law is about the velocity beyond it.
FrictionSolution Touch::solution(const Eigen::Vector3d& f_W, const Eigen::Vector3d& v_W) const {
  FrictionSolution found{.normal = f_W.dot(vector_of(contact.geom.normal)), .friction = along(axes_W, f_W)};
  found.velocity = along(axes_W, v_W);
  if (slips()) found.velocity += contact.surface.slip1 * found.friction;
  return found;
}

FrictionLaw friction_law(const dSurfaceParameters& surface) {
  return exchanges_directions(surface) ? FrictionLaw{surface.mu2, 0.0} : FrictionLaw{surface.mu, surface.mu2};
}

std::array<Eigen::Vector3d, 2> friction_axes(const dContact& contact) {
  dVector3 first;
  dVector3 second;
  dPlaneSpace(contact.geom.normal, first, second);
  if ((contact.surface.mode & dContactFDir1) != 0) {
    copy_vector(vector_of(contact.fdir1), first);
    copy_vector(vector_of(contact.geom.normal).cross(vector_of(contact.fdir1)), second);
  }
  const Eigen::Vector3d first_W = vector_of(first);
  const Eigen::Vector3d second_W = vector_of(second);
  if (exchanges_directions(contact.surface)) return {second_W, -first_W};
  return {first_W, second_W};
}

// Without a guess of the normal force, ODE bounds friction by the normal force in the absence of friction.
dContact ode_contact(const Touch& touch, double target_m_per_s) {
  dContact contact = touch.contact;
  contact.geom.depth = 0.0;
  dSurfaceParameters& surface = contact.surface;
  surface.motionN = target_m_per_s;
  surface.soft_cfm = touch.normal.force_mixing;
  const bool is_loaded = touch.guess.normal > kMinNormal_N;
  const FrictionRows rows = friction_rows(touch.friction, touch.guess);
  FrictionRows bounds = rows;
  if (!is_loaded) {
    bounds = friction_rows(touch.friction, {.normal = 1.0, .against = touch.guess.against});
    surface.mode |= dContactApprox1;
  }
  surface.mu = bounds.bounds[0];
  surface.mu2 = bounds.bounds[1];
  surface.mode |= dContactFDir1;
  copy_vector(rows.first.x() * touch.axes_W[0] + rows.first.y() * touch.axes_W[1], contact.fdir1);
  if (is_loaded && rows.softness > 0.0) {
    surface.mode |= dContactSlip2 | dContactMotion2;
    surface.slip2 = rows.softness + (touch.slips() ? surface.slip1 : kStickingForceMixing);
    surface.motion2 = rows.target();
  }
  return contact;
}

}  // namespace koboshi::sim_board
