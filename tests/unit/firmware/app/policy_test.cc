// The policy in the controller: its storage, its offsets on the walk, and its watchdog.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "firmware/canopen/emergency.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/storage/image.h"
#include "tests/support/controller_bench.h"
#include "tests/support/sdo_pc.h"
#include "tests/unit/firmware/policy/policy_builder.h"

namespace koboshi::app {
namespace {

using canopen::AbortCode;
using test::ControllerBench;
using test::degrees;
using test::SdoPc;
using Image = std::vector<std::byte>;

constexpr canopen::ObjectAddress kImage{kPolicyObject, 0};
constexpr canopen::ObjectAddress kEnabled{kPolicyParameterObject, 1};
constexpr canopen::ObjectAddress kCheck{kPolicyParameterObject, 6};
constexpr double kOffset_deg = 3.0;
constexpr int kWalks_ms = 1'500;

class ControllerPolicy : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench.run_until_ready_to_walk()); }

  // A constant offset of both ankle pitches while the trunk's roll is within +-`range`.
  test::PolicyBuilder constant(double range_deg = 20.0, double offset_deg = kOffset_deg) const {
    test::PolicyBuilder policy;
    policy.name = "constant";
    policy.model_id = bench.model().id;
    policy.patience_ticks = 5;
    const auto range = static_cast<std::int32_t>(std::ldexp(range_deg / 360.0, 24));
    policy.inputs = {{.signal = 0, .mean = 0, .multiplier = 0, .low = -range, .high = range}};
    // Each activation is a quarter of the bias, 10,000.
    policy.layers = {{.rows = 8, .columns = 8, .multiplier = 1 << 30}};
    policy.layers[0].biases.assign(8, 40'000);
    policy.layers[0].weights.resize(64);
    for (const std::uint8_t joint : {left_ankle(), right_ankle()}) {
      policy.outputs.push_back(
          {.joint = joint,
           .scale = static_cast<std::int32_t>(std::lround(degrees(offset_deg).raw() / 10'000.0)),
           .bound = degrees(5.0),
           .rate = degrees(0.5)});
    }
    return policy;
  }
  std::uint8_t left_ankle() const {
    return static_cast<std::uint8_t>(*bench.model().find(robot::JointRole::kLeftAnklePitch));
  }
  std::uint8_t right_ankle() const {
    return static_cast<std::uint8_t>(*bench.model().find(robot::JointRole::kRightAnklePitch));
  }
  void upload(const test::PolicyBuilder& policy) {
    ASSERT_EQ(pc.download_blocks(kImage, policy.image()), AbortCode::kNone);
  }
  void enable() { ASSERT_EQ(pc.write(kEnabled, 1, 1), AbortCode::kNone); }
  const auto& shown() const { return bench.values().policy; }
  int emergencies(std::uint16_t code) const {
    int count = 0;
    for (const auto& sent : bench.sent) {
      const auto emergency = canopen::decode_emergency(sent.frame);
      count += emergency && emergency->code == code ? 1 : 0;
    }
    return count;
  }
  // The largest and the smallest difference of the targets from those of a robot without a policy, in its
  // walk: the benches run alike.
  static std::vector<double> differences_deg(const ControllerBench& a, const ControllerBench& b) {
    std::vector<double> differences;
    for (std::size_t joint = 0; joint < a.model().joint_count; ++joint)
      differences.push_back((fixed::to_double(a.target(joint)) - fixed::to_double(b.target(joint))) /
                            test::kRadPerDegree);
    return differences;
  }

  ControllerBench bench;
  SdoPc pc{bench};
};

TEST_F(ControllerPolicy, IsOffAndMissingAtFirst) {
  EXPECT_EQ(shown().state, PolicyState::kOff);
  EXPECT_EQ(pc.read(kCheck), static_cast<std::uint32_t>(policy::PolicyStatus::kTruncated));
  EXPECT_TRUE(pc.upload(kImage).empty());
  EXPECT_EQ(pc.refusal, AbortCode::kNoData);
  EXPECT_TRUE(pc.upload({kPolicyNameObject, 0}).empty());
  enable();
  bench.run_ms(20);
  EXPECT_EQ(shown().state, PolicyState::kMissing);
  EXPECT_EQ(pc.write(kEnabled, 2, 1), AbortCode::kValueTooHigh);
}

TEST_F(ControllerPolicy, IsStoredListedAndKept) {
  const Image image = constant().image();
  ASSERT_EQ(pc.download_blocks(kImage, image), AbortCode::kNone);
  EXPECT_EQ(pc.upload(kImage), image);
  const Image name = pc.upload({kPolicyNameObject, 0});
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(name.data()), name.size()), "constant");
  EXPECT_EQ(pc.read({kPolicyCrcObject, 0}), storage::image_crc32(image));
  EXPECT_EQ(pc.read(kCheck), 0u);
  EXPECT_EQ(shown().state, PolicyState::kOff) << "off by default";
  bench.restart();
  ASSERT_TRUE(bench.run_until(State::kLimp));
  EXPECT_EQ(pc.upload(kImage), image);
  ASSERT_EQ(pc.write({kPolicyCrcObject, 0}, 7, 4), AbortCode::kInvalidValue);
  ASSERT_EQ(pc.write({kPolicyCrcObject, 0}, 0, 4), AbortCode::kNone);
  EXPECT_TRUE(pc.upload(kImage).empty());
}

