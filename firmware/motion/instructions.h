#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/motion.h"
#include "firmware/robot/geometry.h"

namespace koboshi::motion {

// The fields of the steps by opcode. Each has `step`, which encodes them, and `of`, which decodes them.

enum class Interpolation : std::uint8_t {
  kLinear = 0,
  kMinimumJerk = 1,  // 10 s^3 - 15 s^4 + 6 s^5 (Flash and Hogan 1985): starts and ends at rest
  kCubic = 2,        // through successive poses without stopping, see trajectory.h
  kTrapezoid = 3,    // of the speed: a third of the time each for acceleration, constant speed, deceleration
};
inline constexpr auto kLastInterpolation = Interpolation::kTrapezoid;

// kMove.
struct Move {
  static constexpr std::uint8_t kInterpolationMask = 3;
  static constexpr std::uint8_t kBySpeed = 4;
  static constexpr std::uint8_t kAtLeast = 8;
  static constexpr int kWindowsShift = 4;
  static constexpr std::uint8_t kWindowsMask = 7 << kWindowsShift;
  static constexpr std::uint8_t kModeMask = kInterpolationMask | kBySpeed | kAtLeast | kWindowsMask;
  static constexpr std::uint8_t kMaxWindows = 4;

  Interpolation interpolation = Interpolation::kLinear;
  bool by_speed = false;  // `value` is the peak speed of the fastest joint, 2^-24 turn/s, instead of a time
  std::uint16_t pose = 0;
  std::uint32_t value = 0;  // us, kMinStepTime_us..kMaxStepTime_us
  // `value` is the least time; the move takes as much more as its joints need from where they are, each
  // within its speed limit in the model. Neither by speed nor a cubic, whose peak speed depends on the next
  // move.
  bool at_least = false;
  // The number of kWindow steps that follow, at most kMaxWindows. Not by speed, with a least time, or a
  // cubic.
  std::uint8_t windows = 0;

  constexpr Step step() const {
    const unsigned mode = static_cast<unsigned>(interpolation) | (by_speed ? kBySpeed : 0u) |
                          (at_least ? kAtLeast : 0u) | static_cast<unsigned>(windows << kWindowsShift);
    return {Opcode::kMove, pose, value, static_cast<std::uint8_t>(mode)};
  }
  static constexpr Move of(const Step& step) {
    return {static_cast<Interpolation>(step.mode & kInterpolationMask),
            (step.mode & kBySpeed) != 0,
            step.operand,
            step.value,
            (step.mode & kAtLeast) != 0,
            static_cast<std::uint8_t>((step.mode & kWindowsMask) >> kWindowsShift)};
  }
};

// kWindow: these joints turn from `start` to `end` of the time of their move, and rest before and after.
// A joint in several windows of a move counts in the first. 0 <= start < end <= kWhole.
struct Window {
  static constexpr int kBits = 12;
  static constexpr std::uint16_t kWhole = 1 << kBits;

  std::uint16_t start = 0;     // in 2^-12 of the move's time, as `end`
  std::uint16_t end = kWhole;  // at least 1
  std::uint32_t joints = 0;    // bit i: joint i

  constexpr Step step() const {
    const unsigned times = start | (end - 1u) << kBits;
    return {Opcode::kWindow, static_cast<std::uint16_t>(times), joints,
            static_cast<std::uint8_t>(times >> 16)};
  }
  static constexpr Window of(const Step& step) {
    const unsigned times = step.operand | unsigned{step.mode} << 16;
    return {static_cast<std::uint16_t>(times % kWhole), static_cast<std::uint16_t>((times >> kBits) + 1u),
            step.value};
  }
};

// kExpect: the expected direction against gravity in axes of the trunk B, and its tolerance.
struct ExpectedAttitude {
  std::array<std::int8_t, 3> up_B{};  // unit vector times 127; its length is 100 to 154 after rounding
  std::int16_t min_cosine = 0;        // of the tolerance angle, times 2^15

