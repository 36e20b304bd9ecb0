#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lab/validate/theory.h"
#include "lab/validate/validation.h"
#include "sim_board/world/ground_truth.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

constexpr HangingLink kPendulumLink{.mass_kg = 0.2, .inertia_kg_m2 = 5e-4, .arm_m = 0.15, .length_m = 0.2};
constexpr double kLarge_rad = 1.5;

const Eigen::Vector3d kDown(0.0, 0.0, -kGravity_m_per_s2);

// The times at which the pendulum passes the bottom, moving towards the side of its release.
std::vector<double> passages_s(sim_board::World& world, int count, double longest_s) {
  std::vector<double> times_s;
  double before_rad = world.joint(0).position_rad;
  while (static_cast<int>(times_s.size()) < count && world.time_s() < longest_s) {
    world.step();
    const double now_rad = world.joint(0).position_rad;
    if (before_rad < 0.0 && now_rad >= 0.0) {
      times_s.push_back(world.time_s() - world.step_s() * now_rad / (now_rad - before_rad));
    }
    before_rad = now_rad;
  }
  return times_s;
}

// Bound of the energy that the hinge takes, J. A step along the tangent loses r w (w h)^2/2 of the speed; the
// error reduction gives it back, but about five steps late, so that (r w h/2) 5 h |d(w^2)/dt| remains.
// Assumes that nothing of the loss on the way down comes back on the way up. `speed_squared` and its change
// in a step.
double hinge_loss_J(double moment_kg_m2, double speed_squared, double change, double h) {
  return 2.5 * moment_kg_m2 * h * h * speed_squared * std::abs(change);
}

// The decrease of the period after this relative loss of energy, s.
double quicker_s(double length_m, double amplitude_rad, double relative_loss) {
  const double lower_rad = std::acos(std::cos(amplitude_rad) + relative_loss);
  return pendulum_period_s(length_m, amplitude_rad) - pendulum_period_s(length_m, lower_rad);
}

void check_swing(double amplitude_rad, int periods, const ValidationSetup& setup, Findings& findings) {
  const double length_m = reduced_length_m(kPendulumLink);
  const double theory_s = pendulum_period_s(length_m, amplitude_rad);
  const double h = setup.world.step_s;
  const auto robot = chain_rig({kPendulumLink});
  const auto world = hang(robot, {amplitude_rad}, setup);
  const double energy_start_J = sim_board::energy_J(robot, *world, kDown);
  const std::vector<double> times_s = passages_s(*world, periods + 1, (periods + 3) * theory_s);
  const bool complete = static_cast<int>(times_s.size()) == periods + 1;
  const double simulated_s = complete ? (times_s.back() - times_s.front()) / periods : std::nan("");

  // Oscillating part: w^2 h^2/24 of semi-implicit Euler. Hinge: a step along the tangent leaves the circle by
  // r (w h)^2/2, of which an error reduction of 0.2 leaves five times, so that the pendulum is longer by 2.5
  // (w h)^2 and its period by half of that.
  const double natural = std::sqrt(kGravity_m_per_s2 / length_m);
  const double fastest = 2.0 * natural * std::sin(0.5 * amplitude_rad);
  const double relative = std::pow(natural * h, 2) / 24.0 + 1.25 * std::pow(fastest * h, 2);
  // Semi-implicit Euler keeps another energy, H - (h/2) w dV/dq. The hinge's part, summed over the four
  // quarters of each period.
  const double weight_Nm = kPendulumLink.mass_kg * kGravity_m_per_s2 * kPendulumLink.arm_m;
  const double swung_J = 0.5 * h * weight_Nm * fastest;
  const double moment = kPendulumLink.mass_kg * kPendulumLink.arm_m * kPendulumLink.arm_m;
  const double lost_J = periods * 4.0 * hinge_loss_J(moment, fastest * fastest, 0.5 * fastest * fastest, h);
  findings.check(fmt::format("period at {} rad, mean of {}", amplitude_rad, periods), "s", theory_s,
                 simulated_s,
                 theory_s * relative + quicker_s(length_m, amplitude_rad, lost_J / weight_Nm) + 1e-9);
  const double energy_J = sim_board::energy_J(robot, *world, kDown);
  findings.check(fmt::format("energy error at {} rad after {} periods", amplitude_rad, periods), "J", 0.0,
                 energy_J - energy_start_J, swung_J + lost_J);
}

constexpr HangingLink kUpper{.mass_kg = 0.2, .inertia_kg_m2 = 5e-4, .arm_m = 0.1, .length_m = 0.2};
constexpr HangingLink kLower{.mass_kg = 0.1, .inertia_kg_m2 = 2e-4, .arm_m = 0.1, .length_m = 0.2};

