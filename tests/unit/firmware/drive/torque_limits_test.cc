#include "firmware/drive/torque_limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "firmware/canopen/sdo/protocol.h"
#include "tests/unit/firmware/drive/drive_group_fixture.h"

namespace koboshi::drive {
namespace {

constexpr std::uint32_t kFull = TorqueLimits::kFull_permille;

// Notes the nodes whose 0x6072 is written, in order.
class TorqueLimitsTest : public DriveGroupTest {
 protected:
  void run(int duration_ms) {
    for (int i = 0; i < duration_ms; ++i, now_us += 1'000) {
      group.process(now_us);
      std::vector<hal::CanFrame> answers;
      int begun = 0;
      for (const hal::CanFrame& frame : can.sent()) {
        const bool asks = frame.identifier > canopen::kSdoRequestBase &&
                          frame.identifier < canopen::kSdoRequestBase + 0x80 &&
                          frame.data[0] != canopen::sdo::kAbort;
        if (asks) requests.push_back(frame);
        begun += asks ? 1 : 0;
        for (test::DriveStub& drive : drives) drive.on_frame(frame, answers);
      }
      EXPECT_LE(begun, 1) << "one SDO at a time";
      can.clear_sent();
      for (const hal::CanFrame& answer : answers) hear(answer);
    }
  }
  std::vector<std::size_t> written() const {
    std::vector<std::size_t> joints;
    for (const hal::CanFrame& frame : requests) {
      if (canopen::sdo::address_of(frame.data) != canopen::ObjectAddress{0x6072, 0}) continue;
      for (std::size_t i = 0; i < model.joint_count; ++i) {
        if (frame.identifier == canopen::kSdoRequestBase + model.joints[i].drive.node_id) joints.push_back(i);
      }
    }
    return joints;
  }
  void boot_quietly() {
    boot();
    for (test::DriveStub& drive : drives) drive.set_object(0x6072, 0, kFull);
  }

  std::vector<hal::CanFrame> requests;
};

TEST_F(TorqueLimitsTest, WritesNothingWhileAllHaveTheirFullTorque) {
  boot_quietly();
  for (std::size_t i = 0; i < drives.size(); ++i) group.set_torque_limit(i, kFull);
  run(100);
  EXPECT_TRUE(written().empty());
}

TEST_F(TorqueLimitsTest, ForgetsLimitsThatWaitAtTheNextBoot) {
  boot_quietly();
  for (std::size_t i = 0; i < drives.size(); ++i) group.set_torque_limit(i, 300);
  group.boot();
  run(700);
  cycle();
  run(100);
  ASSERT_TRUE(group.booted());
  EXPECT_TRUE(written().empty());
}

TEST_F(TorqueLimitsTest, WritesTheLimitsOfAllJointsOneAfterTheOther) {
  boot_quietly();
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    expected.push_back(i);
    group.set_torque_limit(i, static_cast<std::uint16_t>(10 * i));
  }
  run(static_cast<int>(drives.size()) + 1);
  EXPECT_EQ(written(), expected);
  for (std::size_t i = 0; i < drives.size(); ++i) EXPECT_EQ(drives[i].object(0x6072, 0), 10 * i);
  run(500);
  EXPECT_EQ(written().size(), drives.size()) << "each is written once";
}

TEST_F(TorqueLimitsTest, WritesOnlyTheLastOfSeveralWantedLimits) {
  boot_quietly();
  group.set_torque_limit(3, 500);
  run(1);  // under way
  group.set_torque_limit(3, 400);
  group.set_torque_limit(5, 100);
  group.set_torque_limit(3, 200);
  group.set_torque_limit(5, kFull);
  run(10);
  EXPECT_EQ(written(), (std::vector<std::size_t>{3, 3}));
  EXPECT_EQ(drives[3].object(0x6072, 0), 200u);
}

TEST_F(TorqueLimitsTest, GivesOtherJointsTheirTurnWhileADriveDoesNotAnswer) {
  boot_quietly();
  drives[0].answers_sdo = false;
  group.set_torque_limit(0, 0);
  group.set_torque_limit(1, 0);
  run(110);
  EXPECT_EQ(drives[1].object(0x6072, 0), 0u);
  drives[0].answers_sdo = true;
  run(110);
  EXPECT_EQ(drives[0].object(0x6072, 0), 0u) << "repeated";
  EXPECT_EQ(group.without_torque_limit(), 0u);
  EXPECT_FALSE(group.fault());
}

TEST_F(TorqueLimitsTest, AsksADriveWithoutTheObjectOnce) {
  boot_quietly();
  drives[2].refuses = canopen::ObjectAddress{0x6072, 0};
  group.set_torque_limit(2, 300);
  group.set_torque_limit(4, 300);
  run(10);
  EXPECT_EQ(group.without_torque_limit(), 1u << 2);
  EXPECT_EQ(drives[4].object(0x6072, 0), 300u);
  group.set_torque_limit(2, 100);
  group.set_torque_limit(2, kFull);
  run(300);
  EXPECT_EQ(written(), (std::vector<std::size_t>{2, 4}));
  EXPECT_FALSE(group.fault());
  group.boot();
  EXPECT_EQ(group.without_torque_limit(), 0u);
}

TEST_F(TorqueLimitsTest, WritesAgainWhatADriveHasForgottenInARestart) {
  boot_quietly();
  group.set_torque_limit(4, 300);
  run(5);
  drives[4].set_object(0x6072, 0, kFull);
  tell(model.joints[4].drive.node_id, HeartbeatEventKind::kBootedUp);
  run(5);
  EXPECT_EQ(drives[4].object(0x6072, 0), 300u);
  EXPECT_EQ(group.fault().kind, DriveFault::kRestarted);
}

TEST_F(TorqueLimitsTest, WantsFullTorqueAfterABoot) {
  boot_quietly();
  group.set_torque_limit(4, 300);
  boot_quietly();
  run(50);
  EXPECT_TRUE(written().empty());
}

TEST_F(TorqueLimitsTest, GoesRoundTheJoints) {
  boot_quietly();
  group.set_torque_limit(10, 300);
  run(1);
  group.set_torque_limit(3, 300);
  group.set_torque_limit(12, 300);
  run(5);
  EXPECT_EQ(written(), (std::vector<std::size_t>{10, 12, 3}));
}

// A write from before the boot, which no drive will answer, does not hold up the first one after it.
TEST_F(TorqueLimitsTest, WritesAtOnceAfterAReset) {
  TorqueLimits limits(model, sink);
  limits.set(4, 300);
  limits.process(true, now_us);
  ASSERT_EQ(can.sent().size(), 1u);
  limits.reset();
  limits.set(5, 300);
  limits.process(true, now_us + 1'000);
  EXPECT_EQ(can.sent().size(), 2u);
}

}  // namespace
}  // namespace koboshi::drive
