#pragma once

#include <array>
#include <cstdint>

#include "firmware/walk/body.h"
#include "firmware/walk/footsteps.h"
#include "firmware/walk/velocity.h"

namespace koboshi::walk {

// How the robot walks, as it stands in the object dictionary. Lengths in 0.1 mm, angles in 2^-16 turn, shares
// in permille. What is changed takes effect when the robot begins to walk the next time. 0 in a value that
// the dictionary does not allow to be 0 means that it is not set.
struct WalkParameters {
  struct Steps {
    std::int16_t time_ms = 0;         // cut down to whole cycles of 10 ms
    std::int16_t double_support = 0;  // share of a step in which both soles rest
    std::int16_t width = 0;           // between the middle lines of the soles
    std::int16_t height = 0;          // of the swinging sole
    std::int16_t swing_profile =
        0;  // 1000: the swinging sole starts and lands without speed; 0: at constant speed
    std::int16_t acceleration[3] = {};  // ahead and aside in mm/s^2, of the turn in mrad/s^2
    // Limits of the swing foot's landing position relative to the support foot: within reach of the legs, and
    // no collision of the soles.
    std::int16_t max_forward = 0;  // ahead and behind
    std::int16_t max_lateral = 0;
    std::int16_t min_lateral = 0;

    friend bool operator==(const Steps&, const Steps&) = default;
  } step;  // 0x2130
  struct Posture {
    std::int16_t com_height = 0;   // of the centre of mass above the soles: the length of the pendulum
    std::int16_t zmp_forward = 0;  // of the planned ZMP, before the ankle
    std::int16_t zmp_inward = 0;   // of the planned ZMP, from the sole's middle line towards the other foot
    std::int16_t trunk_pitch = 0;  // lean ahead
    std::int16_t trunk_pitch_by_speed = 0;  // more of it, for each m/s ahead
    // Sag under the robot's weight, mrad for each metre of lever: of hip, knee and ankle, and of hip and
    // ankle to the side.
    std::int16_t pitch_compliance = 0;
    std::int16_t roll_compliance = 0;
    std::int16_t arm_swing = 0;  // of a shoulder, mrad for each metre that the other side's foot is ahead

    friend bool operator==(const Posture&, const Posture&) = default;
  } posture;  // 0x2131
  struct Reactions {
    // Share of the measured error of the mass's motion by which the next foothold moves.
    std::int16_t capture_forward = 0;
    std::int16_t capture_lateral = 0;
    std::int16_t dead_band = 0;          // of that error
    std::int16_t smoothing = 0;          // share of the last cycle's error that is kept
    std::int16_t touchdown_load_cN = 0;  // of the swinging foot, which ends a step early; 0: no load does
    std::int16_t heading_hold = 0;       // share of the heading's error by which a step turns back

    friend bool operator==(const Reactions&, const Reactions&) = default;
  } reaction;  // 0x2132

  friend bool operator==(const WalkParameters&, const WalkParameters&) = default;
};

// Whether all that a walk cannot do without is set, and the limits of the landing position leave a place
// between them.
[[nodiscard]] bool is_gait(const WalkParameters& parameters);

// The same in quantities.
struct Gait {
  Gait() : Gait(WalkParameters()) {}
  explicit Gait(const WalkParameters& parameters);

  std::int32_t step_ticks;
  fixed::Ratio step_s;        // the same as a time
  std::int32_t double_ticks;  // of them, in double support
  fixed::Length step_width;
  fixed::Length step_height;
  fixed::Ratio swing_profile;
  std::array<std::int32_t, 3> acceleration;  // as in Speed
  fixed::Length max_forward;
  fixed::Length max_lateral;
  fixed::Length min_lateral;
  fixed::Length com_height;
  fixed::Length zmp_forward;
  fixed::Length zmp_inward;
  fixed::Angle pitch;
  fixed::Angle pitch_at_1_m_per_s;  // beside it
  Compliance compliance;
  fixed::Ratio arm_swing;  // rad/m
  fixed::Ratio capture_forward;
  fixed::Ratio capture_lateral;
  fixed::Length dead_band;
  fixed::Ratio smoothing;
  fixed::Force touchdown_load;
  fixed::Ratio heading_hold;
};

// A velocity that follows its command no faster than the gait's acceleration allows.
class Speed {
 public:
  void approach(const Velocity& command, const Gait& gait);
  [[nodiscard]] bool is_zero() const { return values_ == std::array<std::int32_t, 3>{}; }
  [[nodiscard]] Stride stride(const Gait& gait) const;
  [[nodiscard]] fixed::Angle lean(const Gait& gait) const;
  // The turn of a cycle.
  [[nodiscard]] fixed::Angle turn() const;

 private:
  std::array<std::int32_t, 3> values_{};  // forward and left in 0.01 mm/s, turn in 0.01 mrad/s
};

}  // namespace koboshi::walk
