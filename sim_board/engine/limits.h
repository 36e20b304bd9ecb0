#pragma once

#include <cmath>

#include "sim_board/world/world.h"

namespace koboshi::sim {

// No push or torque of a real scenario comes near; far beyond it an engine's own arithmetic overflows inside
// a step.
inline constexpr double kLargestForce = 1e6;  // N or N m

inline bool within_limits(const ServoTorque& servo) {
  const auto is_amount = [](double value) { return value >= 0.0 && value <= kLargestForce; };
  return std::abs(servo.drive_Nm) <= kLargestForce && is_amount(servo.damping_Nm_s) &&
         is_amount(servo.rotor_inertia_kg_m2) && is_amount(servo.friction_Nm);
}

}  // namespace koboshi::sim
