#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <string>

#include "sim_board/description/description.h"
#include "sim_board/random/random_stream.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::tools {

// The bounds within which a seed changes the world. Everything is drawn uniformly between its bounds.
struct PerturbationBounds {
  double lowest_friction = 0.5;  // Coulomb's mu between the robot and the ground
  double highest_friction = 1.0;
  double mass_share = 0.05;   // of a link's mass, either way; its inertia goes along
  double supply_share = 0.0;  // of the supply's voltage, either way
  double tilt_rad = 0.01745;  // of the ground, largest, in any direction, beside the scenario's: 1 degree
  double backlash_rad = 0.0;  // of each servo's gears, largest, from edge to edge
  double encoder_offset_rad = 0.0;  // of each joint, either way, beside the robot file's
  // Stiffness of soft ground under one contact point, of which a sole has four; both 0: the ground stays as
  // hard as it is.
  double softest_N_per_m = 0.0;
  double stiffest_N_per_m = 0.0;
};

// Differences between floors and between robots of one design. Kit servos have a backlash of about 0.01 rad
// (the models of RoboCup's Humanoid League Virtual Season); a joint that is trimmed by eye against the edge
// of a link of 65 mm is off by some tenths of a millimetre there, 0.005 rad.
inline constexpr PerturbationBounds kRoughWorld{.lowest_friction = 0.4,
                                                .highest_friction = 1.0,
                                                .mass_share = 0.1,
                                                .supply_share = 0.1,
                                                .tilt_rad = 0.0349,  // 2 degrees
                                                .backlash_rad = 0.01,
                                                .encoder_offset_rad = 0.005};

// Pushes against the trunk at random times and in random level directions.
struct PushBounds {
  double first_s = 0.0;     // from the start to the first push
  double shortest_s = 1.5;  // from one push to the next
  double longest_s = 3.0;
  double lowest_N_s = 0.0;  // impulse
  double highest_N_s = 0.1;
  double duration_s = 0.05;  // half a sine wave
};

inline constexpr double kTurn_rad = 2.0 * std::numbers::pi;  // a whole turn
inline constexpr double kPush_s = 0.1;                       // duration of a half-sine push in experiments

// Uniform from `low` on, below `high`.
[[nodiscard]] double between(sim_board::RandomStream& random, double low, double high);

[[nodiscard]] std::uint64_t to_us(double time_s);

// A push at the centre of mass of `link`, half a sine wave long.
[[nodiscard]] simulation::Push half_sine_push(const std::string& link, std::uint64_t at_us, double duration_s,
                                              const Eigen::Vector3d& impulse_W_N_s);

// Changes the links' masses and friction, the supply and the servos to those of the world with this seed. The
// same seed gives the same masses on every machine, and so for everything below; each thing has a stream of
// its own, so that one more does not change the others.
void perturb_robot(sim_board::RobotDescription& robot, const PerturbationBounds& bounds, std::uint64_t seed);

// Changes the ground, and the seed of the sensors' noise and bias.
void perturb_scenario(simulation::Scenario& scenario, const PerturbationBounds& bounds, std::uint64_t seed);

// Adds pushes against `link` from `from_us` to the scenario's end.
void add_pushes(simulation::Scenario& scenario, const std::string& link, std::uint64_t from_us,
                const PushBounds& bounds, std::uint64_t seed);

}  // namespace koboshi::tools
