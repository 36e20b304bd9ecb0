#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace koboshi::motion {

// Motions that the behaviour plays by itself. It finds them by the names below.
enum class Role : std::uint8_t {
  kFallFront,  // protective pose of a fall in this direction
  kFallBack,
  kFallLeft,
  kFallRight,
  kRollLeft,  // from the left side to chest or back
  kRollRight,
  kRiseProne,  // from this pose to standing
  kRiseSupine,
  kRiseSeat,
};

inline constexpr std::array<std::string_view, 9> kMotionNames{"fall_front", "fall_back",   "fall_left",
                                                              "fall_right", "roll_left",   "roll_right",
                                                              "rise_prone", "rise_supine", "rise_seat"};

}  // namespace koboshi::motion
