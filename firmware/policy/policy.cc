#include "firmware/policy/policy.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "firmware/fixed/contract.h"
#include "firmware/fixed/interpolation.h"
#include "firmware/storage/image.h"
#include "hal/port/period.h"

namespace koboshi::policy {

using storage::ImageReader;
using storage::ImageStatus;

namespace {

constexpr std::size_t kModelIdSize = 4;
constexpr std::size_t kCountsAt = kModelIdSize + kPolicyNameSize;

// The core is little-endian, as the image is.
std::int32_t i32_at(const std::byte* aligned) {
  std::int32_t value = 0;
  std::memcpy(&value, __builtin_assume_aligned(aligned, sizeof(value)), sizeof(value));
  return value;
}
std::uint8_t u8_at(const std::byte* byte) { return std::to_integer<std::uint8_t>(*byte); }

bool is_hip_or_ankle(robot::JointRole role) {
  using enum robot::JointRole;
  return (role >= kLeftHipYaw && role <= kRightAnkleRoll) && role != kLeftKnee && role != kRightKnee;
}

bool is_signal(std::int32_t value) { return value >= -kMaxSignal && value <= kMaxSignal; }

}  // namespace

PolicyVerdict Policy::open(std::span<const std::byte> bytes, const robot::RobotModel& model, Policy& policy) {
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % sizeof(std::uint32_t) != 0)
    return {PolicyStatus::kMisaligned};
  storage::Image image;
  const ImageStatus opened = storage::open_image(bytes, kPolicyMagic, kPolicyVersion, image);
  if (opened != ImageStatus::kOk) return {static_cast<PolicyStatus>(opened)};
  if (image.body.size() < kPolicyFixedSize) return {PolicyStatus::kBadSize};
  if (ImageReader(image.body).u32() != model.id) return {PolicyStatus::kOtherRobot};
  Policy candidate;
  candidate.body_ = image.body.data();
  candidate.size_ = storage::kImageHeaderSize + image.body.size();
  if (const PolicyVerdict checked = candidate.check(model); !checked.ok()) return checked;
  policy = candidate;
  return {};
}

PolicyVerdict Policy::check(const robot::RobotModel& model) {
  const std::span<const std::byte> body{body_, size_ - storage::kImageHeaderSize};
  ImageReader counts(body.subspan(kCountsAt));
  input_count_ = counts.u8();
  output_count_ = counts.u8();
  layer_count_ = counts.u8();
  patience_ticks_ = counts.u8();
  if (input_count_ == 0 || input_count_ > kMaxInputs || output_count_ == 0 || output_count_ > kMaxOutputs ||
      layer_count_ == 0 || layer_count_ > kMaxLayers || patience_ticks_ == 0 ||
      patience_ticks_ > kMaxPatience_ticks) {
    return {PolicyStatus::kBadCount};
  }
  if (!storage::is_image_name(body.subspan(kModelIdSize, kPolicyNameSize))) return {PolicyStatus::kBadName};
  if (body.size() < layers_at() + layer_count_ * kLayerSize) return {PolicyStatus::kBadSize};
  if (const PolicyVerdict checked = check_inputs(); !checked.ok()) return checked;
  if (const PolicyVerdict checked = check_outputs(model); !checked.ok()) return checked;
  return check_layers(model, body);
}

PolicyVerdict Policy::check_inputs() const {
  for (std::size_t i = 0; i < padded(input_count_); ++i) {
    const std::uint8_t signal = u8_at(body_ + kPolicyFixedSize + i);
    if (i >= input_count_ ? signal != 0 : signal >= kSignals)
      return {PolicyStatus::kBadInput, static_cast<std::uint16_t>(i)};
  }
  for (std::size_t i = 0; i < input_count_; ++i) {
    const Input input = this->input(i);
    if (!is_signal(input.mean) || !is_signal(input.low) || !is_signal(input.high) || input.low > input.high)
      return {PolicyStatus::kBadInput, static_cast<std::uint16_t>(i)};
  }
  return {};
}

PolicyVerdict Policy::check_outputs(const robot::RobotModel& model) const {
  std::uint32_t joints = 0;
  for (std::size_t i = 0; i < output_count_; ++i) {
    const PolicyVerdict bad{PolicyStatus::kBadOutput, static_cast<std::uint16_t>(i)};
    const Output output = this->output(i);
    if ((i32_at(body_ + outputs_at() + i * kOutputSize) >> 8) != 0) return bad;
    if (output.joint >= model.joint_count || (joints >> output.joint & 1u) != 0) return bad;
    joints |= 1u << output.joint;
    const robot::Joint& joint = model.joints[output.joint];
    if (!is_hip_or_ankle(joint.role) || output.scale < -kMaxScale || output.scale > kMaxScale) return bad;
    if (output.bound <= fixed::Angle() || output.bound > kMaxOffset) return bad;
    const fixed::Angle turned = fixed::rotation(
        std::min(joint.max_speed, fixed::AngularRate::from_raw(1 << 28)), hal::kControlPeriod_us);
    if (output.rate <= fixed::Angle() || output.rate > turned) return bad;
  }
  return {};
}

