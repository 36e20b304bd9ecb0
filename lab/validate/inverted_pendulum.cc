#include <cmath>
#include <numbers>

#include "lab/validate/rigs.h"
#include "lab/validate/theory.h"
#include "lab/validate/validation.h"
#include "sim_board/engine/make_world.h"
#include "simulation/gait/pendulum.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHeight_m = 0.18;  // of the robot's centre of mass
constexpr double kMass_kg = 1.2;
const double kTimeConstant_s = std::sqrt(kHeight_m / kGravity_m_per_s2);

// The leg has no mass and telescopes: a force along the line from the ZMP to the mass, whose vertical part
// carries the weight.
Vector3d leg_force_N(const Vector3d& p_W, const Vector2d& zmp_m) {
  const double along = kMass_kg * kGravity_m_per_s2 / kHeight_m;
  return {along * (p_W.x() - zmp_m.x()), along * (p_W.y() - zmp_m.y()), kMass_kg * kGravity_m_per_s2};
}

struct Path {
  std::vector<double> time_s;
  std::vector<Vector2d> position_m;
};

// Starts at rest; a force in the first step gives the mass its velocity.
Path walk_on_leg(const simulation::PendulumState& start, const simulation::ZmpPiece& zmp,
                 const ValidationSetup& setup) {
  sim_board::WorldOptions options = setup.world;
  options.ground.present = false;
  options.X_WB.translation() << start.position_m, kHeight_m;
  const auto world = sim_board::make_world(box_rig(kMass_kg, Vector3d::Constant(0.05)), options);
  const Vector2d blow_N = kMass_kg / options.step_s * start.velocity_m_per_s;
  world->push(0, Vector3d::Zero(), {blow_N.x(), blow_N.y(), 0.0});
  Path path;
  for (long i = steps_of(zmp.duration_s, *world); i > 0; --i) {
    const Vector3d p_W = world->body(0).X_WL.translation();
    world->push(0, Vector3d::Zero(), leg_force_N(p_W, zmp.at(world->time_s())));
    world->step();
    path.time_s.push_back(world->time_s());
    path.position_m.push_back(world->body(0).X_WL.translation().head<2>());
  }
  return path;
}

// Semi-implicit Euler is the leap-frog with its speeds half a step earlier: as if it began with (h/2) x''
// more speed, which the pendulum then enlarges; its exponent is off by (h/Tc)^2/24.
double tolerance_m(double start_acceleration, double distance_m, double time_s, double h) {
  const double late_m =
      0.5 * h * std::abs(start_acceleration) * kTimeConstant_s * std::sinh(time_s / kTimeConstant_s);
  const double ratio = h / kTimeConstant_s;
  return late_m * (1.0 + ratio) + std::abs(distance_m) * ratio * ratio * time_s / kTimeConstant_s + 1e-9;
}

const simulation::PendulumState kStart{.position_m = {-0.02, 0.01}, .velocity_m_per_s = {0.24, -0.06}};
const simulation::ZmpPiece kStep{.duration_s = 0.4, .from_m = {0.0, 0.0}, .to_m = {0.01, 0.006}};

void check_leg(const ValidationSetup& setup, Findings& findings) {
  const Path path = walk_on_leg(kStart, kStep, setup);
  const simulation::Pendulum gait(kHeight_m);
  const Vector2d end_m = gait.advance(kStart, kStep, kStep.duration_s).position_m;
  const Vector2d acceleration = (kStart.position_m - kStep.from_m) / (kTimeConstant_s * kTimeConstant_s);
  for (int axis = 0; axis < 2; ++axis) {
    findings.check(axis == 0 ? "massless leg: x after 0.4 s" : "massless leg: y after 0.4 s", "m",
                   end_m[axis], path.position_m.back()[axis],
                   tolerance_m(acceleration[axis], end_m[axis] - kStep.to_m[axis], kStep.duration_s,
                               setup.world.step_s));
  }
  Plot plot{
      .name = "inverted-pendulum",
      .caption =
          "A step of the walk: the mass comes in, slows down over the foot and leaves (x), and draws "
          "near to it (y), as the gait's pendulum (dashed) says; at 0.4 s the error of a step of 1 ms "
          "has grown to what theory says of it.",
      .columns =
          {{"time_s", path.time_s}, {"x_mm", {}}, {"x_theory_mm", {}}, {"y_mm", {}}, {"y_theory_mm", {}}},
      .figure = {
          .title = "Linear inverted pendulum, 0.18 m high, over a ZMP that moves",
          .panels = {{.y_label = "position [mm]",
                      .series = {tools::series(tools::Role::kFirst, "x_mm", "x, simulated"),
                                 tools::series(tools::Role::kSecond, "y_mm", "y, simulated"),
                                 tools::series(tools::Role::kTheory, "x_theory_mm", "pendulum of the gait"),
                                 tools::series(tools::Role::kTheory, "y_theory_mm", "")}}}}};
  for (std::size_t i = 0; i < path.time_s.size(); ++i) {
    const Vector2d theory_m = gait.advance(kStart, kStep, path.time_s[i]).position_m;
    plot.columns[1].second.push_back(1e3 * path.position_m[i].x());
    plot.columns[2].second.push_back(1e3 * theory_m.x());
    plot.columns[3].second.push_back(1e3 * path.position_m[i].y());
    plot.columns[4].second.push_back(1e3 * theory_m.y());
  }
  findings.plots.push_back(plot);
}

