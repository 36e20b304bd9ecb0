#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/description/description.h"
#include "simulation/disturbance/world_ranges.h"

namespace koboshi::simulation {

// The factors that a seed has drawn for a robot.
struct DisturbedWorld {
  std::string name;
  std::uint64_t seed = 0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();  // in the trunk's axes, for this robot's leg
  std::vector<double> mass_factors;                 // by link
  std::vector<std::optional<double>> backlash_rad;  // by joint; nothing: as in the file
  std::vector<double> encoder_offset_rad;           // by joint
  double servo_gain_divisor = 1.0;
  double load_friction = 0.0;
  double motor_constant_factor = 1.0;
  double supply_factor = 1.0;
  double sensor_latency_s = 0.0;
  int drive_latency_ms = 0;
  double tick_jitter_s = 0.0;
  std::optional<double> friction;
  double tilt_rad = 0.0;
  double tilt_direction_rad = 0.0;           // of the axis about which the ground is turned, from x
  std::optional<double> gyro_noise_density;  // rad/s/sqrt(Hz)
  std::optional<double> gyro_random_walk;    // rad/s/sqrt(s)
  std::optional<std::size_t> weak_joint;

  // Angles of the ground about the world's x axis and then about y. The whole tilt is not more than tilt_rad.
  double roll_rad() const;
  double pitch_rad() const;
  std::uint64_t tick_jitter_us() const;
};

// Returns the distance from hip pitch over knee to ankle pitch of the left leg; kReferenceLeg_m if the robot
// has no such joints.
[[nodiscard]] double leg_length_m(const sim_board::RobotDescription& robot);

// Draws a world for a robot. Each factor has a random stream of its own, named after it and its part: the
// same seed gives the same values on every machine, and no factor depends on another one's range, or on
// whether the robot has further parts.
[[nodiscard]] DisturbedWorld draw_world(const WorldRanges& ranges, const sim_board::RobotDescription& robot,
                                        std::uint64_t seed);

// Changes the robot in the world, for which the factors were drawn. The firmware's model stays what it is.
void apply(const DisturbedWorld& world, sim_board::RobotDescription& robot);

}  // namespace koboshi::simulation
