#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/fixed/literals.h"
#include "firmware/robot/model.h"

namespace koboshi::balance {

// Seconds in units of 2^-12: a joint is turned by gain * rate. Zero is off.
struct FeedbackGains {
  std::int16_t ankle_pitch = 0;
  std::int16_t ankle_roll = 0;
  std::int16_t hip_roll = 0;
  std::int16_t knee = 0;

  friend bool operator==(const FeedbackGains&, const FeedbackGains&) = default;
};

// The paper's gyro feedback, by the law of ROBOTIS' OP3 (op3_online_walking_module): ankles, hips and knees
// of both legs give way in proportion to the trunk's rate, so that the legs turn the trunk back.
//
// Signs. With the foot on the ground, a joint that turns its child about an axis turns all that is above it
// the other way. A trunk that pitches forward (rate about +y positive) is turned back by more pitch in knee
// and ankle: the ankle's positive pitch presses the toes down and moves the ZMP ahead, in the direction of
// the fall. A trunk that rolls to the right (rate about +x positive) is turned back by more roll in hip and
// ankle: the ankle's positive roll presses the right edge of the foot down. So each joint's correction has
// the sign of the rate, and of its axis; both legs alike, since both sides have the same axes.
class GyroFeedback {
 public:
  // More than this no joint is turned: a fall is no longer a matter of ankles.
  static constexpr auto kMaxCorrection = fixed::literals::operator""_deg(15.0L);

  // A model without legs gets no corrections.
  explicit GyroFeedback(const robot::RobotModel& model);

  // Adds the corrections to the targets of the leg joints, which the caller then clamps to their limits.
  // `rates` are those of the trunk, in axes of B, free of bias. Targets saturate at half a turn.
  void correct(const FeedbackGains& gains, const robot::Vector<fixed::AngularRate>& rates,
               std::span<fixed::Angle> targets) const;

 private:
  struct Joint {
    std::uint8_t index = 0;
    std::int8_t sign = 0;  // of the axis; 0 where there is no such joint
  };
  struct Leg {
    Joint hip_roll;
    Joint knee;
    Joint ankle_pitch;
    Joint ankle_roll;
  };

  std::array<Leg, 2> legs_{};
};

}  // namespace koboshi::balance