// Compares the motion with Runge-Kutta for one second, and the energy for ten.
void check_double(const ValidationSetup& setup, Findings& findings) {
  const auto robot = chain_rig({kUpper, kLower});
  const auto world = hang(robot, {1.2, 0.6}, setup);
  const double h = setup.world.step_s;
  const double energy_start_J = sim_board::energy_J(robot, *world, kDown);
  constexpr double kCompared_s = 1.0;
  constexpr double kFine_s = 1e-5;
  const long fine_steps = std::lround(h / kFine_s);
  Eigen::Vector4d state(1.2, 0.6, 0.0, 0.0);
  double largest_rad = 0.0, fastest = 0.0, most_power_W = 0.0, energy_off_J = 0.0, lost_J = 0.0;
  // For the upper hinge, the lower link is a point mass at its own hinge.
  const std::array moments{
      kUpper.mass_kg * kUpper.arm_m * kUpper.arm_m + kLower.mass_kg * kUpper.length_m * kUpper.length_m,
      kLower.mass_kg * kLower.arm_m * kLower.arm_m};
  std::array speeds_squared{0.0, 0.0};
  std::vector<double> time_s, upper_rad, lower_rad, upper_theory_rad, lower_theory_rad, off_mJ;
  const double duration_s = setup.short_form ? 2.0 : 10.0;
  for (long i = steps_of(duration_s, *world); i > 0; --i) {
    world->step();
    const bool compared = world->time_s() <= kCompared_s + 0.5 * h;
    if (compared) {
      for (long k = 0; k < fine_steps; ++k) {
        state = runge_kutta_step(state, kFine_s, [](const Eigen::Vector4d& y) {
          return double_pendulum_derivative(kUpper, kLower, y);
        });
      }
      fastest = std::max({fastest, std::abs(state[2]), std::abs(state[3])});
      for (int j = 0; j < 2; ++j) {
        largest_rad = std::max(largest_rad, std::abs(world->joint(j).position_rad - state[j]));
      }
    }
    const double now_J = sim_board::energy_J(robot, *world, kDown) - energy_start_J;
    energy_off_J = std::abs(now_J) > std::abs(energy_off_J) ? now_J : energy_off_J;
    const double power_W = kGravity_m_per_s2 * (kUpper.mass_kg * world->body(1).v_WCom_W.z() +
                                                kLower.mass_kg * world->body(2).v_WCom_W.z());
    most_power_W = std::max(most_power_W, std::abs(power_W));
    for (std::size_t l = 0; l < moments.size(); ++l) {
      const double squared = world->body(static_cast<int>(l) + 1).w_WL_W.squaredNorm();
      lost_J += hinge_loss_J(moments[l], squared, squared - speeds_squared[l], h);
      speeds_squared[l] = squared;
    }
    time_s.push_back(world->time_s());
    upper_rad.push_back(world->joint(0).position_rad);
    lower_rad.push_back(world->joint(1).position_rad);
    upper_theory_rad.push_back(compared ? state[0] : std::nan(""));
    lower_theory_rad.push_back(compared ? state[1] : std::nan(""));
    off_mJ.push_back(1e3 * now_J);
  }
  findings.check("double pendulum: angles in the first second", "rad", 0.0, largest_rad, h * fastest);
  findings.check("double pendulum: energy", "J", 0.0, energy_off_J, 0.5 * h * most_power_W + lost_J);
  findings.plots.push_back(
      {.name = "double-pendulum",
       .caption =
           "The first second is held to Runge-Kutta (dashed). The energy error swings with the motion, as "
           "that of a semi-implicit method does, and the hinges take a little for good.",
       .columns = {{"time_s", time_s},
                   {"upper_rad", upper_rad},
                   {"lower_rad", lower_rad},
                   {"upper_theory_rad", upper_theory_rad},
                   {"lower_theory_rad", lower_theory_rad},
                   {"energy_error_mJ", off_mJ}},
       .figure = {
           .title = "Double pendulum, let go at 1.2 and 0.6 rad",
           .panels = {{.y_label = "joint angle [rad]",
                       .series = {tools::series(tools::Role::kFirst, "upper_rad", "upper, simulated"),
                                  tools::series(tools::Role::kSecond, "lower_rad", "lower, simulated"),
                                  tools::series(tools::Role::kTheory, "upper_theory_rad", "Runge-Kutta"),
                                  tools::series(tools::Role::kTheory, "lower_theory_rad", "")}},
                      {.y_label = "energy error [mJ]", .series = {{.column = "energy_error_mJ"}}}}}});
}

Findings run_pendulum_swing(const ValidationSetup& setup) {
  Findings findings;
  const int periods = setup.short_form ? 5 : 20;
  check_swing(0.05, periods, setup, findings);
  check_swing(kLarge_rad, periods, setup, findings);
  check_swing(2.8, periods, setup, findings);
  check_double(setup, findings);
  return findings;
}

}  // namespace

double pendulum_error_rad(const ValidationSetup& setup) {
  constexpr double kDuration_s = 1.0;
  const auto world = hang(chain_rig({kPendulumLink}), {kLarge_rad}, setup);
  run_for(*world, kDuration_s);
  return world->joint(0).position_rad -
         pendulum_angle_rad(reduced_length_m(kPendulumLink), kLarge_rad, kDuration_s);
}

Validation pendulum_swing() {
  return {.name = "pendulum",
          .title = "Pendulums",
          .theory =
              "A rigid link of 0.2 kg, its centre of mass 0.15 m below the hinge, swings like a simple "
              "pendulum of l = (I + m r^2)/(m r): T = 4 sqrt(l/g) K(sin(a/2)), K the complete elliptic "
              "integral of the first kind (Landau and Lifshitz, Mechanics, section 11). Nothing takes its "
              "energy. A double pendulum is held to its Lagrangian, integrated by Runge-Kutta in steps of 10 "
              "us.",
          .tolerances =
              "Period: w^2 h^2/24 of semi-implicit Euler, and 1.25 (w h)^2 of a hinge that is left along "
              "the tangent and drawn back by a fifth a step, and what the energy that may be lost makes of "
              "it. Energy: such a method keeps H - (h/2) dV/dt instead of H, so that H is off by h/2 times "
              "the largest power of gravity; the hinge gives back five steps late what it took, 5 m r^2 "
              "h^2 w^4 a period. Angles of the double pendulum: one step late, h times the largest speed.",
          .run = run_pendulum_swing};
}

}  // namespace koboshi::lab
