#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "firmware/policy/residual.h"
#include "firmware/storage/image.h"
#include "tests/unit/firmware/fixed/digest.h"

// Policies for tests on the host and on the Cortex-M4, without heap.
namespace koboshi::test {

// Of all outputs of the sample policies, over kSampleCycles cycles.
inline constexpr std::uint64_t kSampleDigest = 0x055C'0618'6FF3'C8AEu;
inline constexpr int kSampleCycles = 20;

struct SampleShape {
  std::uint8_t inputs;
  std::array<std::uint8_t, 3> hidden;  // 0: no such layer
  std::uint8_t outputs;
  policy::Activation activation;
};

// From the smallest to the largest that a tick has room for.
inline constexpr std::array<SampleShape, 8> kSampleShapes = {{
    {1, {0, 0, 0}, 1, policy::Activation::kLinear},
    {11, {32, 32, 0}, 4, policy::Activation::kRelu},
    {11, {32, 32, 0}, 4, policy::Activation::kElu},
    {11, {32, 32, 0}, 4, policy::Activation::kTanh},
    {11, {32, 32, 0}, 4, policy::Activation::kSilu},
    {40, {72, 40, 0}, 8, policy::Activation::kElu},
    {40, {80, 40, 0}, 8, policy::Activation::kTanh},
    {32, {80, 48, 0}, 8, policy::Activation::kRelu},
}};

// Makes the policies one after the other.
class SamplePolicies {
 public:
  SamplePolicies() {
    model_.id = 77;
    model_.joint_count = robot::kMaxJoints;
    for (std::size_t joint = 0; joint < 2 * robot::kLegJoints; ++joint) {
      model_.joints[joint].role =
          robot::leg_role(joint < 6 ? hal::Side::kLeft : hal::Side::kRight, joint % 6);
      model_.joints[joint].max_speed = fixed::AngularRate::from_raw(1 << 24);
    }
  }

  // Makes the policy of a shape. Returns whether it is valid.
  [[nodiscard]] bool open(std::size_t shape) {
    state_ = static_cast<std::uint32_t>(20261127 + shape);
    const auto image = write(kSampleShapes[shape]);
    return policy::Policy::open(image, model_, policy_).ok();
  }
  [[nodiscard]] const policy::Policy& policy() const { return policy_; }

  // The next state of a robot that swings about at random.
  void draw_robot() {
    const auto angle = [&] { return fixed::Angle::from_raw(draw() >> 5); };
    robot_.roll = angle();
    robot_.pitch = angle();
    robot_.rates_B = {fixed::AngularRate::from_raw(draw() >> 7), fixed::AngularRate::from_raw(draw() >> 7),
                      fixed::AngularRate::from_raw(draw() >> 7)};
    robot_.feet[0].load = fixed::Force::from_raw(draw() >> 12);
    for (fixed::Angle& target : targets_) target = angle();
    for (std::size_t i = 0; i < angles_.size(); ++i)
      angles_[i] = targets_[i] + fixed::Angle::from_raw(draw() >> 10);
  }
  [[nodiscard]] policy::Observation observation() const {
    return {.robot = robot_,
            .angles = angles_,
            .targets = targets_,
            .velocity = {.forward_mm_per_s = 30, .left_mm_per_s = -5, .turn_mrad_per_s = 100},
            .phase = targets_[0],
            .swing = hal::Side::kLeft};
  }

 private:
  // The upper bits of a linear congruential generator (Numerical Recipes, 7.1).
  std::int32_t draw() {
    state_ = state_ * 1'664'525 + 1'013'904'223;
    return static_cast<std::int32_t>(state_);
  }
  // Within +-127 of a byte.
  std::int32_t draw_weight() { return std::max<std::int32_t>(draw() >> 24, -127); }

