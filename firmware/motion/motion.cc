#include "firmware/motion/motion.h"

#include "firmware/fixed/contract.h"
#include "firmware/motion/check.h"
#include "firmware/storage/image.h"

namespace koboshi::motion {

using storage::ImageReader;
using storage::ImageStatus;

namespace {

// Returns whether the field is a name: at least one printable character, padded with zeros.
bool is_name(std::span<const std::byte> field) {
  bool ended = false;
  for (const std::byte letter : field) {
    const bool printable = letter >= std::byte{' '} && letter <= std::byte{'~'};
    if (printable ? ended : letter != std::byte{0}) return false;
    ended = !printable;
  }
  return field[0] != std::byte{0};
}

}  // namespace

MotionVerdict Motion::open(std::span<const std::byte> bytes, const robot::RobotModel& model, Motion& motion) {
  storage::Image image;
  const ImageStatus opened = storage::open_image(bytes, kMotionMagic, kMotionVersion, image);
  if (opened != ImageStatus::kOk) return {static_cast<MotionStatus>(opened)};
  if (image.body.size() < kMotionFixedSize) return {MotionStatus::kBadSize};

  const std::uint32_t model_id = ImageReader(image.body).u32();
  ImageReader counts(image.body.subspan(4 + kNameSize));
  Motion candidate;
  candidate.body_ = image.body;
  candidate.joint_count_ = counts.u16();
  candidate.pose_count_ = counts.u16();
  candidate.step_count_ = counts.u16();
  if (model_id != model.id) return {MotionStatus::kOtherRobot};
  if (candidate.joint_count_ != model.joint_count || candidate.pose_count_ > kMaxPoses ||
      candidate.step_count_ == 0 || candidate.step_count_ > kMaxSteps) {
    return {MotionStatus::kBadCount};
  }
  if (image.body.size() != kMotionFixedSize + candidate.pose_count_ * pose_size(candidate.joint_count_) +
                               candidate.step_count_ * kStepSize) {
    return {MotionStatus::kBadSize};
  }
  if (!is_name(image.body.subspan(4, kNameSize))) return {MotionStatus::kBadName};
  const MotionVerdict checked = check_motion(candidate, model);
  if (checked.ok()) motion = candidate;
  return checked;
}

bool ExpectedAttitude::is_met_by(const robot::Direction& up_B_now) const {
  const std::int64_t projection_raw = std::int64_t{up_B_now.x.raw()} * up_B[0] +
                                      std::int64_t{up_B_now.y.raw()} * up_B[1] +
                                      std::int64_t{up_B_now.z.raw()} * up_B[2];
  constexpr int kShift = fixed::Ratio::kFractionBits - 15;
  return projection_raw >= (std::int64_t{min_cosine} * 127 << kShift);
}

std::size_t Motion::image_size_bytes() const {
  return body_.empty() ? 0 : storage::kImageHeaderSize + body_.size();
}

std::string_view Motion::name() const {
  if (body_.empty()) return {};
  const std::span<const std::byte> field = body_.subspan(4, kNameSize);
  std::size_t length = 0;
  while (length < kNameSize && field[length] != std::byte{0}) ++length;
  return {reinterpret_cast<const char*>(field.data()), length};
}

std::uint32_t Motion::joint_mask(std::size_t pose) const {
  KOBOSHI_ASSERT(pose < pose_count_);
  return ImageReader(body_.subspan(kMotionFixedSize + pose * pose_size(joint_count_))).u32();
}

fixed::Angle Motion::angle(std::size_t pose, std::size_t joint) const {
  KOBOSHI_ASSERT(pose < pose_count_ && joint < joint_count_);
  const std::size_t offset = kMotionFixedSize + pose * pose_size(joint_count_) + 4 + 4 * joint;
  return fixed::Angle::from_raw(ImageReader(body_.subspan(offset)).i32());
}

Step Motion::step(std::size_t index) const {
  if (index >= step_count_) return {};
  ImageReader reader(
      body_.subspan(kMotionFixedSize + pose_count_ * pose_size(joint_count_) + index * kStepSize));
  Step step;
  step.opcode = static_cast<Opcode>(reader.u16());
  step.operand = reader.u16();
  step.time_us = reader.u32();
  return step;
}

}  // namespace koboshi::motion
