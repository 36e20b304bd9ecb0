#include "firmware/drive/setting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "firmware/canopen/sdo/protocol.h"
#include "tests/unit/firmware/drive/drive_group_fixture.h"

namespace koboshi::drive {
namespace {

constexpr std::uint16_t kOwn = Setting::kOwn_permille;

struct Case {
  const char* name;
  canopen::ObjectAddress object;
  void (DriveGroup::*set)(std::size_t joint, std::uint16_t permille);
  std::uint32_t (DriveGroup::*refused)() const;
};

constexpr Case kTorqueLimit{
    "TorqueLimit", {0x6072, 0}, &DriveGroup::set_torque_limit, &DriveGroup::without_torque_limit};
constexpr Case kPositionGain{
    "PositionGain", {0x60FB, 1}, &DriveGroup::set_position_gain, &DriveGroup::without_position_gain};

// Notes the nodes whose object is written, in order.
class SettingTest : public DriveGroupTest, public testing::WithParamInterface<Case> {
 protected:
  void set(std::size_t joint, std::uint16_t permille) { (group.*GetParam().set)(joint, permille); }
  std::uint32_t refused() const { return (group.*GetParam().refused)(); }
  std::uint32_t value(std::size_t joint) const {
    return drives[joint].object(GetParam().object.index, GetParam().object.subindex);
  }
  void reset_to_own(test::DriveStub& drive) const {
    drive.set_object(GetParam().object.index, GetParam().object.subindex, kOwn);
  }
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
      if (canopen::sdo::address_of(frame.data) != GetParam().object) continue;
      for (std::size_t i = 0; i < model.joint_count; ++i) {
        if (frame.identifier == canopen::kSdoRequestBase + model.joints[i].drive.node_id) joints.push_back(i);
      }
    }
    return joints;
  }
  void boot_quietly() {
    boot();
    for (test::DriveStub& drive : drives) reset_to_own(drive);
  }

  std::vector<hal::CanFrame> requests;
};

TEST_P(SettingTest, WritesNothingWhileAllHaveTheirOwnValue) {
  boot_quietly();
  for (std::size_t i = 0; i < drives.size(); ++i) set(i, kOwn);
  run(100);
  EXPECT_TRUE(written().empty());
}

TEST_P(SettingTest, ForgetsValuesThatWaitAtTheNextBoot) {
  boot_quietly();
  for (std::size_t i = 0; i < drives.size(); ++i) set(i, 300);
  group.boot();
  run(700);
  cycle();
  run(100);
  ASSERT_TRUE(group.booted());
  EXPECT_TRUE(written().empty());
}

TEST_P(SettingTest, WritesTheValuesOfAllJointsOneAfterTheOther) {
  boot_quietly();
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    expected.push_back(i);
    set(i, static_cast<std::uint16_t>(10 * i));
  }
  run(static_cast<int>(drives.size()) + 1);
  EXPECT_EQ(written(), expected);
  for (std::size_t i = 0; i < drives.size(); ++i) EXPECT_EQ(value(i), 10 * i);
  run(500);
  EXPECT_EQ(written().size(), drives.size()) << "each is written once";
}

TEST_P(SettingTest, WritesOnlyTheLastOfSeveralWantedValues) {
  boot_quietly();
  set(3, 500);
  run(1);  // under way
  set(3, 400);
  set(5, 100);
  set(3, 200);
  set(5, kOwn);
  run(10);
  EXPECT_EQ(written(), (std::vector<std::size_t>{3, 3}));
  EXPECT_EQ(value(3), 200u);
}

TEST_P(SettingTest, GivesOtherJointsTheirTurnWhileADriveDoesNotAnswer) {
  boot_quietly();
  drives[0].answers_sdo = false;
  set(0, 0);
  set(1, 0);
  run(110);
  EXPECT_EQ(value(1), 0u);
  drives[0].answers_sdo = true;
  run(110);
  EXPECT_EQ(value(0), 0u) << "repeated";
  EXPECT_EQ(refused(), 0u);
  EXPECT_FALSE(group.fault());
}

TEST_P(SettingTest, AsksADriveWithoutTheObjectOnce) {
  boot_quietly();
  drives[2].refuses = GetParam().object;
  set(2, 300);
  set(4, 300);
  run(10);
  EXPECT_EQ(refused(), 1u << 2);
  EXPECT_EQ(value(4), 300u);
  set(2, 100);
  set(2, kOwn);
  run(300);
  EXPECT_EQ(written(), (std::vector<std::size_t>{2, 4}));
  EXPECT_FALSE(group.fault());
  group.boot();
  EXPECT_EQ(refused(), 0u);
}

TEST_P(SettingTest, WritesAgainWhatADriveHasForgottenInARestart) {
  boot_quietly();
  set(4, 300);
  run(5);
  reset_to_own(drives[4]);
  tell(model.joints[4].drive.node_id, HeartbeatEventKind::kBootedUp);
  run(5);
  EXPECT_EQ(value(4), 300u);
  EXPECT_EQ(group.fault().kind, DriveFault::kRestarted);
}

TEST_P(SettingTest, WantsTheOwnValueAfterABoot) {
  boot_quietly();
  set(4, 300);
  boot_quietly();
  run(50);
  EXPECT_TRUE(written().empty());
}

TEST_P(SettingTest, GoesRoundTheJoints) {
  boot_quietly();
  set(10, 300);
  run(1);
  set(3, 300);
  set(12, 300);
  run(5);
  EXPECT_EQ(written(), (std::vector<std::size_t>{10, 12, 3}));
}

// A write from before the boot, which no drive will answer, does not hold up the first one after it.
TEST_P(SettingTest, WritesAtOnceAfterAReset) {
  Setting setting(model, GetParam().object, kOwn, sink);
  setting.set(4, 300);
  setting.process(true, now_us);
  ASSERT_EQ(can.sent().size(), 1u);
  setting.reset();
  setting.set(5, 300);
  setting.process(true, now_us + 1'000);
  EXPECT_EQ(can.sent().size(), 2u);
}

INSTANTIATE_TEST_SUITE_P(Of, SettingTest, testing::Values(kTorqueLimit, kPositionGain),
                         [](const auto& info) { return info.param.name; });

// The limits go first: a joint may have to become limp at once.
class BothSettings : public SettingTest {};
TEST_P(BothSettings, AreWrittenByOneClientAtATime) {
  boot_quietly();
  for (std::size_t i = 0; i < drives.size(); ++i) {
    group.set_position_gain(i, 500);
    group.set_torque_limit(i, 400);
  }
  run(2 * static_cast<int>(drives.size()) + 2);
  for (std::size_t i = 0; i < drives.size(); ++i) {
    EXPECT_EQ(drives[i].object(0x6072, 0), 400u);
    EXPECT_EQ(drives[i].object(0x60FB, 1), 500u);
  }
  EXPECT_EQ(canopen::sdo::address_of(requests.front().data), kTorqueLimit.object);
}
INSTANTIATE_TEST_SUITE_P(Of, BothSettings, testing::Values(kTorqueLimit),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace koboshi::drive