  constexpr Step step() const {
    std::uint32_t packed = 0;
    for (std::size_t i = 0; i < up_B.size(); ++i)
      packed |= std::uint32_t{static_cast<std::uint8_t>(up_B[i])} << 8 * i;
    return {Opcode::kExpect, static_cast<std::uint16_t>(min_cosine), packed};
  }
  static constexpr ExpectedAttitude of(const Step& step) {
    ExpectedAttitude expected;
    for (std::size_t i = 0; i < expected.up_B.size(); ++i)
      expected.up_B[i] = static_cast<std::int8_t>(step.value >> 8 * i);
    expected.min_cosine = static_cast<std::int16_t>(step.operand);
    return expected;
  }
  // Returns whether `up_B_now` is within the tolerance.
  bool is_met_by(const robot::Direction& up_B_now) const;
};

// A number that the program can read: a variable, or a measurement. All are integers in the unit given here.
enum class Source : std::uint8_t {
  kVariable = 0,  // [variable]
  kRoll = 1,      // mdeg, right positive
  kPitch = 2,     // mdeg, forward positive
  kRollRate = 3,  // mdeg/s, as the next two
  kPitchRate = 4,
  kYawRate = 5,
  kLeftContact = 6,  // 1 if the foot's load is valid, else 0; as the next
  kRightContact = 7,
  kLeftLoad = 8,  // mN, as the next
  kRightLoad = 9,
  kZmpX = 10,  // um in the frame of the sole that carries more, as the next; 0 while not valid
  kZmpY = 11,
  kZmpValid = 12,
  kJointAngle = 13,   // [joint], mdeg, measured
  kJointError = 14,   // [joint], mdeg, target - measured
  kJointTorque = 15,  // [joint], 0.1 % of the rated torque
  kSupply = 16,       // mV, the lowest of the drives' last readings
  kInput = 17,        // [0..7], as a CAN master wrote it
  kStopping = 18,     // 1 after a stop command
  kWalking = 19,      // 1 while the robot walks
  kTime = 20,         // ms since the motion's start
};
inline constexpr auto kLastSource = Source::kTime;
inline constexpr std::size_t kInputCount = 8;

struct SourceRef {
  Source source = Source::kVariable;
  std::uint8_t index = 0;

  constexpr std::uint16_t packed() const {
    return static_cast<std::uint16_t>(static_cast<unsigned>(source) | unsigned{index} << 8);
  }
  static constexpr SourceRef of(std::uint32_t packed) {
    return {static_cast<Source>(packed & 0xFF), static_cast<std::uint8_t>(packed >> 8)};
  }
};

enum class Comparison : std::uint8_t {
  kEqual = 0,
  kNotEqual = 1,
  kLess = 2,
  kLessOrEqual = 3,
  kGreater = 4,
  kGreaterOrEqual = 5,
};
inline constexpr auto kLastComparison = Comparison::kGreaterOrEqual;

// kTest: compares `left` with a number or a variable.
struct Test {
  static constexpr std::uint8_t kComparisonMask = 7;
  static constexpr std::uint8_t kWithVariable = 0x80;
  static constexpr std::uint8_t kModeMask = kComparisonMask | kWithVariable;

  SourceRef left;
  Comparison comparison = Comparison::kEqual;
  bool with_variable = false;
  std::int32_t right = 0;  // the number, or the variable's index

  constexpr Step step() const {
    const unsigned mode = static_cast<unsigned>(comparison) | (with_variable ? kWithVariable : 0u);
    return {Opcode::kTest, left.packed(), static_cast<std::uint32_t>(right), static_cast<std::uint8_t>(mode)};
  }
  static constexpr Test of(const Step& step) {
    return {SourceRef::of(step.operand), static_cast<Comparison>(step.mode & kComparisonMask),
            (step.mode & kWithVariable) != 0, static_cast<std::int32_t>(step.value)};
  }
};

// The condition of a kBranch or kAwait: the tests that follow the step.
struct Condition {
  static constexpr std::uint8_t kCountMask = 15;
  static constexpr std::uint8_t kAny = 16;
  static constexpr std::uint8_t kNegated = 32;
  static constexpr std::uint8_t kModeMask = kCountMask | kAny | kNegated;

  std::uint8_t count = 1;  // of tests, 1..kMaxTests
  bool any = false;        // of the tests must hold, instead of all
  bool negated = false;    // the condition holds if the tests do not

  constexpr std::uint8_t mode() const {
    return static_cast<std::uint8_t>(count | (any ? kAny : 0u) | (negated ? kNegated : 0u));
  }
  static constexpr Condition of(const Step& step) {
    return {static_cast<std::uint8_t>(step.mode & kCountMask), (step.mode & kAny) != 0,
            (step.mode & kNegated) != 0};
  }
  constexpr Step branch(std::uint16_t target) const { return {Opcode::kBranch, target, 0, mode()}; }
  // `target`: where the motion continues at the time-out; kNoStep: it fails.
  constexpr Step await(std::uint16_t target, std::uint32_t timeout_us) const {
    return {Opcode::kAwait, target, timeout_us, mode()};
  }
};

// Returns how many of the steps that follow belong to the step: the tests of a condition, the windows of a
// move.
constexpr std::size_t attached_steps(const Step& step) {
  if (has_condition(step.opcode)) return Condition::of(step).count;
  return step.opcode == Opcode::kMove ? Move::of(step).windows : 0;
}

enum class Arithmetic : std::uint8_t {
  kAssign = 0,
  kAdd = 1,
  kSubtract = 2,
  kMultiply = 3,
  kDivide = 4,     // truncated
  kRemainder = 5,  // of the truncated division
  kMinimum = 6,
  kMaximum = 7,
};

// kSet: variable = variable (operation) right. 32 bits, saturating; a division by zero fails the motion.
struct Assignment {
  static constexpr std::uint8_t kOperationMask = 7;
  static constexpr std::uint8_t kFromSource = 0x80;
  static constexpr std::uint8_t kModeMask = kOperationMask | kFromSource;