// The largest policy that a tick has room for is longer than any motion.
TEST_F(ControllerPolicy, MayBeAsLargeAsATickHasRoomFor) {
  std::mt19937 random(3);
  const auto policy = test::random_policy(random, bench.model(), 40, {88, 40}, 8, policy::Activation::kRelu);
  const Image image = policy.image();
  EXPECT_GT(image.size(), 8u * 1024);
  ASSERT_EQ(pc.download_blocks(kImage, image), AbortCode::kNone);
  EXPECT_EQ(pc.upload(kImage), image);
}

TEST_F(ControllerPolicy, OfAnotherRobotIsRefused) {
  test::PolicyBuilder policy = constant();
  upload(policy);
  const Image kept = policy.image();
  ++policy.model_id;
  EXPECT_EQ(pc.download_blocks(kImage, policy.image()), AbortCode::kInvalidValue);
  EXPECT_EQ(pc.upload(kImage), kept);
  Image longer = kept;
  longer.resize(longer.size() + 8);
  EXPECT_EQ(pc.download_blocks(kImage, longer), AbortCode::kInvalidValue);
}

TEST_F(ControllerPolicy, IsNotStoredWhileTheRobotWalks) {
  upload(constant());
  bench.command(Command::kWalk);
  bench.run_ms(kWalks_ms);
  ASSERT_EQ(bench.now().state, State::kWalking);
  EXPECT_EQ(pc.download_blocks(kImage, constant().image()), AbortCode::kDeviceState);
  EXPECT_EQ(pc.write({kPolicyCrcObject, 0}, 0, 4), AbortCode::kDeviceState);
}

