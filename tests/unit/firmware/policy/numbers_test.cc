// The numbers of docs/reference/policy.md, which images of other programs know, written out again.

#include <gtest/gtest.h>

#include <functional>

#include "firmware/policy/residual.h"
#include "tests/unit/firmware/policy/policy_builder.h"

namespace koboshi::policy {
namespace {

TEST(PolicyNumbers, AreThoseOfTheFormat) {
  EXPECT_EQ(kPolicyMagic, 0x4C4F'504Bu);  // "KPOL"
  EXPECT_EQ(kPolicyVersion, 1);
  EXPECT_EQ(kPolicyNameSize, 24u);
  EXPECT_EQ(kPolicyFixedSize, 32u);
  EXPECT_EQ(kInputSize, 16u);
  EXPECT_EQ(kOutputSize, 16u);
  EXPECT_EQ(kLayerSize, 8u);
  EXPECT_EQ(kMaxInputs, 128u);
  EXPECT_EQ(kMaxOutputs, 12u);
  EXPECT_EQ(kMaxLayers, 4u);
  EXPECT_EQ(kMaxWidth, 128u);
  EXPECT_EQ(kBlock, 8u);
  EXPECT_EQ(kRowsAtOnce, 4u);
  EXPECT_EQ(kMaxPatience_ticks, 100);
  EXPECT_EQ(kMaxOffset.raw(), 178'956'971);  // 15 degrees, 2^32 / 24
  EXPECT_EQ(kMaxScale, 32'768);
  EXPECT_EQ(kMaxBias, 1'073'741'824);
  EXPECT_EQ(kMaxSignal, 1'073'741'823);
  EXPECT_EQ(kMaxWork, 12'000u);
  EXPECT_EQ(kMinFractionBits, 8);
  EXPECT_EQ(kMaxFractionBits, 12);
  EXPECT_EQ(kTanhFractionBits, 15);
  // Tables of flash: 32 entries per unit over [-8, 8).
  EXPECT_EQ(kStepBits, 5);
  EXPECT_EQ(kTanhTable.size(), 512u);
  EXPECT_EQ(kSigmoidTable.size(), 512u);
  EXPECT_EQ(kExpTable.size(), 512u);
  for (int function = 0; function < 5; ++function) {
    constexpr Activation kFunctions[] = {Activation::kLinear, Activation::kRelu, Activation::kElu,
                                         Activation::kTanh, Activation::kSilu};
    EXPECT_EQ(static_cast<int>(kFunctions[function]), function);
  }
  EXPECT_EQ(kLastActivation, Activation::kSilu);
  EXPECT_EQ(padded(0), 0u);
  EXPECT_EQ(padded(1), 8u);
  EXPECT_EQ(padded(8), 8u);
  EXPECT_EQ(padded(9), 16u);
}

TEST(PolicyNumbers, OfResultsAndCausesAreThoseOfTelemetry) {
  using enum PolicyStatus;
  int number = 0;
  for (const PolicyStatus status :
       {kOk, kTruncated, kBadMagic, kBadVersion, kBadSize, kBadCrc, kOtherRobot, kBadCount, kBadName,
        kBadInput, kBadOutput, kBadLayer, kBadBias, kTooMuchWork, kMisaligned})
    EXPECT_EQ(static_cast<int>(status), number++);
  EXPECT_EQ(static_cast<int>(Cause::kNone), 0);
  EXPECT_EQ(static_cast<int>(Cause::kInputOutOfRange), 1);
  EXPECT_EQ(static_cast<int>(Cause::kOutputOutOfRange), 2);
}

TEST(PolicyNumbers, OfSignalsAreTheirPlaces) {
  using enum Signal;
  constexpr std::pair<Signal, int> kPlaces[] = {
      {kRoll, 0},        {kPitch, 1},         {kPlannedPitch, 2}, {kUpX, 3},
      {kRollRate, 6},    {kAccelerationX, 9}, {kVelocity, 12},    {kLoad, 15},
      {kZmp, 17},        {kPhaseSine, 21},    {kPhaseCosine, 22}, {kSwing, 23},
      {kJointAngle, 24}, {kJointRate, 55},    {kJointTarget, 86}, {kOutput, 117}};
  for (const auto& [signal, place] : kPlaces) EXPECT_EQ(static_cast<int>(signal), place);
  EXPECT_EQ(kSignals, 129u);
}

// The work of one layer of 8 rows and 8 columns, of one input and one output on 20 joints, by the comment of
// Work: measured numbers, of which the validator's verdict depends.
TEST(PolicyNumbers, OfWorkAreTheMeasuredOnes) {
  EXPECT_EQ(Work::kFixed, 460u);
  EXPECT_EQ(Work::kJoint, 17u);
  EXPECT_EQ(Work::kInput, 21u);
  EXPECT_EQ(Work::kOutput, 42u);
  EXPECT_EQ(Work::kLayer, 115u);
  EXPECT_EQ(Work::kRows, 24u);
  EXPECT_EQ(Work::kWiden, 5u);
  constexpr std::uint32_t kRows[] = {9, 10, 19, 15, 18};
  for (std::size_t i = 0; i < std::size(kRows); ++i) EXPECT_EQ(Work::kRow[i], kRows[i]) << i;
}

class PolicyRanges : public ::testing::Test {
 protected:
  // The verdict on a small policy with one change.
  PolicyStatus status(const std::function<void(test::PolicyBuilder&)>& change) {
    test::PolicyBuilder builder;
    builder.model_id = model_.id;
    builder.inputs = {{.signal = 0, .mean = 0, .multiplier = 1, .low = -1, .high = 1}};
    builder.outputs = {test::make_output(test::hips_and_ankles(model_)[0])};
    builder.layers = {{.rows = 8, .columns = 8, .multiplier = 1}};
    builder.layers[0].biases.resize(8);
    builder.layers[0].weights.resize(64);
    change(builder);
    const std::vector<std::byte> image = builder.image();
    const PolicyVerdict verdict = Policy::open(image, model_, policy_);
    return verdict.status;
  }

  robot::RobotModel model_ = test::make_test_robot();
  Policy policy_;
};

using enum PolicyStatus;

TEST_F(PolicyRanges, OfPatience) {
  for (const int ticks : {1, 100})
    EXPECT_EQ(status([=](auto& p) { p.patience_ticks = static_cast<std::uint8_t>(ticks); }), kOk) << ticks;
  for (const int ticks : {0, 101, 255})
    EXPECT_EQ(status([=](auto& p) { p.patience_ticks = static_cast<std::uint8_t>(ticks); }), kBadCount)
        << ticks;
}

TEST_F(PolicyRanges, OfInputs) {
  EXPECT_EQ(status([](auto& p) { p.inputs[0].signal = 128; }), kOk);
  EXPECT_EQ(status([](auto& p) { p.inputs[0].signal = 129; }), kBadInput);
  for (const std::int32_t sign : {-1, 1}) {
    EXPECT_EQ(status([=](auto& p) { p.inputs[0].mean = sign * kMaxSignal; }), kOk);
    EXPECT_EQ(status([=](auto& p) { p.inputs[0].mean = sign * (kMaxSignal + 1); }), kBadInput);
  }
  EXPECT_EQ(status([](auto& p) { p.inputs[0].low = -kMaxSignal; }), kOk);
  EXPECT_EQ(status([](auto& p) { p.inputs[0].low = -kMaxSignal - 1; }), kBadInput);
  EXPECT_EQ(status([](auto& p) { p.inputs[0].high = kMaxSignal; }), kOk);
  EXPECT_EQ(status([](auto& p) { p.inputs[0].high = kMaxSignal + 1; }), kBadInput);
  EXPECT_EQ(status([](auto& p) { p.inputs[0].low = 1; }), kOk) << "a range of one value";
  EXPECT_EQ(status([](auto& p) { p.inputs[0].low = 2; }), kBadInput);
}

TEST_F(PolicyRanges, OfOutputs) {
  for (const std::int32_t sign : {-1, 1}) {
    EXPECT_EQ(status([=](auto& p) { p.outputs[0].scale = sign * 32'768; }), kOk);
    EXPECT_EQ(status([=](auto& p) { p.outputs[0].scale = sign * 32'769; }), kBadOutput);
  }
  const auto with_bound = [&](std::int32_t raw) {
    return status([raw](auto& p) { p.outputs[0].bound = fixed::Angle::from_raw(raw); });
  };
  EXPECT_EQ(with_bound(0), kBadOutput);
  EXPECT_EQ(with_bound(1), kOk);
  EXPECT_EQ(with_bound(178'956'971), kOk);
  EXPECT_EQ(with_bound(178'956'972), kBadOutput);
  const auto with_rate = [&](std::int32_t raw) {
    return status([raw](auto& p) { p.outputs[0].rate = fixed::Angle::from_raw(raw); });
  };
  EXPECT_EQ(with_rate(0), kBadOutput);
  EXPECT_EQ(with_rate(1), kOk);
  // What the servo turns in 10 ms: 2^8 / 100 of its speed's raw value.
  const std::int32_t fastest = static_cast<std::int32_t>(
      std::int64_t{model_.joints[test::hips_and_ankles(model_)[0]].max_speed.raw()} * 256 / 100);
  EXPECT_EQ(with_rate(fastest - 1), kOk);
  EXPECT_EQ(with_rate(fastest + 2), kBadOutput);
}

TEST_F(PolicyRanges, OfJoints) {
  for (std::size_t joint = 0; joint < model_.joint_count; ++joint) {
    using enum robot::JointRole;
    const robot::JointRole role = model_.joints[joint].role;
    const bool in_leg = role >= kLeftHipYaw && role <= kRightAnkleRoll;
    const bool may_move = in_leg && role != kLeftKnee && role != kRightKnee;
    EXPECT_EQ(status([=](auto& p) { p.outputs[0] = test::make_output(static_cast<std::uint8_t>(joint)); }),
              may_move ? kOk : kBadOutput)
        << joint;
  }
  EXPECT_EQ(status([](auto& p) { p.outputs[0] = test::make_output(20); }), kBadOutput);
  EXPECT_EQ(status([](auto& p) { p.outputs.push_back(p.outputs[0]); }), kBadOutput) << "twice";
}

TEST_F(PolicyRanges, OfLayers) {
  const auto with = [&](int function, int bits) {
    return status([=](auto& p) {
      p.layers[0].activation = static_cast<Activation>(function);
      p.layers[0].fraction_bits = static_cast<std::uint8_t>(bits);
    });
  };
  for (const int function : {0, 1, 2, 3, 4}) EXPECT_EQ(with(function, 12), kOk) << function;
  for (const int function : {5, 255}) EXPECT_EQ(with(function, 12), kBadLayer) << function;
  for (const int bits : {8, 12}) EXPECT_EQ(with(2, bits), kOk) << bits;
  for (const int bits : {0, 7, 13, 255}) EXPECT_EQ(with(2, bits), kBadLayer) << bits;
  EXPECT_EQ(status([](auto& p) { p.layers[0].multiplier = 0; }), kOk);
  EXPECT_EQ(status([](auto& p) { p.layers[0].multiplier = -1; }), kBadLayer);
  for (const std::int32_t sign : {-1, 1}) {
    for (const std::size_t row : {0u, 7u}) {
      EXPECT_EQ(status([=](auto& p) { p.layers[0].biases[row] = sign * (kMaxBias - 1); }), kOk);
      EXPECT_EQ(status([=](auto& p) { p.layers[0].biases[row] = sign * kMaxBias; }), kBadBias);
    }
  }
}

// The sum of its parts, for each activation function, with and without fewer fraction bits.
TEST_F(PolicyRanges, OfWorkIsTheSumOfItsParts) {
  for (int function = 0; function < 5; ++function) {
    for (const int bits : {8, 12}) {
      ASSERT_EQ(status([=](auto& p) {
                  p.layers[0].activation = static_cast<Activation>(function);
                  p.layers[0].fraction_bits = static_cast<std::uint8_t>(bits);
                }),
                kOk);
      const std::uint32_t row = Work::kRow[function] + (bits == 8 ? Work::kWiden : 0);
      EXPECT_EQ(policy_.work(), Work::kFixed + 20 * Work::kJoint + Work::kInput + Work::kOutput +
                                    Work::kLayer + 2 * Work::kRows + 64 + 8 * row)
          << function << " " << bits;
    }
  }
}

TEST(PolicyDefaults, AreThoseOfAnEmptyPolicy) {
  const Policy policy;
  EXPECT_EQ(policy.image_size_bytes(), 0u);
  EXPECT_EQ(policy.input_count(), 0u);
  EXPECT_EQ(policy.output_count(), 0u);
  EXPECT_EQ(policy.layer_count(), 0u);
  EXPECT_EQ(policy.patience_ticks(), 0);
  EXPECT_EQ(policy.work(), 0u);
  EXPECT_EQ(policy.crc32(), 0u);
  EXPECT_TRUE(policy.name().empty());
  const Residual residual;
  EXPECT_FALSE(residual.active());
  EXPECT_EQ(residual.cause(), Cause::kNone);
  EXPECT_EQ(residual.cause_index(), 0);
  for (std::size_t i = 0; i < kMaxOutputs; ++i) EXPECT_EQ(residual.offset(i), fixed::Angle());
}

}  // namespace
}  // namespace koboshi::policy
