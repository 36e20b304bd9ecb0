#include <gtest/gtest.h>

#include "tests/support/controller_bench.h"
#include "tests/unit/firmware/motion/motion_builder.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;
using test::degrees;
using test::kKnee;
using DriveState = canopen::cia402::State;

constexpr std::size_t kElbow = 14;

// Moves a limp joint to this angle, as a person would by hand.
void turn(ControllerBench& bench, std::size_t joint, double angle_deg) {
  bench.drives[joint].position = robot::drive_position(bench.model().joints[joint].drive, degrees(angle_deg));
}

class ControllerEnabling : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(bench.run_until(State::kLimp));
    bench.run_ms(20);
  }
  // Runs until the changes reach the controller, sends the enable command and expects that it is refused.
  void expect_refusal(Reason reason) {
    bench.run_ms(20);
    bench.command(Command::kEnable);
    EXPECT_EQ(bench.now().refusal, reason);
    EXPECT_EQ(bench.now().state, State::kLimp);
    EXPECT_EQ(bench.now().reason, Reason::kProgress);  // a refusal is no transition, so the reason stays
    bench.run_ms(100);
    EXPECT_TRUE(bench.board.drive_enable.changes().empty());
    for (const auto& drive : bench.drives) EXPECT_EQ(drive.controlword, 0);
  }

  ControllerBench bench;
};

