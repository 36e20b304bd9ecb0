#include "firmware/drive/configuration.h"

#include <gtest/gtest.h>

#include "hal/fake/can.h"
#include "tests/support/drive_stub.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::drive {
namespace {

using State = Configuration::State;

// One configuration and one drive. `exchange` advances one millisecond: the configuration sends, the drive
// answers.
class ConfigurationTest : public testing::Test {
 protected:
  void begin(const robot::Joint& joint) {
    drive.emplace(joint.drive);
    configuration.begin(joint);
  }
  void exchange() {
    configuration.process(now_us);
    std::vector<hal::CanFrame> answers;
    for (; seen < can.sent().size(); ++seen) drive->on_frame(can.sent()[seen], answers);
    for (const hal::CanFrame& answer : answers) client.on_frame(answer);
    now_us += 1'000;
    client.process(now_us);
  }
  void run() {
    for (int i = 0; i < 1'000 && configuration.state() == State::kBusy; ++i) exchange();
  }

  robot::RobotModel model = test::make_test_robot();
  hal::FakeCan can;
  canopen::CanPortSink sink{can};
  canopen::SdoClient client{sink};
  Configuration configuration{client};
  std::optional<test::DriveStub> drive;
  std::size_t seen = 0;
  std::uint64_t now_us = 0;
};

// The left hip yaw: node 16, serial number 1000, from -90 to 90 degrees. Bytes derived by hand from CiA 301,
// 7.2.4.3, and CiA 402-2: command, index, sub-index, value, little-endian.
TEST_F(ConfigurationTest, SendsExactlyTheseRequests) {
  using Data = std::array<std::uint8_t, 8>;
  constexpr Data kExpected[] = {
      {0x40, 0x18, 0x10, 0x01},                          // read vendor, product, serial number
      {0x40, 0x18, 0x10, 0x02},                          //
      {0x40, 0x18, 0x10, 0x04},                          //
      {0x23, 0x00, 0x14, 0x01, 0x10, 0x02, 0x00, 0x80},  // RPDO 1 invalid
      {0x2F, 0x00, 0x14, 0x02, 0x01},                    // at every SYNC
      {0x2B, 0x00, 0x14, 0x05, 0x3C, 0x00},              // deadline of 60 ms
      {0x2F, 0x00, 0x16, 0x00, 0x00},                    // no objects
      {0x23, 0x00, 0x16, 0x01, 0x10, 0x00, 0x40, 0x60},  // controlword, 16 bits
      {0x23, 0x00, 0x16, 0x02, 0x20, 0x00, 0x7A, 0x60},  // target position, 32 bits
      {0x2F, 0x00, 0x16, 0x00, 0x02},                    // two objects
      {0x23, 0x00, 0x14, 0x01, 0x10, 0x02, 0x00, 0x00},  // RPDO 1 valid: identifier 0x210
      {0x23, 0x00, 0x18, 0x01, 0x90, 0x01, 0x00, 0xC0},  // TPDO 1 invalid, no remote frames
      {0x2F, 0x00, 0x18, 0x02, 0x01},                    // at every SYNC
      {0x2F, 0x00, 0x1A, 0x00, 0x00},                    // no objects
      {0x23, 0x00, 0x1A, 0x01, 0x10, 0x00, 0x41, 0x60},  // statusword, 16 bits
      {0x23, 0x00, 0x1A, 0x02, 0x20, 0x00, 0x64, 0x60},  // actual position, 32 bits
      {0x23, 0x00, 0x1A, 0x03, 0x10, 0x00, 0x77, 0x60},  // actual torque, 16 bits
      {0x2F, 0x00, 0x1A, 0x00, 0x03},                    // three objects
      {0x23, 0x00, 0x18, 0x01, 0x90, 0x01, 0x00, 0x40},  // TPDO 1 valid: identifier 0x190
      {0x23, 0x16, 0x10, 0x01, 0x3C, 0x00, 0x01, 0x00},  // node 1 counts as lost after 60 ms
      {0x2B, 0x17, 0x10, 0x00, 0x64, 0x00},              // heartbeat every 100 ms
      {0x23, 0x06, 0x10, 0x00, 0x10, 0x27, 0x00, 0x00},  // SYNC every 10,000 us
      {0x2F, 0xC2, 0x60, 0x01, 0x0A},                    // interpolate over 10 ms
      {0x23, 0x7D, 0x60, 0x01, 0x00, 0x00, 0xFC, 0xFF},  // from -2^18: a quarter of a turn
      {0x23, 0x7D, 0x60, 0x02, 0x00, 0x00, 0x04, 0x00},  // to 2^18
      {0x2F, 0x60, 0x60, 0x00, 0x08},                    // cyclic synchronous position
      {0x40, 0x79, 0x60, 0x00},                          // read the supply voltage
  };
  begin(model.joints[0]);
  run();
  ASSERT_EQ(configuration.state(), State::kDone);
  ASSERT_EQ(can.sent().size(), std::size(kExpected));
  for (std::size_t i = 0; i < std::size(kExpected); ++i) {
    EXPECT_EQ(can.sent()[i].identifier, 0x610);
    EXPECT_EQ(can.sent()[i].size, 8);
    EXPECT_EQ(can.sent()[i].data, kExpected[i]) << "request " << i;
  }
  EXPECT_EQ(configuration.supply_mV(), 7'400u);
}

TEST_F(ConfigurationTest, SwapsTheLimitsOfADriveMountedInReverse) {
  robot::Joint& knee = model.joints[3];  // from 0 to 150 degrees
  knee.drive.sign = -1;
  begin(knee);
  run();
  const auto limit = [&](std::uint8_t subindex) {
    return static_cast<std::int32_t>(drive->object(0x607D, subindex));
  };
  EXPECT_EQ(limit(1), -436'907);  // 150 degrees in 2^-20 turns
  EXPECT_EQ(limit(2), 0);
}

TEST_F(ConfigurationTest, TakesOneMillisecondPerRequest) {
  begin(model.joints[0]);
  run();
  EXPECT_EQ(now_us, 28'000u);  // 27 requests, and one check of the last answer
}

TEST_F(ConfigurationTest, GivesUpAfterThreeAttempts) {
  begin(model.joints[0]);
  drive->answers_sdo = false;
  run();
  EXPECT_EQ(configuration.state(), State::kFailed);
  EXPECT_EQ(configuration.fault(), DriveFault::kNoAnswer);
  EXPECT_NEAR(static_cast<double>(now_us), 300'000, 5'000);
  std::size_t requests = 0;
  for (const hal::CanFrame& frame : can.sent()) requests += frame.data[0] == 0x40;
  EXPECT_EQ(requests, 3u);
}

TEST_F(ConfigurationTest, CountsAttemptsPerRequest) {
  begin(model.joints[0]);
  for (int silence = 0; silence < 3; ++silence) {
    for (int i = 0; i < 5; ++i) exchange();
    drive->answers_sdo = false;
    for (int i = 0; i < 150; ++i) exchange();  // two requests are lost, the third is answered
    EXPECT_EQ(configuration.state(), State::kBusy);
    drive->answers_sdo = true;
    for (int i = 0; i < 52; ++i) exchange();
  }
  run();
  EXPECT_EQ(configuration.state(), State::kDone);
}

TEST_F(ConfigurationTest, RestartsInTheMiddleOfARequest) {
  begin(model.joints[0]);
  drive->answers_sdo = false;
  exchange();
  begin(model.joints[1]);
  run();
  EXPECT_EQ(configuration.state(), State::kDone);
  EXPECT_LT(now_us, 30'000u);  // did not wait for the other's time-out
}

TEST_F(ConfigurationTest, WaitsForSpaceInTheTransmitFifo) {
  begin(model.joints[0]);
  can.limit_transmit(0);
  for (int i = 0; i < 500; ++i) exchange();
  EXPECT_EQ(configuration.state(), State::kBusy);
  can.release_transmit();
  run();
  EXPECT_EQ(configuration.state(), State::kDone);
}

TEST_F(ConfigurationTest, StopsAtAWrongIdentityBeforeItWritesAnything) {
  for (const std::uint8_t subindex : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}}) {
    begin(model.joints[0]);
    drive->set_object(0x1018, subindex, 0xBAD);
    seen = can.sent().size();
    const std::size_t first = seen;
    run();
    EXPECT_EQ(configuration.fault(), DriveFault::kWrongIdentity);
    for (std::size_t i = first; i < can.sent().size(); ++i) EXPECT_EQ(can.sent()[i].data[0], 0x40);
  }
}

TEST_F(ConfigurationTest, StopsWhenTheDriveRefuses) {
  begin(model.joints[0]);
  drive->refuses = {0x60C2, 1};
  run();
  EXPECT_EQ(configuration.state(), State::kFailed);
  EXPECT_EQ(configuration.fault(), DriveFault::kRefused);
}

TEST_F(ConfigurationTest, ForgetsTheFaultOfTheLastDrive) {
  begin(model.joints[0]);
  drive->refuses = {0x60C2, 1};
  run();
  ASSERT_EQ(configuration.fault(), DriveFault::kRefused);
  begin(model.joints[1]);
  EXPECT_EQ(configuration.fault(), DriveFault::kNone);
  run();
  EXPECT_EQ(configuration.state(), State::kDone);
  EXPECT_EQ(configuration.fault(), DriveFault::kNone);
}

}  // namespace
}  // namespace koboshi::drive
