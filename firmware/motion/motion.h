#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/fixed/units.h"
#include "firmware/robot/model.h"

namespace koboshi::motion {

inline constexpr std::uint32_t kMotionMagic = 0x544F4D4Bu;  // "KMOT"
inline constexpr std::uint16_t kMotionVersion = 4;          // the newest
// The oldest version that is still played. Version 3 adds to it Move::at_least and Interpolation::kTrapezoid,
// version 4 kGain and kWindow.
inline constexpr std::uint16_t kOldestMotionVersion = 2;
inline constexpr std::uint16_t kAtLeastVersion = 3;
inline constexpr std::uint16_t kGainVersion = 4;  // and of kWindow
inline constexpr std::size_t kNameSize = 24;
inline constexpr std::size_t kMaxVariables = 16;
inline constexpr std::size_t kMaxPoseGroups = 32;
inline constexpr std::size_t kMaxPoses = 512;
inline constexpr std::size_t kMaxSteps = 1024;
inline constexpr std::size_t kMaxRoutines = 32;   // subroutines
inline constexpr std::size_t kMaxStackDepth = 8;  // of loops and calls together
inline constexpr std::size_t kMaxTests = 8;       // of one condition
inline constexpr std::uint16_t kNoStep = 0xFFFF;  // instead of a step's index
inline constexpr std::uint32_t kMinStepTime_us = 1'000;
inline constexpr std::uint32_t kMaxStepTime_us = 60'000'000;

// The operation of a step. The values are those of the image; new ones are appended. instructions.h describes
// the fields of each.
enum class Opcode : std::uint8_t {
  kEnd = 0,
  kMove = 1,       // to pose `operand`; joints that the pose leaves out stay
  kWait = 2,       // `value` us
  kLoopBegin = 3,  // repeats the steps up to its kLoopEnd `operand` times; 0: until stopped
  kLoopEnd = 4,    // closes the kLoopBegin at step `operand`
  kJump = 5,       // continues with step `operand` of the same loop body
  kExpect = 6,     // fails the motion unless the trunk has the ExpectedAttitude
  kTest = 7,       // a comparison of the kBranch or kAwait before it
  kBranch = 8,     // continues with step `operand` if the condition holds, else after its tests
  kAwait = 9,      // waits until the condition holds, at most `value` us; then continues with step `operand`
  kSet = 10,       // changes variable `operand`
  kCall = 11,      // calls the subroutine that begins at step `operand`
  kReturn = 12,
  kFail = 13,
  kMix = 14,       // adds a correction from gyro or attitude to the target of joint `operand`
  kMixClear = 15,  // removes all corrections
  kStiffness = 16,
  kLean = 17,    // declares an intended lean of the trunk
  kGain = 18,    // changes the gain of the position loops
  kWindow = 19,  // the part of the time of the kMove before it in which some of its joints turn
};
inline constexpr auto kLastOpcode = Opcode::kWindow;

struct Step {
  Opcode opcode = Opcode::kEnd;
  std::uint16_t operand = 0;
  std::uint32_t value = 0;
  std::uint8_t mode = 0;
};

// Returns whether time always passes in a step of this kind. kAwait may end at once.
constexpr bool takes_time(Opcode opcode) { return opcode == Opcode::kMove || opcode == Opcode::kWait; }
// Returns whether the step belongs to the one before it: it is never entered by itself.
constexpr bool is_attached(Opcode opcode) { return opcode == Opcode::kTest || opcode == Opcode::kWindow; }
// Returns whether a condition, the kTest steps that follow, belongs to the step.
constexpr bool has_condition(Opcode opcode) { return opcode == Opcode::kBranch || opcode == Opcode::kAwait; }

enum class MotionStatus : std::uint8_t {
  kOk = 0,
  kTruncated = 1,  // up to kBadCrc as storage::ImageStatus
  kBadMagic = 2,
  kBadVersion = 3,
  kBadSize = 4,
  kBadCrc = 5,
  kOtherRobot = 6,     // bound to another model
  kBadCount = 7,       // of joints, variables, pose groups, poses or steps
  kBadName = 8,        // empty, or not printable ASCII padded with zeros
  kBadPose = 9,        // spare bits that are not zero
  kBeyondLimits = 10,  // an angle
  kBadOpcode = 11,     // unknown, or a field that the opcode does not use is not zero
  kBadStepTime = 12,   // not within kMinStepTime_us..kMaxStepTime_us, or a speed of zero
  kNoSuchPose = 13,
  kBadLoop = 14,      // not properly nested, too deep, or a kLoopEnd that names another beginning
  kBadJump = 15,      // past the end, into or out of a loop or subroutine, to a test, or too long in sum
  kNoEnd = 16,        // the last step of the main program is neither kEnd nor kJump
  kTakesNoTime = 17,  // a cycle, or a chain of too many jumps backwards, in which no time may pass
  kBadAttitude = 18,  // of a kExpect: no direction
  kBadGroup =
      19,  // of poses: no joint, a joint that the robot has not, no pose, or a second one for its joints
  // A test or window that belongs to no condition or move, or one of these with a wrong number of them.
  kBadTest = 20,
  kBadSource = 21,   // an unknown source or variable, or an index that it has not
  kBadRoutine = 22,  // a call backwards, a return from the main program, too many, or one that does not end
  kTooDeep = 23,     // loops and calls together
  kBadExit = 24,     // not a step of the main program outside all loops
  kBadJoint = 25,    // a joint, gain, limit or percentage of a mix, stiffness or gain
};

// The result of a validation: the reason of a refusal, and the first pose, pose group or step that violates
// it (0 if none of them).
struct [[nodiscard]] MotionVerdict {
  MotionStatus status = MotionStatus::kOk;
  std::uint16_t index = 0;