// A rigid link on its hinge, 0.1 mrad from upright, tips over.
void check_tipping(const ValidationSetup& setup, Findings& findings) {
  constexpr HangingLink kLink{.mass_kg = 1.0, .inertia_kg_m2 = 2e-3, .arm_m = 0.15, .length_m = 0.3};
  constexpr double kStart_rad = 1e-4;
  const double Tc = std::sqrt(reduced_length_m(kLink) / kGravity_m_per_s2);
  const double h = setup.world.step_s;
  const auto world = hang(chain_rig({kLink}), {std::numbers::pi + kStart_rad}, setup);
  const auto angle_rad = [&] { return world->joint(0).position_rad - std::numbers::pi; };
  run_for(*world, 0.3);
  const double first_rad = angle_rad(), first_s = world->time_s();
  run_for(*world, 0.3);
  const double last_rad = angle_rad(), last_s = world->time_s();

  const double theory_rad = kStart_rad * std::cosh(last_s / Tc);
  const double late_rad = kStart_rad * 0.5 * h / Tc * std::sinh(last_s / Tc);
  const double ratio = h / Tc;
  // sin a = a - a^3/6 slows the growth by at most a^2/6.
  const double bent = last_rad * last_rad / 6.0;
  findings.check("link on a hinge: angle after 0.6 s", "rad", theory_rad, last_rad,
                 late_rad * (1.0 + ratio) + theory_rad * (bent + ratio * ratio * last_s / Tc));
  // ln(cosh) instead of the exponent alone: what decays is not yet gone.
  const double growth = std::log(std::cosh(last_s / Tc) / std::cosh(first_s / Tc)) / (last_s - first_s);
  const double decayed = std::exp(-2.0 * first_s / Tc);
  findings.check("link on a hinge: mean growth rate", "1/s", growth,
                 std::log(last_rad / first_rad) / (last_s - first_s),
                 (ratio * decayed + bent) / (last_s - first_s) + ratio * ratio / Tc);
}

Findings run_inverted_pendulum(const ValidationSetup& setup) {
  Findings findings;
  check_leg(setup, findings);
  check_tipping(setup, findings);
  return findings;
}

}  // namespace

double inverted_pendulum_error_m(const ValidationSetup& setup) {
  const simulation::PendulumState start{.position_m = {0.01, 0.0}};
  const simulation::ZmpPiece zmp{.duration_s = 0.4};
  return walk_on_leg(start, zmp, setup).position_m.back().x() -
         0.01 * std::cosh(zmp.duration_s / kTimeConstant_s);
}

Validation inverted_pendulum() {
  return {
      .name = "inverted-pendulum",
      .title = "Linear inverted pendulum",
      .theory =
          "The paper's equation 3, x = x0 cosh(t/Tc) + Tc v0 sinh(t/Tc), Tc = sqrt(z/g): a mass of 1.2 kg "
          "0.18 m high on a massless leg, which is a force along the line from the ZMP, held to the "
          "pendulum that makes the gaits (simulation/gait/pendulum.h) over a ZMP that moves. A rigid link on "
          "a "
          "hinge, 0.1 mrad from upright, tips with Tc = sqrt((I + m r^2)/(m g r)).",
      .tolerances =
          "Semi-implicit Euler is the leap-frog with its speeds half a step early: an error of (h/2) "
          "x''(0) Tc sinh(t/Tc), and (h/Tc)^2 of the exponent. The link's sine bends by a^2/6.",
      .run = run_inverted_pendulum};
}

}  // namespace koboshi::lab
