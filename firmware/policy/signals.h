#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/estimation/robot_state.h"
#include "firmware/fixed/units.h"
#include "firmware/robot/model.h"
#include "firmware/walk/velocity.h"

namespace koboshi::policy {

inline constexpr std::size_t kMaxOutputs = 12;

// The place of an input signal, as an image names it. New ones are appended before kJointAngle's place in a
// new version of the image. Frames and signs are those of RobotState.
enum class Signal : std::uint8_t {
  kRoll = 0,           // 2^-24 turn
  kPitch = 1,          // 2^-24 turn
  kPlannedPitch = 2,   // of the trunk by the engine; 2^-24 turn
  kUpX = 3,            // to kUpZ: unit vector against gravity in B; 2^-24
  kRollRate = 6,       // to yaw: in B, free of bias; 2^-20 turn/s
  kAccelerationX = 9,  // to z: in B; 2^-16 m/s^2
  kVelocity = 12,      // commanded: forward, left in 2^-14 mm/s, turn in 2^-14 mrad/s
  kLoad = 15,          // of the left, the right foot; 2^-16 N
  kZmp = 17,           // x, y of the left, x, y of the right foot in its sole's frame; 2^-24 m
  kPhaseSine = 21,     // of the walk's phase, one turn for two steps; zero while it does not step; 2^-24
  kPhaseCosine = 22,
  kSwing = 23,       // 1 while the left foot swings, -1 for the right, 0 in double support; 2^-24
  kJointAngle = 24,  // of joint i at 24 + i, measured; 2^-24 turn
  kJointRate = kJointAngle + robot::kMaxJoints,   // of joint i, from two measured angles; 2^-20 turn/s
  kJointTarget = kJointRate + robot::kMaxJoints,  // of joint i by the engine, before feedback; 2^-24 turn
  kOutput = kJointTarget + robot::kMaxJoints,     // the offset of output k in the last cycle; 2^-24 turn
};
inline constexpr std::size_t kSignals = static_cast<std::size_t>(Signal::kOutput) + kMaxOutputs;
// Bound of every signal.
inline constexpr std::int32_t kMaxSignal = (1 << 30) - 1;

// All that a policy may know of a cycle.
struct Observation {
  const estimation::RobotState& robot;
  std::span<const fixed::Angle> angles;   // measured, of all joints
  std::span<const fixed::Angle> targets;  // of the engine
  fixed::Angle planned_pitch{};
  walk::Velocity velocity{};
  std::optional<fixed::Angle> phase{};  // of the walk; none while it does not step
  std::optional<hal::Side> swing{};
};

// The values of all signals, each within +-kMaxSignal.
class Signals {
 public:
  using Values = std::array<std::int32_t, kSignals>;

  // Sets all signals but the outputs. Rates are zero in the first call after forget().
  void update(const Observation& seen);
  void set_output(std::size_t output, fixed::Angle offset);
  void forget() { has_angles_ = false; }

  [[nodiscard]] const Values& values() const { return values_; }

 private:
  std::int32_t& at(Signal signal, std::size_t place = 0) {
    return values_[static_cast<std::size_t>(signal) + place];
  }

  Values values_{};
  bool has_angles_ = false;  // of the cycle before, in kJointAngle
};

}  // namespace koboshi::policy