  std::uint16_t variable = 0;
  Arithmetic operation = Arithmetic::kAssign;
  bool from_source = false;
  std::int32_t right = 0;  // the number, or the packed SourceRef

  constexpr Step step() const {
    const unsigned mode = static_cast<unsigned>(operation) | (from_source ? kFromSource : 0u);
    return {Opcode::kSet, variable, static_cast<std::uint32_t>(right), static_cast<std::uint8_t>(mode)};
  }
  static constexpr Assignment of(const Step& step) {
    return {step.operand, static_cast<Arithmetic>(step.mode & kOperationMask), (step.mode & kFromSource) != 0,
            static_cast<std::int32_t>(step.value)};
  }
};

enum class MixSource : std::uint8_t { kRollRate = 0, kPitchRate = 1, kYawRate = 2, kRoll = 3, kPitch = 4 };
inline constexpr auto kLastMixSource = MixSource::kPitch;

// kMix: adds gain * deviation to the joint's target, for rates the rate, for roll and pitch the deviation
// from the declared lean, until it is changed. A gain of zero removes the correction.
struct Mix {
  static constexpr std::uint16_t kMinLimit = 182;   // 1 degree
  static constexpr std::uint16_t kMaxLimit = 2731;  // 15 degrees

  MixSource source = MixSource::kRollRate;
  std::uint8_t joint = 0;
  std::int16_t gain = 0;            // 2^-12; s for rates
  std::uint16_t limit = kMinLimit;  // of the correction, 2^-16 turn

  constexpr Step step() const {
    return {Opcode::kMix, joint, static_cast<std::uint16_t>(gain) | std::uint32_t{limit} << 16,
            static_cast<std::uint8_t>(source)};
  }
  static constexpr Mix of(const Step& step) {
    return {static_cast<MixSource>(step.mode), static_cast<std::uint8_t>(step.operand),
            static_cast<std::int16_t>(step.value), static_cast<std::uint16_t>(step.value >> 16)};
  }
};

// kStiffness, kGain: a share of what a drive has by itself.
template <Opcode kOpcode, std::uint8_t kMin_percent, std::uint8_t kMax_percent>
struct DriveShare {
  static constexpr std::uint8_t kFull = 100;
  static constexpr std::uint8_t kMin = kMin_percent;
  static constexpr std::uint8_t kMax = kMax_percent;

  std::uint8_t percent = kFull;
  std::uint32_t joints = 0;  // bit i: joint i

  constexpr Step step() const { return {kOpcode, 0, joints, percent}; }
  static constexpr DriveShare of(const Step& step) { return {step.mode, step.value}; }
};

using Stiffness = DriveShare<Opcode::kStiffness, 0, 100>;  // of the full torque
// Range of the gain of the position loop. Beyond twice the gain, delays of a small servo make its loop swing.
using Gain = DriveShare<Opcode::kGain, 1, 200>;

// A lean of the trunk.
struct Lean {
  fixed::Angle roll;   // right positive
  fixed::Angle pitch;  // forward positive

  friend constexpr bool operator==(const Lean&, const Lean&) = default;
};

// kLean: declares that the trunk leans so from the end of the next step that takes time; within that step the
// declared lean moves there from the present one.
struct LeanDeclaration {
  std::int16_t pitch = 0;  // 2^-16 turn, forward positive
  std::int16_t roll = 0;   // 2^-16 turn, right positive

  constexpr Step step() const {
    return {Opcode::kLean, static_cast<std::uint16_t>(pitch), static_cast<std::uint16_t>(roll)};
  }
  static constexpr LeanDeclaration of(const Step& step) {
    return {static_cast<std::int16_t>(step.operand), static_cast<std::int16_t>(step.value)};
  }
  constexpr Lean lean() const {
    constexpr int kScale = 1 << (fixed::Angle::kFractionBits - 16);
    return {fixed::Angle::from_raw(roll * kScale), fixed::Angle::from_raw(pitch * kScale)};
  }
};

}  // namespace koboshi::motion
