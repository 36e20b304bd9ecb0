// The controller with different parameters in its storage, and without any.

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/controller_bench.h"
#include "tests/support/factory_values.h"
#include "tests/support/robot_storage.h"
#include "tests/support/sdo_pc.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;

constexpr std::uint16_t kEmergencyIdentifier = 0x081;

class ControllerFactoryParameters : public testing::Test {
 protected:
  // Starts with this parameter item, or without any, instead of the test robot's.
  void start_with(const std::vector<std::byte>& item) {
    bench.restart(test::factory_storage(item));
    bench.sent.clear();
  }
  FactoryStatus status() const { return bench.values().diagnosis.factory_parameters; }
  std::vector<std::byte> item(const ControllerValues& values) const {
    return test::encode(values, bench.model().id);
  }
  void expect_neutral() const {
    const ControllerValues neutral;
    EXPECT_EQ(bench.values().walk, neutral.walk);
    EXPECT_EQ(bench.values().feedback.walking, balance::FeedbackGains{});
    EXPECT_EQ(bench.values().velocity_limits.highest(), walk::Velocity{});
    EXPECT_FALSE(bench.values().recovery.fall.are_set());
  }

  ControllerBench bench;
};

TEST_F(ControllerFactoryParameters, AreLoadedAtPowerOn) {
  bench.run_ms(1);
  EXPECT_EQ(status(), FactoryStatus::kLoaded);
  EXPECT_EQ(bench.values().walk, test::tuned_gait());
  EXPECT_EQ(bench.values().feedback.walking, test::factory_values().feedback.walking);
  EXPECT_FALSE(bench.last_sent(kEmergencyIdentifier));
}

TEST_F(ControllerFactoryParameters, WithoutThemTheRobotStandsAndPlaysButDoesNotWalk) {
  start_with({});
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_EQ(status(), FactoryStatus::kNone);
  expect_neutral();
  EXPECT_FALSE(bench.last_sent(kEmergencyIdentifier));
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().refusal, Reason::kNoGait);
  EXPECT_EQ(bench.now().state, State::kStanding);
  bench.command(Command::kPlay, 1);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  EXPECT_EQ(bench.now().state, State::kMotion);
}

TEST_F(ControllerFactoryParameters, WithoutThemTheGyroMovesNoJoint) {
  start_with({});
  ASSERT_TRUE(bench.run_until_standing());
  std::vector<fixed::Angle> before;
  for (std::size_t joint = 0; joint < bench.model().joint_count; ++joint)
    before.push_back(bench.target(joint));
  bench.imu_sample.gyro_raw[1] = 3'000;
  bench.run_ms(200);
  EXPECT_EQ(bench.now().state, State::kStanding);  // a lean does not count as a fall either
  for (std::size_t joint = 0; joint < bench.model().joint_count; ++joint)
    EXPECT_EQ(bench.target(joint), before[joint]) << joint;
}

// A client can write the gait parameters, for example to tune them.
TEST_F(ControllerFactoryParameters, AreNotRequiredOnceAClientHasSetTheGait) {
  start_with({});
  ASSERT_TRUE(bench.run_until_ready_to_walk());
  test::SdoPc pc{bench};
  const auto& gait = test::tuned_gait().step;
  const std::int16_t steps[] = {gait.time_ms,         gait.double_support,  gait.width,
                                gait.height,          gait.swing_profile,   gait.acceleration[0],
                                gait.acceleration[1], gait.acceleration[2], gait.max_forward,
                                gait.max_lateral,     gait.min_lateral};
  for (std::uint8_t i = 0; i < std::size(steps); ++i)
    ASSERT_EQ(pc.write({0x2130, static_cast<std::uint8_t>(i + 1)}, steps[i], 2), canopen::AbortCode::kNone);
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().refusal, Reason::kNoGait);
  ASSERT_EQ(pc.write({0x2131, 1}, 1675, 2), canopen::AbortCode::kNone);
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  EXPECT_EQ(bench.now().state, State::kWalking);
}

TEST_F(ControllerFactoryParameters, AreReportedWhenDamagedAndTheRobotStandsWithoutThem) {
  auto damaged = item(test::factory_values());
  damaged.back() ^= std::byte{1};
  start_with(damaged);
  ASSERT_TRUE(bench.run_until_standing());
  EXPECT_EQ(status(), FactoryStatus::kDamaged);
  expect_neutral();
  const auto emergency = bench.last_sent(kEmergencyIdentifier);
  ASSERT_TRUE(emergency);
  EXPECT_EQ(emergency->data[0] | emergency->data[1] << 8, 0x6300);
  EXPECT_EQ(emergency->data[3], static_cast<std::uint8_t>(FactoryStatus::kDamaged));
}

TEST_F(ControllerFactoryParameters, AreReportedWhenTheyBelongToAnotherModel) {
  start_with(test::encode(test::factory_values(), bench.model().id + 1));
  bench.run_ms(5);
  EXPECT_EQ(status(), FactoryStatus::kOtherModel);
  expect_neutral();
  EXPECT_TRUE(bench.last_sent(kEmergencyIdentifier));
}

TEST_F(ControllerFactoryParameters, AreRefusedAsAWholeWhenOneIsOutOfRange) {
  ControllerValues values = test::factory_values();
  values.parameters.ramp_rate = 4'097;
  start_with(item(values));
  bench.run_ms(5);
  EXPECT_EQ(status(), FactoryStatus::kRefused);
  expect_neutral();
  EXPECT_EQ(bench.values().parameters.supply_min_mV, 0);
}

TEST_F(ControllerFactoryParameters, AreRestoredByRestoreDefaultParameters) {
  test::SdoPc pc{bench};
  ASSERT_TRUE(bench.run_until(State::kLimp));
  ASSERT_EQ(pc.write({0x2130, 1}, 300, 2), canopen::AbortCode::kNone);
  ASSERT_EQ(pc.save(), canopen::AbortCode::kNone);
  const auto reset = [&] {
    bench.board.can.deliver({.identifier = 0x000, .size = 2, .data = {129, 1}});
    bench.run_ms(1);
  };
  reset();
  EXPECT_EQ(bench.values().walk.step.time_ms, 300);
  EXPECT_EQ(bench.values().walk.step.width, test::tuned_gait().step.width);
  ASSERT_TRUE(bench.run_until(State::kLimp));
  ASSERT_EQ(pc.restore(), canopen::AbortCode::kNone);
  reset();
  EXPECT_EQ(bench.values().walk, test::tuned_gait());
  EXPECT_EQ(status(), FactoryStatus::kLoaded);
}

// Object 0x2200:0C, read by a client.
TEST_F(ControllerFactoryParameters, ReportTheirStatusToAClient) {
  test::SdoPc pc{bench};
  ASSERT_TRUE(bench.run_until(State::kLimp));
  EXPECT_EQ(pc.read({0x2200, 12}), static_cast<std::uint32_t>(FactoryStatus::kLoaded));
  start_with({});
  ASSERT_TRUE(bench.run_until(State::kLimp));
  EXPECT_EQ(pc.read({0x2200, 12}), static_cast<std::uint32_t>(FactoryStatus::kNone));
}

}  // namespace
}  // namespace koboshi::app
