// Stiffness, torque off and gains of motions, on a fake board with stub drives.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/controller_bench.h"
#include "tests/support/factory_values.h"
#include "tests/support/robot_storage.h"

namespace koboshi::app {
namespace {

using enum motion::Opcode;
using motion::Stiffness;
using test::ControllerBench;
using test::kHeadTilt;
using test::kKnee;
using test::MotionBuilder;

constexpr std::int16_t kSoft = 1;   // softens all joints while it moves the knee, then ends
constexpr std::int16_t kFails = 2;  // the same, but fails
constexpr std::int16_t kFree = 3;   // releases the head, then tilts it to 20 degrees in a second
constexpr std::int16_t kLoop = 4;   // softens the knee until stopped
constexpr std::int16_t kGains = 5;  // gives the knee half its gain, and the head 150 percent
constexpr std::uint32_t kAllJoints = (1u << 20) - 1;
constexpr std::uint32_t kFull = 1'000;

class StiffnessTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::vector<std::byte> model_image = test::encode(test::make_test_robot());
    const robot::RobotModel& model = bench.model();
    const auto soft = [&](std::uint8_t percent, std::uint32_t joints) {
      return MotionBuilder(model)
          .pose(kKnee, 40)
          .step(Stiffness{.percent = percent, .joints = joints}.step())
          .step(kMove, 0, 300'000);
    };
    const std::vector<std::vector<std::byte>> motions{
        MotionBuilder(model).pose(kKnee, 40).step(kMove, 0, 500'000).step(kEnd).image(),
        soft(40, kAllJoints).step(kEnd).image(),
        soft(40, kAllJoints).step(kFail).step(kEnd).image(),
        MotionBuilder(model)
            .pose(kHeadTilt, 20)
            .step(Stiffness{.percent = 0, .joints = 1u << kHeadTilt}.step())
            .step(kWait, 0, 200'000)
            .step(Stiffness{.percent = 50, .joints = 1u << kHeadTilt}.step())
            .step(kMove, 0, 1'000'000)
            .step(kEnd)
            .image(),
        soft(25, 1u << kKnee)
            .step(kLoopBegin, 0)
            .step(kWait, 0, 100'000)
            .step(kLoopEnd, 2)
            .step(kEnd)
            .image(),
        MotionBuilder(model)
            .pose(kKnee, 40)
            .step(motion::Gain{.percent = 50, .joints = 1u << kKnee}.step())
            .step(motion::Gain{.percent = 150, .joints = 1u << kHeadTilt}.step())
            .step(kMove, 0, 300'000)
            .step(kEnd)
            .image(),
    };
    bench.restart(test::make_storage(model_image, motions, test::encode(test::factory_values(), model.id)));
    ASSERT_TRUE(bench.run_until_ready_to_walk());
  }
  std::uint32_t gain(std::size_t joint) const { return bench.drives[joint].object(0x60FB, 1); }
  // Emergencies with this code since the last call of `bench.sent.clear()`.
  int reports_of(std::uint16_t code) const {
    int reports = 0;
    for (const auto& sent : bench.sent) {
      const auto emergency = canopen::decode_emergency(sent.frame);
      reports += emergency && emergency->code == code ? 1 : 0;
    }
    return reports;
  }
  std::uint32_t limit(std::size_t joint) const { return bench.drives[joint].object(0x6072, 0); }
  // Returns the number of drives with this torque limit.
  int count(std::uint32_t permille) const {
    int found = 0;
    for (std::size_t i = 0; i < bench.drives.size(); ++i) found += limit(i) == permille ? 1 : 0;
    return found;
  }
  double target_deg(std::size_t joint) const {
    return fixed::to_double(bench.target(joint)) / test::kRadPerDegree;
  }

  ControllerBench bench;
};

TEST_F(StiffnessTest, ReachesAllDrivesWithin50ms) {
  EXPECT_EQ(count(kFull), 20);
  bench.command(Command::kPlay, kSoft);
  bench.run_ms(50);
  EXPECT_EQ(count(400), 20);
}

TEST_F(StiffnessTest, EndsWithTheMotion) {
  for (const std::int16_t motion : {kSoft, kFails}) {
    bench.command(Command::kPlay, motion);
    bench.run_ms(200);
    EXPECT_EQ(count(400), 20);
    ASSERT_TRUE(bench.run_until(State::kStanding, 500));
    bench.run_ms(50);
    EXPECT_EQ(count(kFull), 20) << motion;
  }
}

TEST_F(StiffnessTest, EndsWithAStop) {
  bench.command(Command::kPlay, kLoop);
  bench.run_ms(1'000);
  EXPECT_EQ(limit(kKnee), 250u);
  EXPECT_EQ(count(kFull), 19);
  bench.command(Command::kStop);
  bench.run_ms(150);
  EXPECT_EQ(bench.now().state, State::kStanding);
  EXPECT_EQ(count(kFull), 20);
}

TEST_F(StiffnessTest, EndsWhenTheRobotGoesLimp) {
  for (const Command command : {Command::kLimp, Command::kEmergencyStop}) {
    ASSERT_EQ(bench.now().state, State::kStanding);
    bench.command(Command::kPlay, kLoop);
    bench.run_ms(100);
    EXPECT_EQ(limit(kKnee), 250u);
    bench.command(command);
    bench.run_ms(50);
    EXPECT_EQ(count(kFull), 20);
    bench.command(Command::kEnable);
    bench.run_until(State::kStanding);
  }
}

TEST_F(StiffnessTest, EndsWithAFault) {
  bench.command(Command::kPlay, kLoop);
  bench.run_ms(100);
  bench.board.can.deliver(bench.drives[5].emergency(0x4310));
  bench.run_ms(60);
  EXPECT_EQ(bench.now().state, State::kFault);
  EXPECT_EQ(count(kFull), 20);
}

// The drives keep their limits while the controller starts again.
TEST_F(StiffnessTest, EndsWithAResetOfTheController) {
  bench.command(Command::kPlay, kSoft);
  bench.run_ms(100);
  ASSERT_EQ(count(400), 20);
  bench.restart();
  ASSERT_EQ(count(400), 20);
  ASSERT_TRUE(bench.run_until_ready_to_walk());
  EXPECT_EQ(count(kFull), 20);
}

// The sensed fall begins as in recovery_test.cc: the trunk turns by 60 degrees within 0.2 s.
TEST_F(StiffnessTest, EndsWithAFall) {
  bench.command(Command::kPlay, kLoop);
  bench.run_ms(100);
  EXPECT_EQ(limit(kKnee), 250u);
  bench.imu_sample.gyro_raw[1] =
      static_cast<std::int16_t>(60 * test::kRadPerDegree * 5 * test::kCountsPerRadPerS);
  ASSERT_TRUE(bench.run_until(State::kFalling, 200));
  bench.run_ms(50);
  EXPECT_EQ(count(kFull), 20);
}

TEST_F(StiffnessTest, OfADriveWithoutTorqueLimitIsReportedOnceAndTheMotionGoesOn) {
  bench.drives[7].refuses = canopen::ObjectAddress{0x6072, 0};
  bench.sent.clear();
  bench.command(Command::kPlay, kSoft);
  bench.run_ms(100);
  EXPECT_EQ(count(400), 19);
  EXPECT_EQ(bench.now().state, State::kMotion);
  ASSERT_TRUE(bench.run_until(State::kStanding, 500));
  bench.command(Command::kPlay, kSoft);
  bench.run_ms(500);
  EXPECT_EQ(bench.now().state, State::kStanding);
  EXPECT_EQ(bench.values().diagnosis.without_torque_limit, 1u << 7);
  EXPECT_EQ(reports_of(0xFF01), 1);
}

TEST_F(StiffnessTest, GainsReachTheDrivesAndEndWithTheMotion) {
  bench.command(Command::kPlay, kGains);
  bench.run_ms(50);
  EXPECT_EQ(gain(kKnee), 500u);
  EXPECT_EQ(gain(kHeadTilt), 1'500u);
  EXPECT_EQ(count(kFull), 20) << "all drives keep their torque";
  ASSERT_TRUE(bench.run_until(State::kStanding, 500));
  bench.run_ms(50);
  EXPECT_EQ(gain(kKnee), 1'000u);
  EXPECT_EQ(gain(kHeadTilt), 1'000u);
}

TEST_F(StiffnessTest, OfADriveWithoutAGainIsReportedOnceAndTheMotionGoesOn) {
  bench.drives[kKnee].refuses = canopen::ObjectAddress{0x60FB, 1};
  bench.sent.clear();
  for (int i = 0; i < 2; ++i) {
    bench.command(Command::kPlay, kGains);
    bench.run_ms(100);
    EXPECT_EQ(bench.now().state, State::kMotion);
    EXPECT_EQ(gain(kHeadTilt), 1'500u);
    ASSERT_TRUE(bench.run_until(State::kStanding, 500));
  }
  EXPECT_EQ(bench.values().diagnosis.without_position_gain, 1u << kKnee);
  EXPECT_EQ(bench.values().diagnosis.without_torque_limit, 0u);
  EXPECT_EQ(reports_of(0xFF03), 1);
  EXPECT_EQ(reports_of(0xFF01), 0);
}

TEST_F(StiffnessTest, AJointWithoutTorqueStartsItsNextMoveWhereItIs) {
  bench.command(Command::kPlay, kFree);
  bench.run_ms(100);
  EXPECT_EQ(limit(kHeadTilt), 0u);
  bench.drives[kHeadTilt].position =
      robot::drive_position(bench.model().joints[kHeadTilt].drive, test::degrees(-15));
  bench.run_ms(30);
  EXPECT_NEAR(target_deg(kHeadTilt), -15, 0.1) << "the target is where the joint was pushed";
  double before_deg = target_deg(kHeadTilt);
  double largest_deg = 0;
  for (int i = 0; i < 120; ++i) {
    bench.run_ms(10);
    largest_deg = std::max(largest_deg, std::abs(target_deg(kHeadTilt) - before_deg));
    before_deg = target_deg(kHeadTilt);
  }
  EXPECT_LE(largest_deg, 0.36) << "35 degrees in a second";
  EXPECT_NEAR(before_deg, 20, 0.01);
  EXPECT_EQ(limit(kHeadTilt), kFull);
}

}  // namespace
}  // namespace koboshi::app
