#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/estimation/trunk_motion.h"
#include "firmware/fixed/literals.h"
#include "firmware/robot/leg.h"
#include "firmware/robot/model.h"

namespace koboshi::balance {

// Feedback gains of the leg joints, in units of 2^-12; zero is off.
struct JointGains {
  std::int16_t ankle_pitch = 0;
  std::int16_t ankle_roll = 0;
  std::int16_t hip_roll = 0;
  std::int16_t knee = 0;
  std::int16_t hip_pitch = 0;

  friend bool operator==(const JointGains&, const JointGains&) = default;
};

struct FeedbackGains {
  JointGains rate;  // joint angle per trunk rate, in 2^-12 s
  JointGains lean;  // joint angle per lean of the trunk, in 2^-12

  friend bool operator==(const FeedbackGains&, const FeedbackGains&) = default;
};

// The gains and the dead band of all modes, objects 0x2101 to 0x2106.
struct FeedbackParameters {
  JointGains motion;  // of the rate only: a motion does not say which lean it plans
  FeedbackGains standing;
  FeedbackGains walking;
  std::int16_t standing_dead_band = 0;  // 2^-12 turn/s
};

enum class FeedbackMode : std::uint8_t { kNone, kStanding, kMotion, kWalking };

// Corrects the targets of the leg joints against the motion of the trunk:
//   dq = sign (k_rate w + k_lean a), clamped to +-kMaxCorrection,
// with the trunk's rate w and lean a about the joint's axis, and the sign of that axis in the model. The term
// of the rate is the paper's gyro feedback, in the form of ROBOTIS' OP3 (op3_online_walking_module); the term
// of the lean is attitude feedback. Corrections at the ankles move the ZMP below the feet, those at the hips
// swing the trunk.
//
// Signs. With the foot on the ground, a joint that turns its child about an axis turns everything above it
// the other way. A trunk that pitches forward (rate about +y positive) is turned back by more pitch in hip,
// knee and ankle: positive ankle pitch presses the toes down and moves the ZMP forward, in the direction of
// the fall. A trunk that rolls to the right (rate about +x positive) is turned back by more roll in hip and
// ankle: positive ankle roll presses the right edge of the foot down. Both legs get the same correction,
// since both sides have the same axes.
class Feedback {
 public:
  // Clamp of each joint's correction. Set by hand (2026-11-21): a lean that needs more is a fall, which
  // ankles cannot stop.
  static constexpr auto kMaxCorrection = fixed::literals::operator""_deg(15.0L);

  // Without legs in the model there are no corrections.
  explicit Feedback(const robot::RobotModel& model);

  // Adds the corrections to `targets`, one for each joint; the caller clamps them to the joints' limits. The
  // sums saturate at half a turn.
  void correct(const FeedbackGains& gains, const estimation::TrunkMotion& trunk,
               std::span<fixed::Angle> targets, std::optional<hal::Side> support = std::nullopt) const;
  // Likewise with the gains of a mode; none in kNone. In kStanding the rates pass a dead band first.
  // `support`: in kWalking, the only leg that is corrected; none: both are.
  void correct(FeedbackMode mode, const FeedbackParameters& parameters, const estimation::TrunkMotion& trunk,
               std::optional<hal::Side> support, std::span<fixed::Angle> targets) const;

 private:
  struct Joint {
    robot::JointIndex index;
    std::int8_t sign = 0;  // of the axis; 0 without such a joint
  };
  struct Leg {
    Joint hip_roll;
    Joint hip_pitch;
    Joint knee;
    Joint ankle_pitch;
    Joint ankle_roll;
    // For hips with an oblique axis: the angle of each hip joint (yaw, roll, pitch) that turns the leg by one
    // about x and about y, that is two columns of the inverse of the hip's Jacobian at joint zero.
    bool has_oblique_hip = false;
    std::array<robot::JointIndex, 3> hips{};
    std::array<fixed::Ratio, 3> for_roll{};
    std::array<fixed::Ratio, 3> for_pitch{};
  };

  static void set_hip(const robot::RobotModel& model, hal::Side side, Leg& leg);

  std::size_t joints_;
  hal::BySide<Leg> legs_{};
};

}  // namespace koboshi::balance
