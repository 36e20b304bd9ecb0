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

// Within 60 degrees of lying flat: nothing but links that are no feet can hold it now.
[[nodiscard]] bool is_down(const robot::Direction& up_B);

}  // namespace koboshi::recovery