PolicyVerdict Policy::check_layers(const robot::RobotModel& model, std::span<const std::byte> body) {
  work_ = Work::kFixed + static_cast<std::uint32_t>(Work::kJoint * model.joint_count) +
          Work::kInput * input_count_ + Work::kOutput * output_count_;
  std::size_t at = layers_at() + layer_count_ * kLayerSize;
  for (std::size_t i = 0; i < layer_count_; ++i) {
    const PolicyVerdict bad{PolicyStatus::kBadLayer, static_cast<std::uint16_t>(i)};
    const std::byte* const fields = body_ + layers_at() + i * kLayerSize;
    const std::size_t rows = u8_at(fields);
    const std::uint8_t function = u8_at(fields + 1);
    const int fraction_bits = u8_at(fields + 2);
    if (rows == 0 || rows > kMaxWidth || rows % kBlock != 0) return bad;
    if (i + 1 == layer_count_ && rows != padded(output_count_)) return bad;
    if (function > static_cast<std::uint8_t>(kLastActivation)) return bad;
    if (fraction_bits < kMinFractionBits || fraction_bits > kMaxFractionBits) return bad;
    if (u8_at(fields + 3) != 0 || i32_at(fields + 4) < 0) return bad;
    biases_at_[i] = static_cast<std::uint16_t>(at);
    const std::size_t columns = layer(i).columns;
    at += 4 * rows + rows * columns;
    if (at > body.size()) return {PolicyStatus::kBadSize};
    const std::uint32_t of_row = Work::kRow[function] + (fraction_bits < kMaxFractionBits ? Work::kWiden : 0);
    work_ += Work::kLayer +
             static_cast<std::uint32_t>(rows / kRowsAtOnce * Work::kRows + rows * columns + rows * of_row);
    if (work_ > kMaxWork) return {PolicyStatus::kTooMuchWork, static_cast<std::uint16_t>(i)};
    for (std::size_t row = 0; row < rows; ++row) {
      const std::int32_t bias = i32_at(body_ + biases_at_[i] + 4 * row);
      if (bias <= -kMaxBias || bias >= kMaxBias)
        return {PolicyStatus::kBadBias, static_cast<std::uint16_t>(i)};
    }
  }
  return {at == body.size() ? PolicyStatus::kOk : PolicyStatus::kBadSize};
}

void Policy::move_to(const std::byte* image) {
  KOBOSHI_ASSERT(reinterpret_cast<std::uintptr_t>(image) % sizeof(std::uint32_t) == 0);
  body_ = image + storage::kImageHeaderSize;
}

std::string_view Policy::name() const {
  if (body_ == nullptr) return {};
  return storage::image_name({body_ + kModelIdSize, kPolicyNameSize});
}

std::uint32_t Policy::crc32() const {
  if (body_ == nullptr) return 0;
  return static_cast<std::uint32_t>(i32_at(body_ - storage::kImageHeaderSize + storage::kImageCrcOffset));
}

Input Policy::input(std::size_t index) const {
  KOBOSHI_ASSERT(index < input_count_);
  const std::byte* const fields = body_ + inputs_at() + index * kInputSize;
  return {.signal = u8_at(body_ + kPolicyFixedSize + index),
          .mean = i32_at(fields),
          .multiplier = i32_at(fields + 4),
          .low = i32_at(fields + 8),
          .high = i32_at(fields + 12)};
}

Output Policy::output(std::size_t index) const {
  KOBOSHI_ASSERT(index < output_count_);
  const std::byte* const fields = body_ + outputs_at() + index * kOutputSize;
  return {.joint = u8_at(fields),
          .scale = i32_at(fields + 4),
          .bound = fixed::Angle::from_raw(i32_at(fields + 8)),
          .rate = fixed::Angle::from_raw(i32_at(fields + 12))};
}

Layer Policy::layer(std::size_t index) const {
  KOBOSHI_ASSERT(index < layer_count_);
  const std::byte* const fields = body_ + layers_at() + index * kLayerSize;
  const std::size_t rows = u8_at(fields);
  return {.columns = index == 0 ? padded(input_count_) : u8_at(fields - kLayerSize),
          .rows = rows,
          .activation = static_cast<Activation>(u8_at(fields + 1)),
          .fraction_bits = u8_at(fields + 2),
          .multiplier = i32_at(fields + 4),
          .biases = body_ + biases_at_[index],
          .weights = body_ + biases_at_[index] + 4 * rows};
}

std::size_t Policy::normalise(const Signals::Values& signals, Activations& in) const {
  const std::byte* const names = body_ + kPolicyFixedSize;
  const std::byte* const end = names + input_count_;
  const std::byte* fields = body_ + inputs_at();
  const std::byte* outside = end;
  std::int16_t* value = in.values.data();
  for (const std::byte* name = names; name != end; ++name, fields += kInputSize) {
    const std::int32_t low = i32_at(fields + 8);
    const std::int32_t high = i32_at(fields + 12);
    std::int32_t signal = signals[u8_at(name)];
    if (signal < low || signal > high) [[unlikely]] {
      if (outside == end) outside = name;
      signal = signal < low ? low : high;
    }
    *value++ = static_cast<std::int16_t>(rescale(signal - i32_at(fields), i32_at(fields + 4)));
  }
  std::fill(value, in.values.data() + padded(input_count_), std::int16_t{0});
  return static_cast<std::size_t>(outside - names);
}

const Activations& Policy::run(Activations& a, Activations& b) const {
  Activations* in = &a;
  Activations* out = &b;
  for (std::size_t i = 0; i < layer_count_; ++i) {
    layer(i).run(*in, *out);
    std::swap(in, out);
  }
  return *in;
}

}  // namespace koboshi::policy
