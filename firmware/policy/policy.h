#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/fixed/units.h"
#include "firmware/policy/network.h"
#include "firmware/policy/signals.h"
#include "firmware/robot/model.h"

// A learned controller: a network from signals of the robot to offsets of joint targets.
namespace koboshi::policy {

inline constexpr std::uint32_t kPolicyMagic = 0x4C4F504Bu;  // "KPOL"
inline constexpr std::uint16_t kPolicyVersion = 1;
inline constexpr std::size_t kPolicyNameSize = 24;
inline constexpr std::size_t kMaxInputs = kMaxWidth;
inline constexpr std::uint8_t kMaxPatience_ticks = 100;

// Limit of every offset, as of the feedback's corrections (balance/feedback.h).
inline constexpr fixed::Angle kMaxOffset = fixed::Angle::from_raw(178'956'971);  // 15 degrees

// Instructions of the Cortex-M4 in one evaluation, by the numbers of an image: at most those that QEMU counts
// for each part (tests/bench/target_kernels/policy_kernels.cc, 27 November 2026, GCC 12.2), rounded up.
inline constexpr std::uint32_t kMaxWork = 12'000;
struct Work {
  static constexpr std::uint32_t kFixed = 460;
  static constexpr std::uint32_t kJoint = 17;  // of the robot
  static constexpr std::uint32_t kInput = 21;
  static constexpr std::uint32_t kOutput = 42;
  static constexpr std::uint32_t kLayer = 115;
  static constexpr std::uint32_t kRows = 24;  // kRowsAtOnce of them, beside one for each weight
  // A row with this activation function; more where its pre-activations have fewer than kMaxFractionBits.
  static constexpr std::uint32_t kRow[] = {9, 10, 19, 15, 18};
  static constexpr std::uint32_t kWiden = 5;
};

enum class PolicyStatus : std::uint8_t {
  kOk = 0,
  kTruncated = 1,  // up to kBadCrc as storage::ImageStatus
  kBadMagic = 2,
  kBadVersion = 3,
  kBadSize = 4,
  kBadCrc = 5,
  kOtherRobot = 6,    // bound to another model
  kBadCount = 7,      // of inputs, outputs or layers, the patience, or a reserved field that is not zero
  kBadName = 8,       // empty, or not printable ASCII padded with zeros
  kBadInput = 9,      // an unknown signal, a mean or range beyond kMaxSignal, or an empty range
  kBadOutput = 10,    // no hip or ankle, a second one for its joint, or a scale, bound or rate out of range
  kBadLayer = 11,     // a size, function or rescaling that a layer cannot have
  kBadBias = 12,      // not below kMaxBias
  kTooMuchWork = 13,  // more than kMaxWork
  kMisaligned = 14,   // its address is no multiple of 4
};

// The result of a validation: the reason of a refusal, and the first input, output or layer that violates it
// (0 if none of them).
struct [[nodiscard]] PolicyVerdict {
  PolicyStatus status = PolicyStatus::kOk;
  std::uint16_t index = 0;

  [[nodiscard]] constexpr bool ok() const { return status == PolicyStatus::kOk; }
};

// Sizes in bytes of the image, for readers and writers.
inline constexpr std::size_t kPolicyFixedSize = 4 + kPolicyNameSize + 4;
inline constexpr std::size_t kInputSize = 16;
inline constexpr std::size_t kOutputSize = 16;
inline constexpr std::size_t kLayerSize = 8;

// How a signal becomes an activation: saturate16((clamp(signal, low, high) - mean) * multiplier / 2^32),
// rounded to nearest. A signal outside low..high is outside the range seen in training.
struct Input {
  std::uint8_t signal = 0;
  std::int32_t mean = 0;
  std::int32_t multiplier = 0;
  std::int32_t low = 0;
  std::int32_t high = 0;
};

// How an activation of the last layer becomes the offset of a joint's target: times `scale`, in raw units of
// Angle, and clamped to +-bound. It changes by at most `rate` in a cycle.
struct Output {
  std::uint8_t joint = 0;
  std::int32_t scale = 0;  // |scale| <= kMaxScale
  fixed::Angle bound;      // above 0, at most kMaxOffset
  fixed::Angle rate;       // above 0, at most what the joint's servo turns in a cycle
};
// Times an int16 it is at most a quarter turn.
inline constexpr std::int32_t kMaxScale = 1 << 15;

// A view of a validated policy image, which runs in place. The bytes must outlive the view and must not
// change. docs/reference/policy.md describes the image.
class Policy {
 public:
  // Makes an empty policy, without inputs and outputs.
  constexpr Policy() = default;

  // Validates the image at the start of `bytes` against the model; sets `policy` on kOk only. The evaluation
  // of a valid policy reads nothing outside the image, no sum of it overflows, and it takes at most kMaxWork
  // instructions of the Cortex-M4.
  static PolicyVerdict open(std::span<const std::byte> bytes, const robot::RobotModel& model, Policy& policy);
  // The same policy at another address, to which its bytes have moved; a multiple of 4.
  void move_to(const std::byte* image);

  [[nodiscard]] std::string_view name() const;
  // CRC-32 in the image's header.
  [[nodiscard]] std::uint32_t crc32() const;
  // Bytes of the whole image, as its header states them; 0 for an empty policy.
  [[nodiscard]] std::size_t image_size_bytes() const { return size_; }
  [[nodiscard]] std::size_t input_count() const { return input_count_; }
  [[nodiscard]] std::size_t output_count() const { return output_count_; }
  [[nodiscard]] std::size_t layer_count() const { return layer_count_; }
  // Cycles in a row in which inputs or outputs may leave their range.
  [[nodiscard]] std::uint8_t patience_ticks() const { return patience_ticks_; }
  // Instructions of an evaluation, at most (Work).
  [[nodiscard]] std::uint32_t work() const { return work_; }

  [[nodiscard]] Input input(std::size_t index) const;
  [[nodiscard]] Output output(std::size_t index) const;
  // The layer; its bytes are those of the image.
  [[nodiscard]] Layer layer(std::size_t index) const;

  // Sets the activations of the first layer. Returns the first input outside its range, input_count() if
  // there is none.
  std::size_t normalise(const Signals::Values& signals, Activations& in) const;
  // Runs the network. `a` has its inputs; returns which of the two has the outputs.
  const Activations& run(Activations& a, Activations& b) const;

 private:
  [[nodiscard]] PolicyVerdict check(const robot::RobotModel& model);
  [[nodiscard]] PolicyVerdict check_inputs() const;
  [[nodiscard]] PolicyVerdict check_outputs(const robot::RobotModel& model) const;
  [[nodiscard]] PolicyVerdict check_layers(const robot::RobotModel& model, std::span<const std::byte> body);
  [[nodiscard]] std::size_t inputs_at() const { return kPolicyFixedSize + padded(input_count_); }
  [[nodiscard]] std::size_t outputs_at() const { return inputs_at() + input_count_ * kInputSize; }
  [[nodiscard]] std::size_t layers_at() const { return outputs_at() + output_count_ * kOutputSize; }

  const std::byte* body_ = nullptr;
  std::size_t size_ = 0;
  std::uint32_t work_ = 0;
  std::array<std::uint16_t, kMaxLayers> biases_at_{};  // in the body
  std::uint8_t input_count_ = 0;
  std::uint8_t output_count_ = 0;
  std::uint8_t layer_count_ = 0;
  std::uint8_t patience_ticks_ = 0;
};

}  // namespace koboshi::policy
