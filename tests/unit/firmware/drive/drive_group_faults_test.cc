#include "firmware/drive/drive_group.h"

#include <gtest/gtest.h>

#include "tests/unit/firmware/drive/drive_group_fixture.h"

namespace koboshi::drive {
namespace {

TEST_F(DriveGroupTest, ReportsFaultsByEmergencyMessageWithItsCode) {
  boot();
  group.on_emergency({.node_id = 16 + 9, .code = 0x2310});
  EXPECT_EQ(group.fault().kind, DriveFault::kFault);
  EXPECT_EQ(group.fault().joint, 9);
  EXPECT_EQ(group.fault().error_code, 0x2310);
}

// Codes of CiA 301, table 26, with the error register's bits for generic and communication errors.
TEST_F(DriveGroupTest, ToleratesCommunicationWarnings) {
  enable();
  for (const std::uint16_t code :
       std::array<std::uint16_t, 6>{0x8110, 0x8120, 0x8140, 0x8210, 0x8220, 0x8240}) {
    group.on_emergency({.node_id = 16 + 9, .code = code, .error_register = 0x11});
    cycle();
    EXPECT_FALSE(group.fault()) << std::hex << code;
  }
}

TEST_F(DriveGroupTest, TreatsACommunicationErrorWithOtherErrorsAsAFault) {
  boot();
  group.on_emergency({.node_id = 16 + 9, .code = 0x8120, .error_register = 0x11 | 0x08});
  EXPECT_EQ(group.fault().kind, DriveFault::kFault);
  EXPECT_EQ(group.fault().error_code, 0x8120);
}

TEST_F(DriveGroupTest, TreatsALostControllerAsAFault) {
  for (const std::uint16_t code : std::array<std::uint16_t, 3>{0x8700, 0x8130, 0x8250}) {
    boot();
    group.on_emergency({.node_id = 16 + 9, .code = code, .error_register = 0x11});
    EXPECT_EQ(group.fault().kind, DriveFault::kFault);
    EXPECT_EQ(group.fault().error_code, code);
  }
}

TEST_F(DriveGroupTest, ReportsTheWarningThatBecameAFault) {
  enable();
  group.on_emergency({.node_id = 16 + 9, .code = 0x8140, .error_register = 0x11});
  group.on_emergency({.node_id = 16 + 9, .code = 0x0000, .error_register = 0x11});  // reset of another error
  drives[9].state = cia402::State::kFault;
  cycle();
  EXPECT_EQ(group.fault().kind, DriveFault::kFault);
  EXPECT_EQ(group.fault().joint, 9);
  EXPECT_EQ(group.fault().error_code, 0x8140);
}

TEST_F(DriveGroupTest, ClearsAWarningThatHasEnded) {
  enable();
  group.on_emergency({.node_id = 16 + 9, .code = 0x8120, .error_register = 0x11});
  group.on_emergency({.node_id = 16 + 9, .code = 0x0000, .error_register = 0x00});
  drives[9].state = cia402::State::kFault;
  cycle();
  EXPECT_EQ(group.fault().error_code, 0);
}

TEST_F(DriveGroupTest, ReportsFaultsByStatusword) {
  boot();
  drives[9].state = cia402::State::kFault;
  cycle();
  EXPECT_EQ(group.fault().kind, DriveFault::kFault);
  EXPECT_EQ(group.fault().joint, 9);
}

TEST_F(DriveGroupTest, ReportsAFaultOfEachDrive) {
  for (std::size_t i = 0; i < drives.size(); ++i) {
    SCOPED_TRACE(i);
    boot();
    drives[i].state = cia402::State::kFault;
    cycle();
    EXPECT_EQ(group.fault().kind, DriveFault::kFault);
    EXPECT_EQ(group.fault().joint, i);
    drives[i].state = cia402::State::kSwitchOnDisabled;
    enable();
    drives[i].state = cia402::State::kSwitchOnDisabled;
    cycle();
    EXPECT_EQ(group.fault().kind, DriveFault::kNotEnabled);
    EXPECT_EQ(group.fault().joint, i);
    boot();
    drives[i].hangs = true;
    cycles(5);
    EXPECT_EQ(group.fault().kind, DriveFault::kLost);
    EXPECT_EQ(group.fault().joint, i);
    drives[i].hangs = false;
  }
}

TEST_F(DriveGroupTest, IgnoresTheEndOfAnErrorAndOtherNodes) {
  boot();
  group.on_emergency({.node_id = 16, .code = 0x0000});
  group.on_emergency({.node_id = 100, .code = 0x2310});
  tell(100, HeartbeatEventKind::kLost);
  EXPECT_FALSE(group.fault());
}

TEST_F(DriveGroupTest, KeepsTheFirstFaultUntilTheNextBoot) {
  boot();
  group.on_emergency({.node_id = 16 + 9, .code = 0x2310});
  tell(16 + 3, HeartbeatEventKind::kLost);
  EXPECT_EQ(group.fault().joint, 9);
  boot();
}

}  // namespace
}  // namespace koboshi::drive
