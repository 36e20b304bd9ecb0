#include <fmt/core.h>
#include <array>

#include <algorithm>
#include <cmath>

#include "lab/validate/rigs.h"
#include "lab/validate/validation.h"
#include "sim_board/engine/make_world.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

constexpr double kFriction = 0.5;
constexpr double kSettle_s = 0.2;  // the ground's spring, 20 ms, is at rest by then
// A real foot at rest does not move. A millimetre in an hour is negligible and well above round-off.
constexpr double kCreep_m_per_s = 1e-3 / 3600.0;
// Residual of the solver, relative to an exact balance of forces.
constexpr double kResidual = 1e-6;

std::unique_ptr<sim_board::World> box_on(double slope_rad, const ValidationSetup& setup) {
  sim_board::WorldOptions options = setup.world;
  options.ground.normal_W = {std::sin(slope_rad), 0.0, std::cos(slope_rad)};
  options.ground.surface.friction = options.ground.surface.friction_second = kFriction;
  options.X_WB = Eigen::AngleAxisd(slope_rad, Eigen::Vector3d::UnitY()) * Eigen::Translation3d(0, 0, 0.005);
  return sim_board::make_world(box_rig(1.2, {0.1, 0.056, 0.01}), options);
}

// The speed down the slope.
double speed_along(const sim_board::World& world, double slope_rad) {
  return world.body(0).v_WCom_W.dot(Eigen::Vector3d(std::cos(slope_rad), 0.0, -std::sin(slope_rad)));
}

Check stick(double part, const ValidationSetup& setup) {
  const double slope_rad = std::atan(part * kFriction);
  const auto world = box_on(slope_rad, setup);
  run_for(*world, kSettle_s);
  const Eigen::Vector3d start = world->body(0).X_WL.translation();
  const double duration_s = setup.short_form ? 1.0 : 5.0;
  run_for(*world, duration_s);
  const double creep_m = (world->body(0).X_WL.translation() - start).norm();
  return {fmt::format("creep, tan a = {} mu", part), "m/s", 0.0, creep_m / duration_s, kCreep_m_per_s};
}

Check slide(double part, const ValidationSetup& setup) {
  const double slope_rad = std::atan(part * kFriction);
  const auto world = box_on(slope_rad, setup);
  run_for(*world, kSettle_s);
  const double before = speed_along(*world, slope_rad);
  constexpr double kDuration_s = 0.5;
  run_for(*world, kDuration_s);
  const double theory = kGravity_m_per_s2 * (std::sin(slope_rad) - kFriction * std::cos(slope_rad));
  return {fmt::format("acceleration, tan a = {} mu", part), "m/s^2", theory,
          (speed_along(*world, slope_rad) - before) / kDuration_s, kResidual * kGravity_m_per_s2};
}

// Simulates speed over time for the figure.
Plot sliding_figure(const ValidationSetup& setup) {
  Plot plot{
      .name = "slope",
      .caption = "Below the friction angle the box stands; above it, it gains speed at g (sin a - mu cos a).",
      .columns = {{"time_s", {}}},
      .figure = {.title = "A box on a slope, mu = 0.5",
                 .panels = {{.y_label = "speed down the slope [m/s]"}}}};
  std::size_t number = 0;
  constexpr std::array kRoles{tools::Role::kTrue, tools::Role::kFirst, tools::Role::kSecond};
  for (const double part : {0.95, 1.2, 2.0}) {
    const double slope_rad = std::atan(part * kFriction);
    const auto world = box_on(slope_rad, setup);
    const double slides_at =
        kGravity_m_per_s2 * std::max(0.0, std::sin(slope_rad) - kFriction * std::cos(slope_rad));
    std::vector<double> time_s, simulated, theory;
    for (long i = steps_of(0.5, *world); i > 0; --i) {
      world->step();
      time_s.push_back(world->time_s());
      simulated.push_back(speed_along(*world, slope_rad));
      theory.push_back(slides_at * world->time_s());
    }
    plot.columns[0].second = time_s;
    const std::string name = fmt::format("tan_a_{}_mu", part);
    plot.columns.emplace_back(name, simulated);
    plot.columns.emplace_back(name + "_theory", theory);
    plot.figure.panels[0].series.push_back({.column = name,
                                            .label = fmt::format("tan a = {} mu", part),
                                            .colour = tools::colour_of(kRoles.at(number++))});
    plot.figure.panels[0].series.push_back(
        tools::series(tools::Role::kTheory, name + "_theory", part == 2.0 ? "theory" : ""));
  }
  return plot;
}

Findings run_slope(const ValidationSetup& setup) {
  return {.checks = {stick(0.5, setup), stick(0.95, setup), slide(1.05, setup), slide(1.2, setup),
                     slide(2.0, setup)},
          .plots = {sliding_figure(setup)}};
}

}  // namespace

Validation slope() {
  return {.name = "slope",
          .title = "Stick and slip on a slope",
          .theory =
              "Coulomb: a box of 1.2 kg, as large as a foot, mu = 0.5, stands where tan a < mu, and slides "
              "with g (sin a - mu cos a) where it is steeper.",
          .tolerances =
              "Standing: a millimetre in an hour. Sliding: the forces are constant and any method of "
              "first order is exact in speed; 1e-6 g is left to the solver of the contact problem.",
          .run = run_slope};
}

}  // namespace koboshi::lab