  std::span<const std::byte> write(const SampleShape& shape) {
    std::array<std::uint8_t, 4> rows{};
    std::size_t layers = 0;
    for (const std::uint8_t hidden : shape.hidden) {
      if (hidden != 0) rows[layers++] = hidden;
    }
    rows[layers++] = static_cast<std::uint8_t>(policy::padded(shape.outputs));
    bytes_ = {};
    storage::FieldWriter out(bytes_);
    std::size_t size = 0;
    const auto put = [&](std::int32_t value, std::size_t bytes) {
      size += bytes;
      if (bytes == 1) return out.u8(static_cast<std::uint8_t>(value));
      if (bytes == 2) return out.u16(static_cast<std::uint16_t>(value));
      out.u32(static_cast<std::uint32_t>(value));
    };
    put(static_cast<std::int32_t>(policy::kPolicyMagic), 4);
    put(policy::kPolicyVersion, 4);
    put(0, 4);
    put(0, 4);
    put(static_cast<std::int32_t>(model_.id), 4);
    for (std::size_t i = 0; i < policy::kPolicyNameSize; ++i) put(i == 0 ? 's' : 0, 1);
    put(shape.inputs, 1);
    put(shape.outputs, 1);
    put(static_cast<std::int32_t>(layers), 1);
    put(policy::kMaxPatience_ticks, 1);
    for (std::size_t i = 0; i < policy::padded(shape.inputs); ++i)
      put(i < shape.inputs ? static_cast<std::int32_t>((i * 3) % 36) : 0, 1);
    for (std::size_t i = 0; i < shape.inputs; ++i) {
      put(draw() >> 18, 4);
      put(1 << 27, 4);
      put(-(1 << 19), 4);
      put(1 << 19, 4);
    }
    constexpr std::array<std::uint8_t, 8> kJoints = {1, 2, 4, 5, 7, 8, 10, 11};
    for (std::size_t i = 0; i < shape.outputs; ++i) {
      put(kJoints[i], 4);
      put(3'000, 4);
      put(90'000'000, 4);
      put(9'000'000, 4);
    }
    for (std::size_t i = 0; i < layers; ++i) {
      put(rows[i], 1);
      put(static_cast<std::int32_t>(i + 1 == layers ? policy::Activation::kLinear : shape.activation), 1);
      put(policy::kMaxFractionBits, 1);
      put(0, 1);
      put(i > 0 && shape.activation == policy::Activation::kTanh ? 460'000 : 3'700'000, 4);
    }
    std::size_t columns = policy::padded(shape.inputs);
    for (std::size_t i = 0; i < layers; ++i) {
      for (std::size_t row = 0; row < rows[i]; ++row) put(draw() >> 12, 4);
      for (std::size_t w = 0; w < rows[i] * columns / 2; ++w) put(256 * draw_weight() + draw_weight(), 2);
      columns = rows[i];
    }
    storage::FieldWriter(std::span(bytes_).subspan(storage::kImageSizeOffset))
        .u32(static_cast<std::uint32_t>(size));
    storage::FieldWriter(std::span(bytes_).subspan(storage::kImageCrcOffset))
        .u32(storage::image_crc32(std::span(bytes_).first(size)));
    return std::span(bytes_).first(size);
  }

  robot::RobotModel model_;
  alignas(8) std::array<std::byte, 12 * 1024> bytes_{};
  policy::Policy policy_;
  std::uint32_t state_ = 0;
  estimation::RobotState robot_;
  std::array<fixed::Angle, robot::kMaxJoints> angles_{};
  std::array<fixed::Angle, robot::kMaxJoints> targets_{};
};

// Runs all samples, and returns the digest of their offsets and their last activations.
inline std::uint64_t digest_of(SamplePolicies& samples) {
  Digest digest;
  for (std::size_t shape = 0; shape < kSampleShapes.size(); ++shape) {
    if (!samples.open(shape)) return 0;
    policy::Residual residual;
    policy::Signals signals;
    for (int cycle = 0; cycle < kSampleCycles; ++cycle) {
      samples.draw_robot();
      residual.advance(samples.policy(), samples.observation());
      for (std::size_t i = 0; i < samples.policy().output_count(); ++i) digest.add(residual.offset(i).raw());
      signals.update(samples.observation());
      policy::Activations a;
      policy::Activations b;
      digest.add(samples.policy().normalise(signals.values(), a));
      const policy::Activations& out = samples.policy().run(a, b);
      for (std::size_t i = 0; i < samples.policy().output_count(); ++i) digest.add(out.values[i]);
    }
  }
  return digest.value();
}

}  // namespace koboshi::test