  [[nodiscard]] constexpr bool ok() const { return status == MotionStatus::kOk; }
};

// Sizes in bytes of the image, for readers and writers.
inline constexpr std::size_t kMotionFixedSize = 4 + kNameSize + 4 + 8;
inline constexpr std::size_t kPoseGroupSize = 8;
inline constexpr std::size_t kStepSize = 8;
inline constexpr int kPoseBits = 14;  // of an angle
inline constexpr int kPoseShift = fixed::Angle::kFractionBits - kPoseBits;
constexpr std::size_t pose_size(std::size_t joints_of_group) { return (kPoseBits * joints_of_group + 7) / 8; }
// Returns the number of 2^-14 turn nearest to the angle, as an image stores it; half a turn becomes one less.
[[nodiscard]] std::int32_t pose_number(fixed::Angle angle);

// Poses that move the same joints.
struct PoseGroup {
  std::uint32_t joints = 0;  // bit i: joint i
  std::uint16_t count = 0;   // of poses
};

// Reads the angles of one pose, the lowest joint first, as stored: one may exceed its joint's limit by one
// LSB of 2^-14 turn.
class PoseReader {
 public:
  constexpr PoseReader() = default;
  constexpr PoseReader(std::uint32_t joints, const std::byte* bytes) : joints_(joints), bytes_(bytes) {}

  // Returns the joints of the pose that were not read yet; bit i: joint i.
  [[nodiscard]] constexpr std::uint32_t joints() const { return joints_; }
  // Reads the next joint's angle; there must be one.
  constexpr fixed::Angle read(std::size_t& joint) {
    joint = static_cast<std::size_t>(__builtin_ctz(joints_));
    joints_ &= joints_ - 1;
    while (bits_ < kPoseBits) {
      buffer_ |= std::to_integer<std::uint32_t>(*bytes_++) << bits_;
      bits_ += 8;
    }
    const std::uint32_t number = buffer_ << kPoseShift;
    buffer_ >>= kPoseBits;
    bits_ -= kPoseBits;
    return fixed::Angle::from_raw(static_cast<std::int32_t>(number));
  }
  // Returns the bits that are left of the last byte; after the last joint they are spare.
  [[nodiscard]] constexpr std::uint32_t rest() const { return buffer_; }

