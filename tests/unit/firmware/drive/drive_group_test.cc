#include "firmware/drive/drive_group.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/firmware/drive/drive_group_fixture.h"

namespace koboshi::drive {
namespace {

TEST_F(DriveGroupTest, IsBootedOnceEveryDriveHasAnswered) {
  group.boot();
  run_ms(700);
  EXPECT_TRUE(group.configured());
  EXPECT_FALSE(group.booted());
  cycle();
  EXPECT_TRUE(group.booted());
  EXPECT_TRUE(group.all_limp());
}

TEST_F(DriveGroupTest, PollsTheSupplyOfOneDriveAfterTheOther) {
  boot();
  for (std::size_t i = 0; i < drives.size(); ++i) {
    drives[i].set_object(0x6079, 0, 7'000 + static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> told;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    run_ms(250);
    group.observe(now_us);
    if (const auto supply_mV = group.status().new_supply_mV) told.push_back(*supply_mV);
    group.observe(now_us);
    EXPECT_EQ(group.status().new_supply_mV, std::nullopt) << "told once";
  }
  std::ranges::sort(told);
  ASSERT_EQ(told.size(), drives.size());
  for (std::size_t i = 0; i < drives.size(); ++i) {
    EXPECT_EQ(told[i], 7'000 + i);
    EXPECT_EQ(group.enable_conditions().supply_mV[i], 7'000 + i);
  }
}

TEST_F(DriveGroupTest, WaitsASecondForBootUpMessages) {
  drives[13].hangs = true;
  group.boot();
  run_ms(1'000);
  EXPECT_FALSE(group.fault());
  run_ms(1);
  EXPECT_EQ(group.fault().kind, DriveFault::kSilent);
  EXPECT_EQ(group.fault().joint, 13);
}

// A boot-up message from before the reset command, for which this drive has yet to be addressed, is none of
// its answers.
TEST_F(DriveGroupTest, DoesNotTakeAnEarlierBootUpForThatOfItsReset) {
  drives.back().hangs = true;
  group.boot();
  tell(35, HeartbeatEventKind::kBootedUp);
  run_ms(1'002);
  EXPECT_EQ(group.fault().kind, DriveFault::kSilent);
  EXPECT_EQ(group.fault().joint, 19);
}

TEST_F(DriveGroupTest, BringsDrivesToOperationEnabledOneTransitionPerCycle) {
  boot();
  group.set_goal(Goal::kEnabled, now_us);
  group.command();
  for (const std::uint16_t expected :
       {cia402::kControlShutdown, cia402::kControlSwitchOn, cia402::kControlEnableOperation}) {
    for (std::size_t i = 0; i < drives.size(); ++i) EXPECT_EQ(signals.controlword[i], expected) << i;
    cycle();
  }
  EXPECT_TRUE(group.all_in(cia402::State::kOperationEnabled));
  EXPECT_FALSE(group.all_limp());
}

TEST_F(DriveGroupTest, HoldsAllDrivesBeforeTheLastTransitionUntilTheSlowestIsReady) {
  boot();
  drives[2].enables = false;
  group.set_goal(Goal::kEnabled, now_us);
  cycles(20);
  EXPECT_TRUE(group.all_limp());
  EXPECT_EQ(drives[0].state, cia402::State::kSwitchedOn);
  drives[2].enables = true;
  cycles(3);
  EXPECT_TRUE(group.all_in(cia402::State::kOperationEnabled));
}

TEST_F(DriveGroupTest, ReportsTheDriveThatTheOthersWaitFor) {
  boot();
  drives[2].enables = false;
  group.set_goal(Goal::kEnabled, now_us);
  cycles(50);
  EXPECT_FALSE(group.fault());
  cycles(2);
  EXPECT_EQ(group.fault().kind, DriveFault::kNotEnabled);
  EXPECT_EQ(group.fault().joint, 2);
}

TEST_F(DriveGroupTest, ReportsADriveThatLeavesOperationAtOnceAndDoesNotReEnableIt) {
  enable();
  drives[2].state = cia402::State::kSwitchOnDisabled;
  cycle();
  EXPECT_EQ(group.fault().kind, DriveFault::kNotEnabled);
  EXPECT_EQ(group.fault().joint, 2);
}

TEST_F(DriveGroupTest, ReportsADriveThatNoLongerFollowsItsTargets) {
  enable();
  drives[2].follows = false;
  cycle();
  EXPECT_EQ(group.fault().kind, DriveFault::kNotFollowing);
  EXPECT_EQ(group.fault().joint, 2);
}

TEST_F(DriveGroupTest, IsEnabledOnlyOnceEveryDriveFollows) {
  boot();
  drives[2].follows = false;  // another master has set another mode since the boot
  group.set_goal(Goal::kEnabled, now_us);
  cycles(50);
  EXPECT_TRUE(group.all_in(cia402::State::kOperationEnabled));
  EXPECT_FALSE(group.enabled());
  EXPECT_FALSE(group.fault());
  cycles(2);
  EXPECT_EQ(group.fault().kind, DriveFault::kNotFollowing);
  EXPECT_EQ(group.fault().joint, 2);
}

// Bit 12 of the statusword is clear in all states except operation enabled.
TEST_F(DriveGroupTest, ExpectsADriveToFollowOnlyInOperation) {
  enable();
  EXPECT_TRUE(group.enabled());
  for (const Goal goal : {Goal::kQuickStop, Goal::kTorqueOff, Goal::kEnabled}) {
    group.set_goal(goal, now_us);
    cycles(10);
    EXPECT_FALSE(group.fault());
  }
  EXPECT_TRUE(group.enabled());
}

TEST_F(DriveGroupTest, CommandsAQuickStopOrTorqueOff) {
  enable();
  group.set_goal(Goal::kQuickStop, now_us);
  group.command();
  for (std::size_t i = 0; i < drives.size(); ++i)
    EXPECT_EQ(signals.controlword[i], cia402::kControlQuickStop);
  group.set_goal(Goal::kTorqueOff, now_us);
  group.command();
  for (std::size_t i = 0; i < drives.size(); ++i)
    EXPECT_EQ(signals.controlword[i], cia402::kControlDisableVoltage);
}

// Occurs when the reset has to wait for the bus.
TEST_F(DriveGroupTest, DiscardsAnswersFromBeforeTheReset) {
  group.boot();
  for (std::size_t i = 0; i < drives.size(); ++i) {
    signals.statusword[i] = cia402::statusword_of(cia402::State::kFault);
    group.on_answer(i);
  }
  for (int i = 0; i < 1'000 && !group.configured(); ++i) run_ms(1);
  ASSERT_TRUE(group.configured());
  group.observe(now_us);
  EXPECT_FALSE(group.booted());
  EXPECT_FALSE(group.fault());
}

TEST_F(DriveGroupTest, LosesADriveAfterFiveCyclesWithoutAnswer) {
  enable();
  drives[4].hangs = true;
  cycles(4);
  EXPECT_FALSE(group.fault());
  cycle();
  EXPECT_EQ(group.fault().kind, DriveFault::kLost);
  EXPECT_EQ(group.fault().joint, 4);
}

TEST_F(DriveGroupTest, ToleratesFourConsecutiveMissedAnswers) {
  enable();
  for (int i = 0; i < 5; ++i) {
    drives[4].hangs = true;
    cycles(4);
    drives[4].hangs = false;
    cycle();
  }
  EXPECT_FALSE(group.fault());
}

TEST_F(DriveGroupTest, LosesADriveWhoseHeartbeatIsLost) {
  boot();
  tell(16 + 7, HeartbeatEventKind::kLost);
  EXPECT_EQ(group.fault().kind, DriveFault::kLost);
  EXPECT_EQ(group.fault().joint, 7);
}

TEST_F(DriveGroupTest, ReportsADriveThatBootsUpOnItsOwn) {
  boot();
  tell(16 + 7, HeartbeatEventKind::kBootedUp);
  EXPECT_EQ(group.fault().kind, DriveFault::kRestarted);
}

// Another master resets a drive just before the group does: two boot-up messages follow.
TEST_F(DriveGroupTest, ToleratesASecondBootUpMessageBeforeConfiguration) {
  group.boot();
  run_ms(2);
  for (const std::uint8_t node : {std::uint8_t{16}, std::uint8_t{35}})
    tell(node, HeartbeatEventKind::kBootedUp);
  run_ms(700);
  EXPECT_TRUE(group.configured());
  EXPECT_FALSE(group.fault());
}

TEST_F(DriveGroupTest, ReportsADriveThatKeepsBootingUp) {
  group.boot();
  run_ms(2);
  tell(35, HeartbeatEventKind::kBootedUp);
  EXPECT_FALSE(group.fault());
  tell(35, HeartbeatEventKind::kBootedUp);
  EXPECT_EQ(group.fault().kind, DriveFault::kRestarted);
}

TEST_F(DriveGroupTest, ReportsADriveThatLosesItsConfigurationInTheBoot) {
  group.boot();
  run_ms(300);
  tell(16, HeartbeatEventKind::kBootedUp);
  EXPECT_EQ(group.fault().kind, DriveFault::kRestarted);
}

TEST_F(DriveGroupTest, IgnoresAnswersFromBeforeTheReset) {
  enable();
  group.boot();
  for (std::size_t i = 0; i < drives.size(); ++i) {
    signals.statusword[i] = cia402::statusword_of(cia402::State::kFault);
    group.on_answer(i);
  }
  run_ms(700);
  ASSERT_TRUE(group.configured());
  group.observe(now_us);
  EXPECT_FALSE(group.booted());
  EXPECT_FALSE(group.fault());
}

TEST_F(DriveGroupTest, TranslatesAnglesByTheDrivesSignZeroAndUnit) {
  robot::Drive& mounted = model.joints[0].drive;
  mounted.sign = -1;
  mounted.zero = test::degrees(45);
  group.set_target(0, test::degrees(30));
  EXPECT_EQ(signals.target_position[0], 43'691);  // 15 degrees of the shaft in 2^-20 turns
  signals.position[0] = 43'691;
  EXPECT_NEAR(fixed::to_double(group.angle(0)), 30 * test::kRadPerDegree, 1e-5);
}

TEST_F(DriveGroupTest, ChecksLimitsWithAMargin) {
  signals.position[0] = 267'500;  // 91.8 degrees: limit of 90, tolerance of 2
  EXPECT_EQ(group.enable_conditions().beyond_limits, 0u);
  signals.position[0] = 268'500;  // 92.2 degrees
  EXPECT_EQ(group.enable_conditions().beyond_limits, 1u << 0);
}

using DriveGroupDeathTest = DriveGroupTest;

TEST_F(DriveGroupDeathTest, RejectsAJointBeyondTheModels) {
  EXPECT_DEATH(group.set_target(model.joint_count, {}), "joint_count");
  EXPECT_DEATH(static_cast<void>(group.angle(model.joint_count)), "joint_count");
}

}  // namespace
}  // namespace koboshi::drive
