#pragma once

#include <optional>

#include "firmware/robot/geometry.h"

namespace koboshi::estimation {

// The level axes of a sole in axes of B: forward along the sole's heading, left, both perpendicular to
// gravity.
struct LevelAxes {
  robot::Direction forward;
  robot::Direction left;
};

// Returns them; nothing while the sole stands on edge, tilted by more than 60 degrees. `up_B`: unit vector
// against gravity.
[[nodiscard]] std::optional<LevelAxes> level_axes(const robot::Rotation& R_BSole,
                                                  const robot::Direction& up_B);

}  // namespace koboshi::estimation
