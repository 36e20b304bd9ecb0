#pragma once

#include <cstdint>

#include "firmware/robot/geometry.h"

namespace koboshi::recovery {

enum class Lying : std::uint8_t {
  kUpright,  // not lying: somebody holds it, or it caught itself
  kProne,
  kSupine,
  kLeftSide,
  kRightSide,
};

// How the trunk lies, from the direction against gravity in its axes. Poses between those that have a name
// get the nearest one; a trunk on its head or its seat lies by what it leans to.
[[nodiscard]] Lying classify(const robot::Direction& up_B);

// It leans by more than 60 degrees: nothing but links that are no feet can hold it now.
[[nodiscard]] bool is_down(const robot::Direction& up_B);

// It leans by less than 30 degrees: what rests so can rest on its feet.
[[nodiscard]] bool is_up(const robot::Direction& up_B);

}  // namespace koboshi::recovery
