#include "sim_board/sensor/sensor_node.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/canopen/frame.h"
#include "hal/linux/can_sensors.h"
#include "tests/unit/sim_board/can/bus_fixture.h"

namespace koboshi::sim_board {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// A sensor's node and a master on a bus.
class SensorNodeTest : public testing::Test {
 protected:
  explicit SensorNodeTest(SensorKind kind, std::uint8_t node_id) : sensor_(kind, node_id, bus_) {
    master_.answer = [this](const hal::CanFrame& frame, std::uint64_t time_us) {
      reader_.on_frame(frame, time_us);
      identifiers_.push_back(frame.identifier);
    };
  }

  void play_until(std::uint64_t end_us) {
    for (; now_us_ < end_us; now_us_ += 1'000) {
      sensor_.update(now_us_);
      bus_.advance_to(now_us_ + 1'000);
    }
  }
  void send(const hal::CanFrame& frame) { ASSERT_TRUE(bus_.queue(handle_, frame, now_us_)); }
  // Past its boot, in operation, with nothing heard yet.
  void start() {
    play_until(SensorNode::kBootTime_us + 1'000);
    send(canopen::encode(canopen::NmtMessage{canopen::NmtCommand::kStart, 0}));
    play_until(now_us_ + 1'000);
    identifiers_.clear();
  }

  test::ListeningNode master_;
  Bus bus_;
  NodeHandle handle_ = bus_.attach(master_, AcceptanceFilter::all(), 4);
  SensorNode sensor_;
  hal::CanSensors reader_;  // of the firmware's process
  std::vector<std::uint16_t> identifiers_;
  std::uint64_t now_us_ = 0;
};

class InertialSensorNode : public SensorNodeTest {
 protected:
  InertialSensorNode() : SensorNodeTest(SensorKind::kInertial, kInertialNode) {}
};

class AnkleSensorNode : public SensorNodeTest {
 protected:
  AnkleSensorNode() : SensorNodeTest(SensorKind::kForceTorque, kLeftAnkleNode) {}
};

TEST_F(InertialSensorNode, SendsBootUpAndWaits) {
  play_until(SensorNode::kBootTime_us);
  EXPECT_THAT(identifiers_, IsEmpty());
  play_until(SensorNode::kBootTime_us + 20'000);
  EXPECT_THAT(identifiers_, ElementsAre(canopen::kHeartbeatBase + kInertialNode));
}

TEST_F(InertialSensorNode, SendsItsLatestSamplePeriodically) {
  start();
  sensor_.take(hal::ImuSample{.gyro_raw = {1, 2, 3}, .accelerometer_raw = {4, 5, 6}});
  sensor_.take(hal::ImuSample{.gyro_raw = {-7, 8, 9}, .accelerometer_raw = {10, 11, -12}});
  play_until(now_us_ + 10'000);  // two periods, wherever the first begins
  EXPECT_THAT(identifiers_, ElementsAre(0x1A4, 0x2A4, 0x1A4, 0x2A4));
  const auto sample = reader_.inertial(now_us_);
  ASSERT_TRUE(sample);
  EXPECT_THAT(sample->gyro_raw, ElementsAre(-7, 8, 9));
  EXPECT_THAT(sample->accelerometer_raw, ElementsAre(10, 11, -12));
}

TEST_F(InertialSensorNode, SendsAHeartbeatEachSecond) {
  start();
  play_until(now_us_ + 3'000'000);
  EXPECT_EQ(std::ranges::count(identifiers_, canopen::kHeartbeatBase + kInertialNode), 3);
}

TEST_F(AnkleSensorNode, KeepsItsParametersAcrossAReset) {
  start();
  const auto write = [this](unsigned command, unsigned index, unsigned subindex, std::uint32_t value) {
    hal::CanFrame frame{.identifier = canopen::kSdoRequestBase + kLeftAnkleNode, .size = 8};
    frame.data[0] = static_cast<std::uint8_t>(command);
    canopen::store_u16(&frame.data[1], static_cast<std::uint16_t>(index));
    frame.data[3] = static_cast<std::uint8_t>(subindex);
    canopen::store_u32(&frame.data[4], value);
    send(frame);
    play_until(now_us_ + 200'000);
  };
  write(0x2B, 0x1017, 0, 100);
  write(0x23, 0x1010, 1, 0x6576'6173);
  write(0x2B, 0x1017, 0, 0);
  send(canopen::encode(canopen::NmtMessage{canopen::NmtCommand::kResetNode, 0}));
  play_until(now_us_ + 2'000);
  identifiers_.clear();
  play_until(now_us_ + 1'000'000);
  EXPECT_EQ(std::ranges::count(identifiers_, canopen::kHeartbeatBase + kLeftAnkleNode), 10);
}

TEST_F(AnkleSensorNode, TakesANodeIdByLss) {
  start();
  const auto lss = [this](std::uint8_t command, std::uint8_t argument) {
    send({.identifier = 0x7E5, .size = 8, .data = {command, argument}});
    play_until(now_us_ + 2'000);
  };
  lss(0x04, 1);
  lss(0x11, 50);
  lss(0x04, 0);
  identifiers_.clear();
  send(canopen::encode(canopen::NmtMessage{canopen::NmtCommand::kResetCommunication, 0}));
  play_until(now_us_ + 2'000);
  EXPECT_THAT(identifiers_, ElementsAre(canopen::kHeartbeatBase + 50));
}

TEST_F(AnkleSensorNode, SendsItsLatestSampleAtEachSync) {
  start();
  sensor_.take(hal::AnkleSample{.force_raw = {1, 2, -3}, .torque_raw = {4, -5, 6}});
  play_until(now_us_ + 10'000);
  EXPECT_THAT(identifiers_, IsEmpty());
  send({.identifier = canopen::kSyncCobId});
  play_until(now_us_ + 2'000);
  EXPECT_THAT(identifiers_, ElementsAre(0x1A5, 0x2A5));
  const auto sample = reader_.take_ankle(hal::Side::kLeft);
  ASSERT_TRUE(sample);
  EXPECT_THAT(sample->force_raw, ElementsAre(1, 2, -3));
  EXPECT_THAT(sample->torque_raw, ElementsAre(4, -5, 6));
}

class PressureCellNode : public SensorNodeTest {
 protected:
  PressureCellNode() : SensorNodeTest(SensorKind::kPressureCells, kRightAnkleNode) {
    reader_.set_ankles(hal::AnkleKind::kPressureCells);
  }
};

TEST_F(PressureCellNode, SendsItsCellsAtEachSync) {
  start();
  sensor_.take(hal::AnkleSample{.force_raw = {1, 2, 300}, .torque_raw = {4, 0, 0}});
  send({.identifier = canopen::kSyncCobId});
  play_until(now_us_ + 2'000);
  EXPECT_THAT(identifiers_, ElementsAre(0x1A6));
  EXPECT_FALSE(reader_.take_ankle(hal::Side::kLeft));
  const auto sample = reader_.take_ankle(hal::Side::kRight);
  ASSERT_TRUE(sample);
  EXPECT_THAT(sample->force_raw, ElementsAre(1, 2, 300));
  EXPECT_THAT(sample->torque_raw, ElementsAre(4, 0, 0));
}

class ContactSwitchNode : public SensorNodeTest {
 protected:
  ContactSwitchNode() : SensorNodeTest(SensorKind::kContactSwitch, kLeftAnkleNode) {
    reader_.set_ankles(hal::AnkleKind::kContactSwitch);
  }
};

TEST_F(ContactSwitchNode, SendsItsContactAtEachSync) {
  start();
  for (const std::int16_t contact : {std::int16_t{1}, std::int16_t{0}}) {
    sensor_.take(hal::AnkleSample{.force_raw = {0, 0, contact}});
    send({.identifier = canopen::kSyncCobId});
    play_until(now_us_ + 2'000);
    const auto sample = reader_.take_ankle(hal::Side::kLeft);
    ASSERT_TRUE(sample);
    EXPECT_THAT(sample->force_raw, ElementsAre(0, 0, contact));
  }
  EXPECT_THAT(identifiers_, ElementsAre(0x1A5, 0x1A5));
}

TEST_F(AnkleSensorNode, AnswersSdo) {
  start();
  send({.identifier = 0x625, .size = 8, .data = {0x40, 0x00, 0x20}});
  play_until(now_us_ + 2'000);
  ASSERT_THAT(master_.seen, testing::Not(IsEmpty()));
  const hal::CanFrame answer = master_.seen.back().frame;
  EXPECT_EQ(answer.identifier, 0x5A5);
  EXPECT_EQ(answer.data[4], static_cast<std::uint8_t>(SensorKind::kForceTorque));
}

}  // namespace
}  // namespace koboshi::sim_board