TEST_F(ControllerEnabling, HappensOnlyByCommand) {
  bench.run_ms(2'000);
  EXPECT_EQ(bench.now().state, State::kLimp);
  EXPECT_TRUE(bench.board.drive_enable.changes().empty());
  bench.command(Command::kEnable);
  EXPECT_EQ(bench.now().state, State::kEnabling);
  EXPECT_EQ(bench.now().reason, Reason::kCommand);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  EXPECT_TRUE(bench.board.drive_enable.enabled());
}

TEST_F(ControllerEnabling, AlsoWorksBySdo) {
  // Expedited download of one byte, 1, to 0x2000:1.
  bench.board.can.deliver({.identifier = 0x601, .size = 8, .data = {0x2F, 0x00, 0x20, 0x01, 1}});
  bench.run_ms(1);
  EXPECT_EQ(bench.now().state, State::kEnabling);
}

TEST_F(ControllerEnabling, IsRefusedWithAnEncoderBeyondItsLimits) {
  turn(bench, kKnee, -2.1);  // limits of 0 and 150 degrees, with a tolerance of two
  expect_refusal(Reason::kEncoderBeyondLimits);
}

TEST_F(ControllerEnabling, ToleratesAJointThatRestsOnItsStop) {
  turn(bench, kKnee, -1.9);
  bench.run_ms(20);
  bench.command(Command::kEnable);
  EXPECT_EQ(bench.now().state, State::kEnabling);
  EXPECT_EQ(bench.target(kKnee), degrees(0));  // no target ever exceeds the limits
}

TEST_F(ControllerEnabling, IsRefusedWhenTheImuMeasuresNoGravity) {
  bench.imu_sample.accelerometer_raw = {0, 0, 3'000};
  bench.run_ms(200);
  expect_refusal(Reason::kImuImplausible);
}

TEST_F(ControllerEnabling, IsRefusedWhenTheImuMeasuresTwoG) {
  bench.imu_sample.accelerometer_raw = {16'400, 0, 0};
  bench.run_ms(200);
  expect_refusal(Reason::kImuImplausible);
}

// From half to one and a half g, 4,098 and 12,296 counts.
TEST_F(ControllerEnabling, ToleratesAnInertialUnitInMotion) {
  for (const std::int16_t refused : {std::int16_t{4'000}, std::int16_t{12'400}}) {
    bench.imu_sample.accelerometer_raw = {0, 0, refused};
    bench.run_ms(300);
    expect_refusal(Reason::kImuImplausible);
  }
  for (const std::int16_t accepted : {std::int16_t{4'200}, std::int16_t{12'200}}) {
    bench.imu_sample.accelerometer_raw = {0, 0, accepted};
    bench.run_ms(300);
    bench.command(Command::kEnable);
    EXPECT_EQ(bench.now().state, State::kEnabling) << accepted;
    bench.command(Command::kLimp);
    bench.run_ms(300);
    EXPECT_EQ(bench.now().state, State::kLimp);
  }
}

TEST_F(ControllerEnabling, IsRefusedWhileADriveIsNotAtRest) {
  bench.drives[5].state = DriveState::kQuickStopActive;
  // The stub would finish its quick stop at the next SYNC; this one reports it in the millisecond of the
  // command.
  bench.board.can.deliver({.identifier = 0x180 + 16 + 5, .size = 8, .data = {0x07}});
  bench.command(Command::kEnable);
  EXPECT_EQ(bench.now().refusal, Reason::kDriveNotReady);
  EXPECT_EQ(bench.now().state, State::kLimp);
}

TEST_F(ControllerEnabling, IsRefusedWhileADriveIsInFault) {
  bench.drives[5].state = DriveState::kFault;
  bench.run_ms(20);
  EXPECT_EQ(bench.now().state, State::kFault);
  bench.command(Command::kEnable);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  EXPECT_EQ(bench.now().reason, Reason::kDriveFault);
  EXPECT_TRUE(bench.board.drive_enable.changes().empty());
}

TEST_F(ControllerEnabling, TakesTheDrivesThroughTheirStatesAndTheLastStepTogether) {
  bench.drives[9].enables = false;  // stays in ready to switch on
  bench.command(Command::kEnable);
  bench.run_ms(60);
  for (std::size_t i = 0; i < bench.drives.size(); ++i) {
    EXPECT_EQ(bench.drives[i].state, i == 9 ? DriveState::kReadyToSwitchOn : DriveState::kSwitchedOn) << i;
  }
  bench.drives[9].enables = true;
  bench.run_ms(20);
  for (const auto& drive : bench.drives) EXPECT_EQ(drive.state, DriveState::kOperationEnabled);
}

TEST_F(ControllerEnabling, FailsWhenADriveDoesNotFollow) {
  bench.drives[9].enables = false;
  bench.command(Command::kEnable);
  EXPECT_FALSE(bench.run_until(State::kFault, 490));
  ASSERT_TRUE(bench.run_until(State::kFault, 20));
  EXPECT_EQ(bench.now().drive_fault, drive::DriveFault::kNotEnabled);
  EXPECT_EQ(bench.now().faulty_joint, 9);
  bench.run_ms(10);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
}

TEST_F(ControllerEnabling, HoldsEveryJointWhereItIs) {
  turn(bench, kKnee, 77.0);
  turn(bench, kElbow, -50.0);
  bench.run_ms(20);
  bench.command(Command::kEnable);
  while (bench.now().state == State::kEnabling) {
    bench.run_ms(1);
    for (const std::size_t joint : {kKnee, kElbow}) {
      EXPECT_EQ(bench.values().drives.target_position[joint], bench.drives[joint].position);
    }
  }
  EXPECT_EQ(bench.now().state, State::kSoftStart);
}

TEST_F(ControllerEnabling, FollowsAJointThatIsMovedBeforeItsDriveIsEnabled) {
  bench.drives[9].enables = false;  // the others wait for it
  bench.command(Command::kEnable);
  bench.run_ms(50);
  turn(bench, kKnee, 33.0);
  bench.run_ms(30);
  ASSERT_EQ(bench.now().state, State::kEnabling);
  EXPECT_EQ(bench.values().drives.target_position[kKnee], bench.drives[kKnee].position);
}

// The pose of motion 0: all joints at zero, except the knee at 40 degrees.
TEST_F(ControllerEnabling, GoesToTheStandingPoseOnABoundedRamp) {
  turn(bench, kKnee, 100.0);
  turn(bench, kElbow, -90.0);
  bench.run_ms(20);
  bench.command(Command::kEnable);
  ASSERT_TRUE(bench.run_until(State::kSoftStart));

  const double unit_deg = 360.0 / (1 << 20);
  const double bound_deg = 683.0 / 4096 * 360 * 0.01 + unit_deg;  // the ramp rate parameter over one tick
  double fastest_deg = 0.0;
  double before_deg = -90.0;
  const std::uint64_t start_us = bench.now_us();
  while (bench.now().state == State::kSoftStart) {
    bench.run_ms(10);
    const double now_deg = fixed::to_double(bench.target(kElbow)) / test::kRadPerDegree;
    fastest_deg = std::max(fastest_deg, std::abs(now_deg - before_deg));
    before_deg = now_deg;
  }
  EXPECT_LE(fastest_deg, bound_deg);
  EXPECT_GE(fastest_deg, 0.59);
  EXPECT_EQ(bench.now_us() - start_us, 1'500'000u);  // the longest distance is 90 degrees, at 60.03 degrees/s
  EXPECT_EQ(bench.now().state, State::kStanding);
  EXPECT_EQ(bench.target(kElbow), degrees(0.0));
  EXPECT_NEAR(fixed::to_double(bench.target(kKnee) - test::stored(40.0)), 0.0,
              unit_deg * test::kRadPerDegree);
}

TEST_F(ControllerEnabling, TakesAtLeastHalfASecondAndFollowsTheRampParameter) {
  bench.command(Command::kEnable);
  ASSERT_TRUE(bench.run_until(State::kSoftStart));
  EXPECT_FALSE(bench.run_until(State::kStanding, 480));
  EXPECT_TRUE(bench.run_until(State::kStanding, 400));  // 40 degrees of the knee at 60 degrees/s
}

TEST(ControllerEnablingSupply, IsRefusedOutOfRangeAtAnyDrive) {
  for (const std::uint32_t supply_mV : {5'999u, 9'001u}) {
    ControllerBench bench;
    bench.drives[19].set_object(0x6079, 0, supply_mV);
    ASSERT_TRUE(bench.run_until(State::kLimp));
    bench.run_ms(20);
    bench.command(Command::kEnable);
    EXPECT_EQ(bench.now().refusal, Reason::kSupplyOutOfRange);
    EXPECT_EQ(bench.now().state, State::kLimp);
  }
}

TEST_F(ControllerEnabling, LimpAndEnableWithinOneMillisecondIsRefused) {
  bench.command(Command::kEnable);
  ASSERT_TRUE(bench.run_until(State::kStanding));
  bench.board.can.deliver({.identifier = 0x201, .size = 3, .data = {2}});  // limp
  bench.command(Command::kEnable);
  EXPECT_EQ(bench.now().state, State::kLimp);
  EXPECT_EQ(bench.now().refusal, Reason::kDriveNotReady);
  EXPECT_FALSE(bench.board.drive_enable.enabled());
  bench.run_ms(20);
  bench.command(Command::kEnable);
  EXPECT_TRUE(bench.run_until(State::kStanding));
}

}  // namespace
}  // namespace koboshi::app
