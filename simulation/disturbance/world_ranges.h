#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace koboshi::simulation {

// Interval in which a factor is uniformly distributed.
struct Range {
  double low = 0.0;
  double high = 0.0;

  friend bool operator==(const Range&, const Range&) = default;
};
[[nodiscard]] constexpr Range symmetric(double bound) { return {-bound, bound}; }
[[nodiscard]] constexpr Range around_one(double share) { return {1.0 - share, 1.0 + share}; }

// The distance from hip pitch over knee to ankle pitch of the default robot. The lengths of a world apply to
// such a leg and scale with that of the robot.
inline constexpr double kReferenceLeg_m = 0.13;

// How much a world may differ from the scenario and from the robot's file: the ranges in which a seed draws
// each factor, independently of all others. Every default is "as in the files". docs/reference/worlds.md
// shows the ranges of the named worlds.
struct WorldRanges {
  std::string name = "nominal";

  // One draw for each part.
  Range com_m{};                // of the trunk's centre of mass, each axis, for kReferenceLeg_m
  Range mass_factor{1.0, 1.0};  // of each link; its inertia goes along
  Range backlash_rad{};         // of each servo, replaces that of the file unless both ends are 0
  Range encoder_offset_rad{};   // of each joint, beside that of the file

  // One draw for all servos: what a model of their type has wrong.
  Range servo_gain_divisor{1.0, 1.0};
  Range load_friction{};  // M3 of Rhoban's BAM: share of the torque between motor and load, beside the file's
  Range motor_constant_factor{1.0, 1.0};
  Range supply_factor{1.0, 1.0};

  Range sensor_latency_s{};  // of IMU and ankle sensors, beside the file's
  Range drive_latency_s{};   // from a target to the position loop; the draw is a whole number of its periods
  Range tick_jitter_s{};     // the bound of a tick's delay, which is uniform between 0 and it

  Range friction{};  // Coulomb's mu between robot and ground; both ends 0: that of the files
  Range tilt_rad{};  // of the ground, in any direction, beside the scenario's

  // The upper ends; the lower ones are the values of the robot's file.
  double gyro_noise_density = 0.0;  // rad/s/sqrt(Hz)
  double gyro_random_walk = 0.0;    // rad/s/sqrt(s)

  bool weak_joint = false;  // a random joint has half of its torque
  // Each draw is one of the two ends of its range, at random: for experiments on a factor at one level.
  bool ends_only = false;

  friend bool operator==(const WorldRanges&, const WorldRanges&) = default;
};

// The names of the worlds, the gentlest first: mild, rough, harsh.
[[nodiscard]] const std::vector<std::string>& world_names();
// The ranges of a world. Throws std::out_of_range for any other name.
[[nodiscard]] const WorldRanges& world_named(std::string_view name);

}  // namespace koboshi::simulation
