#include "firmware/motion/motion.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/rounding.h"
#include "firmware/motion/check.h"
#include "firmware/motion/instructions.h"
#include "firmware/storage/image.h"

namespace koboshi::motion {

using storage::ImageReader;
using storage::ImageStatus;

namespace {

// Bit by bit: for std::popcount, and for a loop over the set bits, a core without the instruction needs the
// compiler's library.
constexpr std::size_t joints_in(std::uint32_t mask) {
  std::size_t joints = 0;
  for (std::size_t joint = 0; joint < robot::kMaxJoints; ++joint) joints += mask >> joint & 1u;
  return joints;
}

// Little-endian fields at any address; `bytes` has room for them.
std::uint32_t u16_at(const std::byte* bytes) {
  return std::to_integer<std::uint32_t>(bytes[0]) | std::to_integer<std::uint32_t>(bytes[1]) << 8;
}
std::uint32_t u32_at(const std::byte* bytes) { return u16_at(bytes) | u16_at(bytes + 2) << 16; }

// Returns the joints that steps name directly.
std::uint32_t joints_of_steps(const Motion& motion) {
  std::uint32_t joints = 0;
  for (std::size_t i = 0; i < motion.step_count(); ++i) {
    const Opcode opcode = motion.opcode(i);
    if (opcode == Opcode::kMix) joints |= 1u << motion.step(i).operand;
    if (opcode == Opcode::kStiffness || opcode == Opcode::kGain) joints |= motion.step(i).value;
  }
  return joints;
}

}  // namespace

std::int32_t pose_number(fixed::Angle angle) {
  constexpr std::int64_t kHighest = (1 << (kPoseBits - 1)) - 1;
  return static_cast<std::int32_t>(std::min(fixed::shift_rounded(angle.raw(), kPoseShift), kHighest));
}

// Returns whether the reserved fields are zero.
bool Motion::read_counts(std::span<const std::byte> body) {
  ImageReader counts(body.subspan(4 + kNameSize));
  body_ = body;
  joint_count_ = counts.u8();
  variable_count_ = counts.u8();
  group_count_ = counts.u8();
  const bool reserved_1 = counts.u8() == 0;
  pose_count_ = counts.u16();
  step_count_ = counts.u16();
  exit_step_ = counts.u16();
  return counts.u16() == 0 && reserved_1;
}

MotionVerdict Motion::open(std::span<const std::byte> bytes, const robot::RobotModel& model, Motion& motion) {
  storage::Image image;
  Motion candidate;
  candidate.version_ = kMotionVersion;
  ImageStatus opened = storage::open_image(bytes, kMotionMagic, kMotionVersion, image);
  while (opened == ImageStatus::kBadVersion && candidate.version_ > kOldestMotionVersion)
    opened = storage::open_image(bytes, kMotionMagic, --candidate.version_, image);
  if (opened != ImageStatus::kOk) return {static_cast<MotionStatus>(opened)};
  if (image.body.size() < kMotionFixedSize) return {MotionStatus::kBadSize};

  const std::uint32_t model_id = ImageReader(image.body).u32();
  const bool reserved_are_zero = candidate.read_counts(image.body);
  if (model_id != model.id) return {MotionStatus::kOtherRobot};
  if (candidate.joint_count_ != model.joint_count || candidate.variable_count_ > kMaxVariables ||
      candidate.group_count_ > kMaxPoseGroups || candidate.pose_count_ > kMaxPoses ||
      candidate.step_count_ == 0 || candidate.step_count_ > kMaxSteps || !reserved_are_zero) {
    return {MotionStatus::kBadCount};
  }
  const std::size_t poses_at = kMotionFixedSize + candidate.group_count_ * kPoseGroupSize;
  if (image.body.size() < poses_at) return {MotionStatus::kBadSize};
  if (const MotionVerdict checked = check_groups(candidate); !checked.ok()) return checked;
  std::size_t steps_at = poses_at;
  for (std::size_t i = 0; i < candidate.group_count_; ++i) {
    const PoseGroup group = candidate.group(i);
    steps_at += group.count * pose_size(joints_in(group.joints));
    candidate.claimed_joints_ |= group.joints;
  }
  if (image.body.size() != steps_at + candidate.step_count_ * kStepSize) return {MotionStatus::kBadSize};
  candidate.poses_ = image.body.data() + poses_at;
  candidate.steps_ = image.body.data() + steps_at;
  if (!storage::is_image_name(image.body.subspan(4, kNameSize))) return {MotionStatus::kBadName};
  const MotionVerdict checked = check_motion(candidate, model, candidate.main_step_count_);
  if (!checked.ok()) return checked;
  candidate.claimed_joints_ |= joints_of_steps(candidate);
  motion = candidate;
  return checked;
}

Motion Motion::reopen(std::span<const std::byte> bytes, const Findings& findings) {
  const std::size_t size = u32_at(bytes.data() + storage::kImageSizeOffset);
  KOBOSHI_ASSERT(size <= bytes.size() && size >= storage::kImageHeaderSize + kMotionFixedSize);
  Motion motion;
  motion.version_ = std::to_integer<std::uint8_t>(bytes[storage::kImageVersionOffset]);
  static_cast<void>(
      motion.read_counts(bytes.subspan(storage::kImageHeaderSize, size - storage::kImageHeaderSize)));
  motion.poses_ = motion.body_.data() + kMotionFixedSize + motion.group_count_ * kPoseGroupSize;
  motion.steps_ = bytes.data() + size - motion.step_count_ * kStepSize;
  motion.claimed_joints_ = findings.claimed_joints;
  motion.main_step_count_ = findings.main_step_count;
  return motion;
}

std::size_t Motion::image_size_bytes() const {
  return body_.empty() ? 0 : storage::kImageHeaderSize + body_.size();
}

std::string_view Motion::name() const {
  if (body_.empty()) return {};
  return storage::image_name(body_.subspan(4, kNameSize));
}

PoseGroup Motion::group(std::size_t index) const {
  KOBOSHI_ASSERT(index < group_count_);
  const std::byte* bytes = body_.data() + kMotionFixedSize + index * kPoseGroupSize;
  return {u32_at(bytes), static_cast<std::uint16_t>(u16_at(bytes + 4))};
}

PoseReader Motion::pose_reader(std::size_t pose) const {
  KOBOSHI_ASSERT(pose < pose_count_);
  const std::byte* bytes = poses_;
  for (std::size_t i = 0; i < group_count_; ++i) {
    const PoseGroup poses = group(i);
    const std::size_t size = pose_size(joints_in(poses.joints));
    if (pose < poses.count) return {poses.joints, bytes + pose * size};
    pose -= poses.count;
    bytes += poses.count * size;
  }
  return {};  // the numbers of the groups add up to pose_count_
}

fixed::Angle Motion::angle(std::size_t pose, std::size_t joint) const {
  KOBOSHI_ASSERT(joint < joint_count_);
  for (PoseReader reader = pose_reader(pose); reader.joints() != 0;) {
    std::size_t read_joint = 0;
    const fixed::Angle angle = reader.read(read_joint);
    if (read_joint == joint) return angle;
  }
  return {};
}

Step Motion::step(std::size_t index) const {
  if (index >= step_count_) return {};
  const std::byte* bytes = steps_ + index * kStepSize;
  return {.opcode = static_cast<Opcode>(bytes[0]),
          .operand = static_cast<std::uint16_t>(u16_at(bytes + 2)),
          .value = u32_at(bytes + 4),
          .mode = std::to_integer<std::uint8_t>(bytes[1])};
}

Opcode Motion::opcode(std::size_t index) const {
  return index < step_count_ ? static_cast<Opcode>(steps_[index * kStepSize]) : Opcode::kEnd;
}

}  // namespace koboshi::motion
