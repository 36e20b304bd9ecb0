#include "sim_board/engine/ode/soles.h"

#include <algorithm>
#include <cmath>

#include "sim_board/engine/ode/eigen.h"

namespace koboshi::sim_board {
namespace {

constexpr std::size_t kMinPoints = 3;
constexpr double kSameDirection = 1e-9;  // 1 - cosine
// Minimum width of the area that the points of a held sole span.
constexpr double kMinWidth_m = 1e-3;
// A sole is held after it has rested for this long, which delays soles whose load wanders to an edge.
constexpr double kRest_s = 0.01;
// Speed limit of a resting sole: far above the creep of friction rows, below the speed of sliding.
constexpr double kAtRest_m_per_s = 1e-6;

bool can_be_held(const dSurfaceParameters& surface) {
  constexpr int kNeither = dContactSlip1 | dContactSlip2 | dContactMotion1 | dContactMotion2;
  return surface.bounce == 0.0 && (surface.mode & kNeither) == 0;
}

bool alike(const dSurfaceParameters& one, const dSurfaceParameters& other) {
  return one.soft_erp == other.soft_erp && one.soft_cfm == other.soft_cfm;
}

double friction(const dSurfaceParameters& surface) {
  return (surface.mode & dContactMu2) != 0 ? std::min(surface.mu, surface.mu2) : surface.mu;
}

// Returns whether the points span an area.
bool is_wide(std::span<const Contact> contacts) {
  Eigen::Vector3d longest = Eigen::Vector3d::Zero();
  for (const Contact& contact : contacts) {
    const Eigen::Vector3d way = contact.p_W - contacts.front().p_W;
    if (way.squaredNorm() > longest.squaredNorm()) longest = way;
  }
  const double length_m = longest.norm();
  return length_m > kMinWidth_m && std::ranges::any_of(contacts, [&](const Contact& contact) {
           return longest.cross(contact.p_W - contacts.front().p_W).norm() > kMinWidth_m * length_m;
         });
}

}  // namespace

Soles::Soles(const RobotDescription& robot, const Bodies& bodies, double step_s)
    : step_s_(step_s), sole_of_link_(robot.links.size(), -1) {
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    if (robot.links[l].collisions.empty()) continue;
    sole_of_link_[l] = static_cast<int>(soles_.size());
    const dBodyID body = bodies.of(static_cast<int>(l));
    const int index = static_cast<int>(bodies.index_of(static_cast<int>(l)));
    soles_.push_back({.held = HeldSole(body, index), .body = body});
  }
  points_.reserve(HeldSole::kMaxSolePoints);
}

// The contacts of a link with the ground are consecutive.
void Soles::guess(const Collider& collider) {
  for (Sole& sole : soles_) sole.count = 0;
  const std::span<const Contact> contacts = collider.contacts();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].other_link >= 0) continue;
    Sole& sole = soles_[static_cast<std::size_t>(sole_of_link_[static_cast<std::size_t>(contacts[i].link)])];
    if (sole.count == 0) sole.first = i;
    ++sole.count;
  }
  for (Sole& sole : soles_) {
    look_at(sole, collider);
    if (sole.eligible && sole.stands) {
      hold(sole, collider);
    } else {
      sole.held.let_go();
    }
  }
}

void Soles::look_at(Sole& sole, const Collider& collider) {
  sole.eligible = false;
  if (sole.count < kMinPoints || sole.count > HeldSole::kMaxSolePoints) return;
  const auto contacts = collider.contacts().subspan(sole.first, sole.count);
  const auto touches = collider.touches().subspan(sole.first, sole.count);
  sole.friction = dInfinity;
  for (std::size_t i = 0; i < sole.count; ++i) {
    if (contacts[i].link != contacts[0].link || contacts[i].other_link >= 0 || contacts[i].depth_m < 0.0)
      return;
    if (!can_be_held(touches[i].contact.surface) ||
        !alike(touches[i].contact.surface, touches[0].contact.surface))
      return;
    if (contacts[i].n_W.dot(contacts[0].n_W) < 1.0 - kSameDirection) return;
    sole.friction = std::min(sole.friction, friction(touches[i].contact.surface));
  }
  sole.eligible = is_wide(contacts);
}

void Soles::hold(Sole& sole, const Collider& collider) {
  const auto contacts = collider.contacts().subspan(sole.first, sole.count);
  const auto touches = collider.touches().subspan(sole.first, sole.count);
  points_.clear();
  for (std::size_t i = 0; i < sole.count; ++i)
    points_.push_back({contacts[i].p_W, touches[i].contact.geom.depth});
  const dSurfaceParameters& surface = touches[0].contact.surface;
  sole.held.hold(points_, contacts[0].n_W, surface.soft_erp, surface.soft_cfm, step_s_);
}

void Soles::add_rows(std::vector<TreeRow>& rows, const Eigen::Vector3d& p_WO_W) {
  for (Sole& sole : soles_)
    if (sole.held.holds()) sole.held.add_rows(rows, p_WO_W);
}

bool Soles::confirm(const TreeSolver& solver) {
  bool confirmed = true;
  for (Sole& sole : soles_) {
    if (!sole.held.holds() || sole.held.is_possible(solver, sole.friction)) continue;
    sole.held.let_go();
    sole.resting_steps = 0;
    confirmed = false;
  }
  return confirmed;
}

void Soles::let_go() {
  for (Sole& sole : soles_) sole.held.let_go();
}

void Soles::finish_step(Collider& collider) {
  for (Sole& sole : soles_) {
    if (sole.held.holds()) {
      collider.set_forces(sole.first, sole.held.forces_W());
    } else {
      sole.resting_steps = sole.eligible && rests(sole, collider) ? sole.resting_steps + 1 : 0;
      sole.stands = sole.resting_steps * step_s_ >= kRest_s;
    }
  }
}

// The points are those at the beginning of the step; a resting sole has not moved away from them.
bool Soles::rests(const Sole& sole, const Collider& collider) const {
  const Eigen::Vector3d v_W = vector_of(dBodyGetLinearVel(sole.body));
  const Eigen::Vector3d w_W = vector_of(dBodyGetAngularVel(sole.body));
  const Eigen::Vector3d p_WCom_W = vector_of(dBodyGetPosition(sole.body));
  const auto contacts = collider.contacts().subspan(sole.first, sole.count);
  return std::ranges::all_of(contacts, [&](const Contact& contact) {
    const Eigen::Vector3d v_WPoint_W = v_W + w_W.cross(contact.p_W - p_WCom_W);
    const Eigen::Vector3d& n_W = contact.n_W;
    return contact.f_W.dot(n_W) > 0.0 && (v_WPoint_W - n_W.dot(v_WPoint_W) * n_W).norm() < kAtRest_m_per_s;
  });
}

void Soles::archive(StateArchive& archive) {
  for (Sole& sole : soles_) archive(sole.stands, sole.resting_steps);
}

}  // namespace koboshi::sim_board
