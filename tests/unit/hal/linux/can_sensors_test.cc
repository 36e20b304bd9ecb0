#include "hal/linux/can_sensors.h"

#include <gtest/gtest.h>

namespace koboshi::hal {
namespace {

// Returns a frame with three axes and the sample counter, in the layout of the PDO.
CanFrame half(std::uint16_t identifier, std::int16_t x, std::uint8_t number) {
  const auto word = static_cast<std::uint16_t>(x);
  return {
      .identifier = identifier,
      .size = 8,
      .data = {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8), 0, 0, 0, 0, number}};
}

TEST(CanSensors, JoinTheHalvesOfASample) {
  CanSensors sensors;
  EXPECT_TRUE(sensors.on_frame(half(0x1A4, -300, 7), 1'000));
  EXPECT_FALSE(sensors.inertial(1'000));
  EXPECT_TRUE(sensors.on_frame(half(0x2A4, 500, 7), 1'200));
  EXPECT_EQ(sensors.inertial(2'000), (ImuSample{2'000, {-300, 0, 0}, {500, 0, 0}}));
}

TEST(CanSensors, DoNotMixHalvesOfDifferentSamples) {
  CanSensors sensors;
  EXPECT_TRUE(sensors.on_frame(half(0x1A5, 1, 7), 0));
  EXPECT_TRUE(sensors.on_frame(half(0x2A5, 2, 8), 0));
  EXPECT_FALSE(sensors.take_ankle(Side::kLeft));
  EXPECT_TRUE(sensors.on_frame(half(0x1A5, 3, 8), 0));
  EXPECT_EQ(sensors.take_ankle(Side::kLeft), (AnkleSample{0, {3, 0, 0}, {2, 0, 0}}));
}

TEST(CanSensors, DeliverAnAnkleSampleOnce) {
  CanSensors sensors;
  EXPECT_TRUE(sensors.on_frame(half(0x1A6, 1, 1), 5'000));
  EXPECT_TRUE(sensors.on_frame(half(0x2A6, 2, 1), 5'100));
  EXPECT_FALSE(sensors.take_ankle(Side::kLeft));
  EXPECT_EQ(sensors.take_ankle(Side::kRight), (AnkleSample{5'100, {1, 0, 0}, {2, 0, 0}}));
  EXPECT_FALSE(sensors.take_ankle(Side::kRight));
}

TEST(CanSensors, RepeatAnInertialUnitUntilItIsSilent) {
  CanSensors sensors;
  EXPECT_TRUE(sensors.on_frame(half(0x1A4, 1, 1), 10'000));
  EXPECT_TRUE(sensors.on_frame(half(0x2A4, 1, 1), 10'000));
  EXPECT_TRUE(sensors.inertial(10'000 + CanSensors::kTimeout_us));
  EXPECT_FALSE(sensors.inertial(10'001 + CanSensors::kTimeout_us));
}

TEST(CanSensors, LeaveHeartbeatsToTheFirmware) {
  CanSensors sensors;
  EXPECT_FALSE(sensors.on_frame({.identifier = 0x726, .size = 1}, 0));
  EXPECT_FALSE(sensors.on_frame({.identifier = 0x724, .size = 1, .data = {5}}, 0));
}

TEST(CanSensors, IgnoreOtherFrames) {
  CanSensors sensors;
  EXPECT_FALSE(sensors.on_frame(half(0x1A3, 1, 1), 0));
  EXPECT_FALSE(sensors.on_frame(half(0x1A7, 1, 1), 0));
  EXPECT_FALSE(sensors.on_frame({.identifier = 0x1A4, .size = 8, .remote = true}, 0));
  EXPECT_FALSE(sensors.on_frame(half(0x5A4, 1, 1), 0));
}

TEST(CanSensors, IgnoreFramesOfWrongLength) {
  CanSensors sensors;
  EXPECT_TRUE(sensors.on_frame(half(0x1A4, 1, 0), 0));
  CanFrame cut = half(0x2A4, 1, 0);
  cut.size = 7;
  EXPECT_TRUE(sensors.on_frame(cut, 0));
  EXPECT_FALSE(sensors.inertial(0));
}

}  // namespace
}  // namespace koboshi::hal
