#include <algorithm>
#include <initializer_list>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/bus/dictionary/default_network.h"

namespace koboshi::bus {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

std::vector<Reading> decoded(std::uint16_t identifier, std::initializer_list<unsigned> bytes) {
  hal::CanFrame frame{.identifier = identifier, .size = static_cast<std::uint8_t>(bytes.size())};
  std::transform(bytes.begin(), bytes.end(), frame.data.begin(),
                 [](unsigned byte) { return static_cast<std::uint8_t>(byte); });
  return decode(default_network(), frame);
}

TEST(Decode, ScalesAndNamesTheValuesOfADrive) {
  const auto readings = decoded(0x190, {0x37, 0x12, 0x00, 0x00, 0xFC, 0xFF, 0x85, 0xFF});
  ASSERT_THAT(readings, SizeIs(3));
  EXPECT_EQ(readings[0].signal->name, "statusword");
  EXPECT_EQ(readings[0].name, "operation enabled");
  EXPECT_EQ(readings[1].signal->name, "position_actual_value");
  EXPECT_EQ(readings[1].raw, -262'144);
  EXPECT_DOUBLE_EQ(readings[1].value, -90.0);
  EXPECT_EQ(readings[1].signal->unit, "deg");
  EXPECT_EQ(readings[2].raw, -123);
  EXPECT_DOUBLE_EQ(readings[2].value, -12.3);
}

TEST(Decode, NamesTheStatesOfTheController) {
  const auto readings = decoded(0x181, {4, 2, 3, 0, 0, 0x34, 0x12, 35});
  ASSERT_THAT(readings, SizeIs(7));
  EXPECT_EQ(readings[0].name, "standing");
  EXPECT_EQ(readings[1].name, "progress");
  EXPECT_EQ(readings[2].name, "");
  EXPECT_EQ(readings[5].raw, 0x1234);
  EXPECT_EQ(readings[6].name, "IMU implausible");
}

TEST(Decode, DecodesMessagesThatAreNoPdos) {
  EXPECT_EQ(decoded(0x000, {129, 0})[0].name, "reset node");
  EXPECT_EQ(decoded(0x710, {127})[0].name, "pre-operational");
  EXPECT_EQ(decoded(0x081, {0x00, 0xFF, 0x81, 6, 17, 8, 2, 0})[3].name, "drive fault");
  EXPECT_EQ(decoded(0x090, {0x10, 0x43, 0x09, 0, 0, 0, 0, 0x80})[2].raw, 0x80'0000'0000);
  EXPECT_EQ(decoded(0x610, {0x2B, 0x17, 0x10, 0x00, 0x64, 0, 0, 0})[1].raw, 0x1017);
  EXPECT_THAT(decoded(0x080, {}), IsEmpty());
}

TEST(Decode, ScalesCountsByTheRobotsFile) {
  const sim_board::RobotDescription robot = default_robot();
  EXPECT_DOUBLE_EQ(decoded(0x1A5, {0, 0, 0, 0, 100, 0, 7, 0})[2].value,
                   100 * robot.left_ankle->force.resolution);
  EXPECT_NEAR(decoded(0x1A4, {0xE8, 0x03, 0, 0, 0, 0, 0, 0})[0].value,
              1000 * robot.imu->gyro.resolution * 57.29577951, 1e-6);
}

TEST(Decode, OmitsValuesThatAShortFrameLacks) {
  EXPECT_THAT(decoded(0x190, {0x37, 0x12, 0x00}), SizeIs(1));
  EXPECT_THAT(decoded(0x190, {}), IsEmpty());
}

TEST(Decode, IgnoresOtherFrames) {
  EXPECT_THAT(decoded(0x7FF, {1, 2}), IsEmpty());
  EXPECT_THAT(decode(default_network(), {.identifier = 0x190, .size = 8, .remote = true}), IsEmpty());
}

}  // namespace
}  // namespace koboshi::bus
