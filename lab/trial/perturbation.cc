#include "lab/trial/perturbation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "sim_board/random/random_stream.h"

namespace koboshi::tools {
namespace {

// Soft ground gives way like felt, without much of a rebound, under a robot of 1.2 kg on a sole's four
// points.
constexpr double kDampingRatio = 0.5;
constexpr double kMassAbove_kg = 0.3;

// Two surfaces have the friction of the more slippery one (sim_board/world/surface_contact.h), so the
// ground's draw only counts in full if the robot has it too.
double drawn_friction(const PerturbationBounds& bounds, std::uint64_t seed) {
  sim_board::RandomStream friction(seed, "ground friction");
  return between(friction, bounds.lowest_friction, bounds.highest_friction);
}

}  // namespace

double between(sim_board::RandomStream& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

std::uint64_t to_us(double time_s) { return static_cast<std::uint64_t>(std::llround(1e6 * time_s)); }

simulation::Push half_sine_push(const std::string& link, std::uint64_t at_us, double duration_s,
                                const Eigen::Vector3d& impulse_W_N_s) {
  // The impulse of half a sine wave is 2/pi of peak times duration.
  return {.at_us = at_us,
          .duration_us = to_us(duration_s),
          .link = {link, "a push of an experiment", 0},
          .shape = simulation::Push::Shape::kHalfSine,
          .force_W_N = std::numbers::pi / (2.0 * duration_s) * impulse_W_N_s,
          .p_L_m = std::nullopt};
}

void perturb_robot(sim_board::RobotDescription& robot, const PerturbationBounds& bounds, std::uint64_t seed) {
  const double friction = drawn_friction(bounds, seed);
  for (sim_board::LinkDescription& link : robot.links) {
    for (sim_board::BoxDescription& box : link.collisions)
      box.surface.friction = box.surface.friction_second = friction;
    sim_board::RandomStream random(seed, "mass of " + link.name);
    const double factor = between(random, 1.0 - bounds.mass_share, 1.0 + bounds.mass_share);
    link.mass_kg *= factor;
    link.I_LCom_L *= factor;
  }
  sim_board::RandomStream supply(seed, "supply");
  const double factor = between(supply, 1.0 - bounds.supply_share, 1.0 + bounds.supply_share);
  if (robot.battery) robot.battery->open_circuit_V *= factor;
  for (sim_board::JointDescription& joint : robot.joints) {
    sim_board::RandomStream offset(seed, "encoder offset of " + joint.name);
    joint.encoder.offset_rad += offset.within(bounds.encoder_offset_rad);
    if (bounds.backlash_rad == 0.0 || joint.servo.rotor_inertia_kg_m2 == 0.0) continue;
    sim_board::RandomStream backlash(seed, "backlash of " + joint.name);
    joint.servo.backlash_rad = between(backlash, 0.0, bounds.backlash_rad);
  }
}

void perturb_scenario(simulation::Scenario& scenario, const PerturbationBounds& bounds, std::uint64_t seed) {
  scenario.ground.friction = drawn_friction(bounds, seed);
  // Turned about x, then y, by the parts of a vector of the tilt's length; the whole tilt is not more.
  sim_board::RandomStream tilt(seed, "ground tilt");
  const double tilt_rad = between(tilt, 0.0, bounds.tilt_rad);
  const double direction_rad = between(tilt, 0.0, kTurn_rad);
  scenario.ground.roll_rad += tilt_rad * std::cos(direction_rad);
  scenario.ground.pitch_rad += tilt_rad * std::sin(direction_rad);
  if (bounds.stiffest_N_per_m > 0.0) {
    sim_board::RandomStream softness(seed, "ground stiffness");
    const double stiffness_N_per_m = between(softness, bounds.softest_N_per_m, bounds.stiffest_N_per_m);
    scenario.ground.softness = {stiffness_N_per_m,
                                2.0 * kDampingRatio * std::sqrt(stiffness_N_per_m * kMassAbove_kg)};
  }
  scenario.seed = seed;
}

void add_pushes(simulation::Scenario& scenario, const std::string& link, std::uint64_t from_us,
                const PushBounds& bounds, std::uint64_t seed) {
  sim_board::RandomStream random(seed, "pushes");
  std::uint64_t at_us = from_us + to_us(bounds.first_s);
  while (at_us < scenario.duration_us) {
    const double impulse_N_s = between(random, bounds.lowest_N_s, bounds.highest_N_s);
    const double direction_rad = between(random, 0.0, kTurn_rad);
    scenario.pushes.push_back(
        half_sine_push(link, at_us, bounds.duration_s,
                       impulse_N_s * Eigen::Vector3d(std::cos(direction_rad), std::sin(direction_rad), 0.0)));
    at_us += to_us(between(random, bounds.shortest_s, bounds.longest_s));
  }
  std::ranges::stable_sort(scenario.pushes, {}, &simulation::Push::at_us);
}

}  // namespace koboshi::tools
