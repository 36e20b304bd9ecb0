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

// A robot of the default robot's sizes, made without any file: 12 leg joints, then 6 arm joints and 2 of the
// head.
robot::RobotModel make_test_robot();

// Numbers of some of its joints, and its gyro's counts a rad/s.
inline constexpr std::size_t kKnee = 3;
inline constexpr std::size_t kHeadTilt = 19;
inline constexpr double kCountsPerRadPerS = 1'878;

// The image of a model, written field by field after docs/reference/robot-model-format.md.
std::vector<std::byte> encode(const robot::RobotModel& model);

// Puts size and CRC into the header of an image whose other bytes were changed.
void seal(std::vector<std::byte>& image);

void put(std::vector<std::byte>& bytes, std::uint32_t value, int size);

}  // namespace koboshi::test
