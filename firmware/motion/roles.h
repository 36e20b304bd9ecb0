#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace koboshi::motion {

// What the robot needs motions for. It has those whose names are these.
enum class Role : std::uint8_t {
  kFallFront,  // how it meets the ground
  kFallBack,
  kFallLeft,
  kFallRight,
  kRollLeft,  // from its left side to its chest or back
  kRollRight,
  kRiseProne,  // up to the stand
  kRiseSupine,
  kRiseSeat,
};

inline constexpr std::array<std::string_view, 9> kMotionNames{"fall_front", "fall_back",   "fall_left",
                                                              "fall_right", "roll_left",   "roll_right",
                                                              "rise_prone", "rise_supine", "rise_seat"};

}  // namespace koboshi::motion
