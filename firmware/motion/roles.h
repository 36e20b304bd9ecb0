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
  kSit,  // from standing to a seat on which the robot stays without torque
};

inline constexpr std::array<std::string_view, 10> kMotionNames{
    "fall_front", "fall_back",  "fall_left",   "fall_right", "roll_left",
    "roll_right", "rise_prone", "rise_supine", "rise_seat",  "sit"};

// Whether the robot stands when the behaviour plays the motion of this role. All others begin during or after
// a fall.
constexpr bool begins_on_feet(Role role) { return role == Role::kSit; }

}  // namespace koboshi::motion
