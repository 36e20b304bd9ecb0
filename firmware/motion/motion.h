#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/fixed/units.h"
#include "firmware/robot/geometry.h"
#include "firmware/robot/model.h"

namespace koboshi::motion {

inline constexpr std::uint32_t kMotionMagic = 0x544F4D4Bu;  // "KMOT"
inline constexpr std::uint16_t kMotionVersion = 1;
inline constexpr std::size_t kNameSize = 24;
inline constexpr std::size_t kMaxPoses = 512;
inline constexpr std::size_t kMaxSteps = 1024;
inline constexpr std::size_t kMaxLoopDepth = 4;
inline constexpr std::size_t kMaxJumps = 16;
// Limit for consecutive steps that take no time.
inline constexpr std::size_t kMaxZeroTimeSteps = 16;
inline constexpr std::uint32_t kMinStepTime_us = 1'000;
inline constexpr std::uint32_t kMaxStepTime_us = 60'000'000;

// The operation of a step. The values are those of the image; new ones are appended.
enum class Opcode : std::uint16_t {
  kEnd = 0,
  kMove = 1,  // to pose `operand` in time_us, linearly in joint angles; joints that the pose leaves out stay
  kWait = 2,  // time_us
  kLoopBegin = 3,  // repeats the steps up to its kLoopEnd `operand` times; 0: until stopped
  kLoopEnd = 4,    // closes the kLoopBegin at step `operand`
  kJump = 5,       // continues with step `operand` of the same loop body
  kExpect = 6,     // fails the motion unless the trunk has the ExpectedAttitude
};

struct Step {
  Opcode opcode = Opcode::kEnd;
  std::uint16_t operand = 0;
  std::uint32_t time_us = 0;  // zero unless the step takes time, or expects an attitude
};

// The operand of a kExpect step: the expected direction against gravity in axes of the trunk B, and its
// tolerance.
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
      expected.up_B[i] = static_cast<std::int8_t>(step.time_us >> 8 * i);
    expected.min_cosine = static_cast<std::int16_t>(step.operand);
    return expected;
  }
  // Returns whether `up_B_now` is within the tolerance.
  bool is_met_by(const robot::Direction& up_B_now) const;
};

constexpr bool takes_time(Opcode opcode) { return opcode == Opcode::kMove || opcode == Opcode::kWait; }

enum class MotionStatus : std::uint8_t {
  kOk = 0,
  kTruncated = 1,  // up to kBadCrc as storage::ImageStatus
  kBadMagic = 2,
  kBadVersion = 3,
  kBadSize = 4,
  kBadCrc = 5,
  kOtherRobot = 6,  // bound to another model
  kBadCount = 7,    // of joints, poses or steps
  kBadName = 8,     // empty, or not printable ASCII padded with zeros
  kBadPose = 9,     // a joint that the robot has not, or an angle given for a joint that the pose leaves out
  kBeyondLimits = 10,  // an angle
  kBadOpcode = 11,     // unknown, or a field that the opcode does not use is not zero
  kBadStepTime = 12,   // not within kMinStepTime_us..kMaxStepTime_us
  kNoSuchPose = 13,
  kBadLoop = 14,      // not properly nested, too deep, or a kLoopEnd that names another beginning
  kBadJump = 15,      // past the end, into or out of a loop, or too many
  kNoEnd = 16,        // the last step is not kEnd
  kTakesNoTime = 17,  // a loop, or a chain of too many steps, in which no time passes
  kBadAttitude = 18,  // of a kExpect: no direction
};

// The result of a validation: the reason of a refusal, and the first pose or step that violates it (0 if
// neither).
struct [[nodiscard]] MotionVerdict {
  MotionStatus status = MotionStatus::kOk;
  std::uint16_t index = 0;

  [[nodiscard]] constexpr bool ok() const { return status == MotionStatus::kOk; }
};

// A view of a validated motion image, which is played in place. The bytes must outlive the view and must not
// change.
//
// Layout after the header of storage/image.h: model id u32; name 24 bytes; joint, pose and step count u16
// each; poses of (mask u32, angle i32 for each joint); steps of (opcode u16, operand u16, time_us u32).
class Motion {
 public:
  // Makes an empty motion, which ends at once.
  constexpr Motion() = default;

  // Validates the image at the start of `bytes` against the model; sets `motion` on kOk only. A valid motion
  // plays without reads outside the image, without cycles that take no time, and with every target within its
  // joint's limits.
  static MotionVerdict open(std::span<const std::byte> bytes, const robot::RobotModel& model, Motion& motion);

  [[nodiscard]] std::string_view name() const;
  // Bytes of the whole image, as its header states them; 0 for an empty motion.
  [[nodiscard]] std::size_t image_size_bytes() const;
  [[nodiscard]] std::size_t joint_count() const { return joint_count_; }
  [[nodiscard]] std::size_t pose_count() const { return pose_count_; }
  [[nodiscard]] std::size_t step_count() const { return step_count_; }

  // Returns a mask: bit i is set if the pose gives an angle for joint i.
  [[nodiscard]] std::uint32_t joint_mask(std::size_t pose) const;
  [[nodiscard]] fixed::Angle angle(std::size_t pose, std::size_t joint) const;
  [[nodiscard]] Step step(std::size_t index) const;

 private:
  std::span<const std::byte> body_;
  std::uint16_t joint_count_ = 0;
  std::uint16_t pose_count_ = 0;
  std::uint16_t step_count_ = 0;
};

// Sizes in bytes, for writers of images.
inline constexpr std::size_t kMotionFixedSize = 4 + kNameSize + 6;
inline constexpr std::size_t kStepSize = 8;
constexpr std::size_t pose_size(std::size_t joint_count) { return 4 + 4 * joint_count; }

}  // namespace koboshi::motion
