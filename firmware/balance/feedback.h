#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/estimation/trunk_motion.h"
#include "firmware/fixed/literals.h"
#include "firmware/robot/model.h"

namespace koboshi::balance {

// By how much a joint of the legs is turned, in units of 2^-12. Zero is off.
struct JointGains {
  std::int16_t ankle_pitch = 0;
  std::int16_t ankle_roll = 0;
  std::int16_t hip_roll = 0;
  std::int16_t knee = 0;
  std::int16_t hip_pitch = 0;

  friend bool operator==(const JointGains&, const JointGains&) = default;
};

struct FeedbackGains {
  JointGains rate;  // in seconds, of the trunk's rate
  JointGains lean;  // of the angle by which it leans

  friend bool operator==(const FeedbackGains&, const FeedbackGains&) = default;
};

// The gains and dead band of every mode, objects 0x2101 to 0x2106.
struct FeedbackParameters {
  JointGains motion;  // of the rate: what a motion means the trunk to lean, nobody knows
  FeedbackGains standing;
  FeedbackGains walking;
  std::int16_t standing_dead_band = 0;  // 2^-12 turn/s: what is left of slower rates is none
};

enum class FeedbackMode : std::uint8_t { kNone, kStanding, kMotion, kWalking };

// Turns the joints of both legs so that they turn the trunk back. In proportion to its rate it is the paper's
// gyro feedback, by the law of ROBOTIS' OP3 (op3_online_walking_module); in proportion to its lean, feedback
// of the attitude. In the ankles it moves the ZMP under the feet, in the hips it swings the trunk.
//
// Signs. With the foot on the ground, a joint that turns its child about an axis turns all that is above it
// the other way. A trunk that pitches forward (rate about +y positive) is turned back by more pitch in hip,
// knee and ankle: the ankle's positive pitch presses the toes down and moves the ZMP ahead, in the direction
// of the fall. A trunk that rolls to the right (rate about +x positive) is turned back by more roll in hip
// and ankle: the ankle's positive roll presses the right edge of the foot down. So each joint's correction
// has the sign of the rate, and of its axis; both legs alike, since both sides have the same axes.
class Feedback {
 public:
  // More than this no joint is turned: a fall is no longer a matter of ankles.
  static constexpr auto kMaxCorrection = fixed::literals::operator""_deg(15.0L);

  // A model without legs gets no corrections.
  explicit Feedback(const robot::RobotModel& model);

  // Adds the corrections to the targets of the leg joints, which the caller then clamps to their limits.
  // Targets saturate at half a turn.
  void correct(const FeedbackGains& gains, const estimation::TrunkMotion& trunk,
               std::span<fixed::Angle> targets) const;
  // The same with the gains of a mode; nothing in kNone.
  void correct(FeedbackMode mode, const FeedbackParameters& parameters, const estimation::TrunkMotion& trunk,
               std::span<fixed::Angle> targets) const;

 private:
  struct Joint {
    robot::JointIndex index;
    std::int8_t sign = 0;  // of the axis; 0 where there is no such joint
  };
  struct Leg {
    Joint hip_roll;
    Joint hip_pitch;
    Joint knee;
    Joint ankle_pitch;
    Joint ankle_roll;
  };

  std::size_t joints_;
  hal::BySide<Leg> legs_{};
};

}  // namespace koboshi::balance
