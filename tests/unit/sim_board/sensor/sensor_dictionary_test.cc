#include "sim_board/sensor/sensor_dictionary.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace koboshi::sim_board {
namespace {

using testing::SizeIs;

// A sensor's node on a bus of its own, operational.
class BareSensorNode final : private canopen::FrameSink, private canopen::NodeApplication {
 public:
  BareSensorNode(SensorKind kind, std::uint8_t node_id)
      : description_(sensor_node_description(kind)),
        node(
            description_,
            {.node_id = node_id, .serial_number = 1, .values = std::as_writable_bytes(std::span(&values, 1))},
            memory_.buffers(), *this, *this) {
    node.start(0);
    node.command(canopen::NmtCommand::kStart, 0);
    frames.clear();
  }

  SensorValues values;
  std::vector<hal::CanFrame> frames;

 private:
  bool send(const hal::CanFrame& frame) override {
    frames.push_back(frame);
    return true;
  }

  canopen::NodeDescription description_;
  canopen::NodeMemory<0, kSensorTpdos, 2, 8> memory_;

 public:
  canopen::Node node;
};

TEST(InertialNode, SendsItsAxesPeriodically) {
  BareSensorNode sensor(SensorKind::kInertial, 36);
  sensor.values.sample = 0x0102;
  sensor.values.gyro[0] = -2;
  sensor.values.accelerometer[2] = 0x0304;
  sensor.node.process(3'999);
  EXPECT_THAT(sensor.frames, SizeIs(0));
  sensor.node.process(4'000);
  ASSERT_THAT(sensor.frames, SizeIs(2));
  EXPECT_EQ(sensor.frames[0].identifier, 0x1A4);
  EXPECT_EQ(sensor.frames[0].data, (std::array<std::uint8_t, 8>{0xFE, 0xFF, 0, 0, 0, 0, 0x02, 0x01}));
  EXPECT_EQ(sensor.frames[1].identifier, 0x2A4);
  EXPECT_EQ(sensor.frames[1].data, (std::array<std::uint8_t, 8>{0, 0, 0, 0, 0x04, 0x03, 0x02, 0x01}));
}

TEST(AnkleNode, SendsForceAndTorqueAtSync) {
  BareSensorNode sensor(SensorKind::kForceTorque, 37);
  sensor.values.force[2] = 0x0506;
  sensor.values.torque[1] = 0x0708;
  sensor.node.process(50'000);
  EXPECT_THAT(sensor.frames, SizeIs(0));
  sensor.node.on_frame({.identifier = canopen::kSyncCobId}, 50'000);
  ASSERT_THAT(sensor.frames, SizeIs(2));
  EXPECT_EQ(sensor.frames[0].identifier, 0x1A5);
  EXPECT_EQ(sensor.frames[0].data, (std::array<std::uint8_t, 8>{0, 0, 0, 0, 0x06, 0x05, 0, 0}));
  EXPECT_EQ(sensor.frames[1].identifier, 0x2A5);
  EXPECT_EQ(sensor.frames[1].data, (std::array<std::uint8_t, 8>{0, 0, 0x08, 0x07, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace koboshi::sim_board
