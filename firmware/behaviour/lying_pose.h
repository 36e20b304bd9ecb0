#pragma once

#include <cstdint>

#include "firmware/robot/geometry.h"

namespace koboshi::behaviour {

// The pose in which the robot has come to rest after a fall.
enum class LyingPose : std::uint8_t {
  kUpright,  // not lying: somebody holds the robot, or it did not fall after all
  kSitting,
  kProne,
  kSupine,
  kLeftSide,
  kRightSide,
};

// Classifies the pose of a robot at rest. `up_B`: unit vector against gravity in axes of the trunk B.
// `thigh_pitch`: pitch of the thighs from hanging straight down, positive with the knees behind the hips. The
// robot sits if the trunk is within 53 degrees of upright and the thighs are raised by more than 45 degrees.
// Every direction has a pose: the nearest one; a trunk upside down gets the side to which it leans.
[[nodiscard]] LyingPose classify(const robot::Direction& up_B, fixed::Angle thigh_pitch);

// Returns whether the trunk leans by less than 15 degrees, as that of a standing robot.
[[nodiscard]] bool is_upright(const robot::Direction& up_B);

// Returns whether the trunk leans by more than 60 degrees: the feet no longer carry the robot.
[[nodiscard]] bool is_down(const robot::Direction& up_B);

// Returns whether the trunk leans by less than 30 degrees: a robot that rests so can rest on its feet.
[[nodiscard]] bool can_rest_on_feet(const robot::Direction& up_B);

}  // namespace koboshi::behaviour