TEST_F(ControllerPolicy, AddsItsOffsetsToTheWalkAlone) {
  ControllerBench without;
  ASSERT_TRUE(without.run_until_ready_to_walk());
  SdoPc other(without);
  // The same time passes on both benches.
  upload(constant());
  enable();
  ASSERT_EQ(other.download_blocks(kImage, constant().image()), AbortCode::kNone);
  ASSERT_EQ(other.write(kEnabled, 0, 1), AbortCode::kNone);
  bench.run_ms(50);
  without.run_ms(50);
  EXPECT_EQ(shown().state, PolicyState::kReady);
  EXPECT_EQ(differences_deg(bench, without), std::vector<double>(bench.model().joint_count));
  // The walk must not answer the offsets, which it measures.
  ASSERT_EQ(pc.write({0x2132, 7}, 0, 2), AbortCode::kNone);
  ASSERT_EQ(other.write({0x2132, 7}, 0, 2), AbortCode::kNone);
  for (ControllerBench* const each : {&bench, &without}) each->command(Command::kWalk);
  double last_deg = 0.0;
  for (int tick = 0; tick < 300; ++tick) {
    bench.run_ms(10);
    without.run_ms(10);
    const std::vector<double> differences = differences_deg(bench, without);
    for (std::size_t joint = 0; joint < differences.size(); ++joint) {
      if (joint == left_ankle() || joint == right_ankle()) continue;
      ASSERT_EQ(differences[joint], 0.0) << joint;
    }
    ASSERT_LE(std::abs(differences[left_ankle()] - last_deg), 0.501) << "the rate of an output";
    last_deg = differences[left_ankle()];
  }
  EXPECT_EQ(shown().state, PolicyState::kActive);
  EXPECT_NEAR(last_deg, kOffset_deg, 0.01);
  for (ControllerBench* const each : {&bench, &without}) {
    each->command(Command::kStop);
    ASSERT_TRUE(each->run_until(State::kStanding, 5'000));
  }
  bench.run_ms(200);
  without.run_ms(200);
  EXPECT_EQ(shown().state, PolicyState::kReady);
  EXPECT_EQ(differences_deg(bench, without), std::vector<double>(bench.model().joint_count));
  EXPECT_EQ(shown().stops, 0);
}

TEST_F(ControllerPolicy, StaysWithinTheLimitsOfTheJoints) {
  test::PolicyBuilder policy = constant();
  upload(policy);
  enable();
  bench.command(Command::kWalk);
  for (int tick = 0; tick < 200; ++tick) {
    bench.run_ms(10);
    for (std::size_t joint = 0; joint < bench.model().joint_count; ++joint) {
      // Targets are sent in the drive's units, which are coarser than those of an angle.
      const robot::Joint& limits = bench.model().joints[joint];
      const double target_rad = fixed::to_double(bench.target(joint));
      ASSERT_GE(target_rad, fixed::to_double(limits.lower) - 1e-5);
      ASSERT_LE(target_rad, fixed::to_double(limits.upper) + 1e-5);
    }
  }
}

TEST_F(ControllerPolicy, IsStoppedByItsWatchdogAndReported) {
  upload(constant(1.0));
  enable();
  bench.command(Command::kWalk);
  bench.run_ms(kWalks_ms);
  EXPECT_EQ(shown().state, PolicyState::kActive);
  EXPECT_EQ(emergencies(0xFF02), 0);
  // The trunk rolls by 3 degrees, seen by the accelerometer at first.
  const double sine = std::sin(3.0 * test::kRadPerDegree);
  bench.imu_sample.accelerometer_raw[1] = static_cast<std::int16_t>(test::kCountsPerG * sine);
  bench.run_ms(4'000);
  EXPECT_EQ(bench.now().state, State::kWalking) << "the engine walks on";
  EXPECT_EQ(shown().state, PolicyState::kStopped);
  EXPECT_EQ(shown().cause, policy::Cause::kInputOutOfRange);
  EXPECT_EQ(shown().cause_number, 0);
  EXPECT_EQ(shown().stops, 1);
  EXPECT_EQ(emergencies(0xFF02), 1);
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding, 5'000));
  bench.run_ms(20);
  EXPECT_EQ(shown().state, PolicyState::kReady);
  EXPECT_EQ(shown().cause, policy::Cause::kInputOutOfRange) << "of the last walk";
  EXPECT_EQ(emergencies(0), 1) << "no error any more";
  bench.command(Command::kWalk);
  bench.run_ms(30);
  EXPECT_EQ(shown().stops, 1);
  EXPECT_EQ(shown().cause, policy::Cause::kNone);
  bench.run_ms(100);
  EXPECT_EQ(shown().stops, 2);
}

TEST_F(ControllerPolicy, IsStoppedWhenAnOutputExceedsItsBound) {
  upload(constant(20.0, 6.0));  // the bound is 5 degrees
  enable();
  bench.command(Command::kWalk);
  bench.run_ms(kWalks_ms);
  EXPECT_EQ(shown().state, PolicyState::kStopped);
  EXPECT_EQ(shown().cause, policy::Cause::kOutputOutOfRange);
  EXPECT_EQ(bench.now().state, State::kWalking);
}

TEST_F(ControllerPolicy, IsTurnedOffWhileTheRobotWalks) {
  upload(constant());
  enable();
  bench.command(Command::kWalk);
  bench.run_ms(kWalks_ms);
  ASSERT_EQ(shown().state, PolicyState::kActive);
  ASSERT_EQ(pc.write(kEnabled, 0, 1), AbortCode::kNone);
  bench.run_ms(20);
  EXPECT_EQ(shown().state, PolicyState::kOff);
  EXPECT_EQ(bench.now().state, State::kWalking);
}

}  // namespace
}  // namespace koboshi::app
