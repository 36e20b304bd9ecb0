#pragma once

#include <cstdint>

#include "firmware/robot/geometry.h"

namespace koboshi::behaviour {

enum class LyingPose : std::uint8_t {
  kUpright,  // not lying: somebody holds it, or it caught itself
  kSitting,
  kProne,
  kSupine,
  kLeftSide,
  kRightSide,
};

// How the trunk lies, from the direction against gravity in its axes, and how far the thighs are turned from
// hanging down, positive when the knees are behind. It sits where the trunk is within 53 degrees of upright
// and the thighs are raised to the front by more than 45. Poses between those that have a name get the
// nearest one; a trunk on its head lies by what it leans to.
[[nodiscard]] LyingPose classify(const robot::Direction& up_B, fixed::Angle thigh_pitch);

// It leans by less than 15 degrees, as who stands.
[[nodiscard]] bool is_upright(const robot::Direction& up_B);

// It leans by more than 60 degrees: nothing but links that are no feet can hold it now.
[[nodiscard]] bool is_down(const robot::Direction& up_B);

// It leans by less than 30 degrees: what rests so can rest on its feet.
[[nodiscard]] bool can_rest_on_feet(const robot::Direction& up_B);

}  // namespace koboshi::behaviour
