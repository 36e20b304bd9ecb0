#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/fixed/host/convert.h"
#include "firmware/robot/model.h"

namespace koboshi::test {

inline constexpr double kRadPerDegree = std::numbers::pi / 180.0;

inline constexpr double kTickLength_s = 0.01;  // a control cycle
inline constexpr double kGravity = 9.80665;    // m/s^2

inline fixed::Angle degrees(double angle_deg) {
  return fixed::from_double<fixed::Angle>(angle_deg * kRadPerDegree);
}

inline robot::Position position(double x_m, double y_m, double z_m) {
  return {fixed::from_double<fixed::Length>(x_m), fixed::from_double<fixed::Length>(y_m),
          fixed::from_double<fixed::Length>(z_m)};
}

// Returns a robot of the default robot's dimensions, defined in code: 12 leg joints, 6 arm joints and 2 head
// joints.
robot::RobotModel make_test_robot();

// Makes the right hip yaw a follower of the left one, behind all joints: angle = multiplier * left angle.
robot::RobotModel with_shared_yaw(const robot::RobotModel& model, double multiplier);

// Indices of some joints, and the gyro's counts per rad/s.
inline constexpr std::size_t kKnee = 3;
inline constexpr std::size_t kHeadTilt = 19;
inline constexpr double kCountsPerRadPerS = 1'878;
inline constexpr double kCountsPerG = 9.80665 / 39.2 * 32'768;

// Encodes a model field by field in the format of docs/reference/robot-model-format.md.
std::vector<std::byte> encode(const robot::RobotModel& model);

// Writes size and CRC to the header of a modified image.
void seal(std::vector<std::byte>& image);

void put(std::vector<std::byte>& bytes, std::uint32_t value, int size);

}  // namespace koboshi::test