 private:
  std::uint32_t joints_ = 0;
  const std::byte* bytes_ = nullptr;
  std::uint32_t buffer_ = 0;
  int bits_ = 0;
};

// A view of a validated motion image, which is played in place. The bytes must outlive the view and must not
// change. docs/reference/motion-language.md describes the image.
class Motion {
 public:
  // Makes an empty motion, which ends at once.
  constexpr Motion() = default;

  // Validates the image at the start of `bytes` against the model; sets `motion` on kOk only. A valid motion
  // plays without reads outside the image, without cycles that take no time, and with every target within its
  // joint's limits.
  static MotionVerdict open(std::span<const std::byte> bytes, const robot::RobotModel& model, Motion& motion);

  // The results of a validation, which has to go through all steps.
  struct Findings {
    std::uint32_t claimed_joints = 0;
    std::uint16_t main_step_count = 0;
  };
  [[nodiscard]] Findings findings() const { return {claimed_joints_, main_step_count_}; }
  // Opens an image again that `open` has accepted with these findings, in a time that does not grow with the
  // image: some 200 instructions of the Cortex-M4. Its bytes must be the same, but may have moved.
  [[nodiscard]] static Motion reopen(std::span<const std::byte> bytes, const Findings& findings);

  [[nodiscard]] std::string_view name() const;
  // Returns the version of the image, kOldestMotionVersion to kMotionVersion; 0 for an empty motion.
  [[nodiscard]] std::uint16_t version() const { return version_; }
  // Bytes of the whole image, as its header states them; 0 for an empty motion.
  [[nodiscard]] std::size_t image_size_bytes() const;
  [[nodiscard]] std::size_t joint_count() const { return joint_count_; }
  [[nodiscard]] std::size_t variable_count() const { return variable_count_; }
  [[nodiscard]] std::size_t group_count() const { return group_count_; }
  [[nodiscard]] std::size_t pose_count() const { return pose_count_; }
  [[nodiscard]] std::size_t step_count() const { return step_count_; }
  // The steps of the main program; the subroutines follow it.
  [[nodiscard]] std::size_t main_step_count() const { return main_step_count_; }
  // Returns the step at which the motion continues after a stop; kNoStep if it has no exit path.
  [[nodiscard]] std::uint16_t exit_step() const { return exit_step_; }
  // The joints that the motion may move, stiffen or correct; bit i: joint i.
  [[nodiscard]] std::uint32_t claimed_joints() const { return claimed_joints_; }

  [[nodiscard]] PoseGroup group(std::size_t index) const;
  // Returns a mask: bit i is set if the pose gives an angle for joint i.
  [[nodiscard]] std::uint32_t joint_mask(std::size_t pose) const { return pose_reader(pose).joints(); }
  // Returns the angle that the pose gives for a joint, as stored; zero if it gives none.
  [[nodiscard]] fixed::Angle angle(std::size_t pose, std::size_t joint) const;
  [[nodiscard]] PoseReader pose_reader(std::size_t pose) const;
  // Returns the step; kEnd beyond the last one.
  [[nodiscard]] Step step(std::size_t index) const;
  [[nodiscard]] Opcode opcode(std::size_t index) const;

 private:
  bool read_counts(std::span<const std::byte> body);

  std::span<const std::byte> body_;
  const std::byte* poses_ = nullptr;
  const std::byte* steps_ = nullptr;
  std::uint32_t claimed_joints_ = 0;
  std::uint16_t pose_count_ = 0;
  std::uint16_t step_count_ = 0;
  std::uint16_t main_step_count_ = 0;
  std::uint16_t exit_step_ = kNoStep;
  std::uint8_t version_ = 0;
  std::uint8_t joint_count_ = 0;
  std::uint8_t variable_count_ = 0;
  std::uint8_t group_count_ = 0;
};

}  // namespace koboshi::motion
