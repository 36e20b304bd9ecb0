#pragma once

#include <cstdint>
#include <span>

#include "firmware/estimation/robot_state.h"
#include "firmware/fixed/units.h"
#include "firmware/motion/instructions.h"

namespace koboshi::motion {

// The measurements that a motion can read, at one instant. What is beyond the end of a span reads as zero, so
// that a span may be empty.
struct Inputs {
  const estimation::RobotState& robot;
  std::span<const fixed::Angle> angles{};            // measured, by joint
  std::span<const std::int16_t> torques_permille{};  // by joint, 0.1 % of the rated torque
  std::uint32_t supply_mV = 0;                       // the lowest of the drives' last readings
  std::span<const std::int16_t> values{};            // as a CAN master wrote them (object 0x2410)
  bool walking = false;
};

}  // namespace koboshi::motion
