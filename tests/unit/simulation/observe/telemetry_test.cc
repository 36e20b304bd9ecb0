#include "simulation/observe/telemetry.h"

#include <gtest/gtest.h>

#include <array>
#include <initializer_list>
#include <numbers>

namespace koboshi::simulation {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Two joints: node 16, and node 17 with reversed sign and an encoder offset of 90 degrees.
robot::RobotModel two_joints() {
  robot::RobotModel model;
  model.joint_count = 2;
  model.joints[0].drive.node_id = 16;
  model.joints[1].drive.node_id = 17;
  model.joints[1].drive.sign = -1;
  model.joints[1].drive.zero = fixed::kQuarterTurn;
  model.scales.ankle_force = fixed::Force::from_raw(100 << 16);  // full scale 100 N
  return model;
}

class TelemetryOfFrames : public testing::Test {
 protected:
  void hear(std::uint16_t identifier, std::uint8_t size, std::array<std::uint8_t, 8> data) {
    reader_.on_bus_frame({.identifier = identifier, .size = size, .remote = false, .data = data}, 0, 100);
  }

  robot::RobotModel model_ = two_joints();
  TelemetryReader reader_{model_};
};

TEST_F(TelemetryOfFrames, ShowsTheStateOfTheController) {
  hear(0x181, 8, {6, 17, 3, 5, 9, 1, 0, 39});
  EXPECT_EQ(reader_.now().state, behaviour::State::kFault);
  EXPECT_EQ(reader_.now().reason, behaviour::Reason::kDriveFault);
  EXPECT_EQ(reader_.now().motion, 3);
  EXPECT_EQ(reader_.now().drive_fault, drive::DriveFault::kLost);
  EXPECT_EQ(reader_.now().faulty_joint, 9);
  EXPECT_EQ(reader_.now().refusal, behaviour::Reason::kVelocityOutOfRange);
}

TEST_F(TelemetryOfFrames, PassesOverRemoteFrames) {
  hear(0x190, 8, {0x37, 0x12, 0, 0, 0x08, 0, 0x10, 0});
  hear(0x181, 8, {6, 17, 3, 5, 9, 1, 0, 39});
  for (const std::uint16_t identifier : std::initializer_list<std::uint16_t>{0x090, 0x181, 0x190})
    reader_.on_bus_frame({.identifier = identifier, .size = 8, .remote = true}, 0, 100);
  EXPECT_EQ(reader_.now().state, behaviour::State::kFault);
  EXPECT_EQ(reader_.now().joints[0].statusword, 0x1237);
  EXPECT_NE(reader_.now().joints[0].position_rad, 0.0);
}

// A remote frame asks for the state, a short one has not all of it.
TEST_F(TelemetryOfFrames, ReadsNoRemoteAndNoShortFrameAsTheState) {
  hear(0x181, 8, {6, 17, 3, 5, 9, 1, 0, 39});
  reader_.on_bus_frame({.identifier = 0x181, .size = 8, .remote = true}, 0, 100);
  reader_.on_bus_frame({.identifier = 0x190, .size = 8, .remote = true}, 0, 100);
  reader_.on_bus_frame({.identifier = 0x091, .size = 8, .remote = true, .data = {1}}, 0, 100);
  hear(0x181, 2, {9, 1});
  EXPECT_EQ(reader_.now().state, behaviour::State::kFault);
  EXPECT_EQ(reader_.now().faulty_joint, 9);
  EXPECT_EQ(reader_.now().emergencies, 0u);
}

TEST_F(TelemetryOfFrames, ShowsAttitudeInRadians) {
  // Roll 2^12 and pitch -2^13, in units of 2^-16 turns; rates 2^10 and -2^11, in units of 2^-12 turns/s.
  hear(0x281, 8, {0x00, 0x10, 0x00, 0xE0, 0x00, 0x04, 0x00, 0xF8});
  EXPECT_NEAR(reader_.now().roll_rad, 22.5 * kDegree, 1e-12);
  EXPECT_NEAR(reader_.now().pitch_rad, -45.0 * kDegree, 1e-12);
  EXPECT_NEAR(reader_.now().rate_rad_per_s[0], 90.0 * kDegree, 1e-12);
  EXPECT_NEAR(reader_.now().rate_rad_per_s[1], -180.0 * kDegree, 1e-12);
}

TEST_F(TelemetryOfFrames, ShowsTheLoadOfEachFoot) {
  hear(0x381, 8, {0x00, 0x40});
  hear(0x481, 8, {0x00, 0xF0});
  EXPECT_NEAR(reader_.now().foot_load_N[0], 50.0, 1e-9);
  EXPECT_NEAR(reader_.now().foot_load_N[1], -12.5, 1e-9);
}

TEST_F(TelemetryOfFrames, ShowsZmpAndCentreOfMassInTheSolesFrames) {
  // Unit 2^-15 m: 0x0400 is 1/32 m.
  hear(0x182, 8, {0x00, 0x04, 0x00, 0xFC, 0x00, 0x02, 0x00, 0xFE});
  hear(0x282, 8, {0x00, 0x01, 0x00, 0xFF, 0x80, 0x00, 0x80, 0xFF});
  hear(0x382, 3, {0x00, 0x18, 0x0E});
  const Telemetry& said = reader_.now();
  EXPECT_FALSE(said.foot_zmp[0].valid);
  EXPECT_EQ(said.foot_zmp[0].x_m, 1.0 / 32);
  EXPECT_EQ(said.foot_zmp[0].y_m, -1.0 / 32);
  EXPECT_TRUE(said.foot_zmp[1].valid);
  EXPECT_EQ(said.foot_zmp[1].x_m, 1.0 / 64);
  EXPECT_EQ(said.foot_zmp[1].y_m, -1.0 / 64);
  EXPECT_TRUE(said.zmp.valid);
  EXPECT_EQ(said.zmp.x_m, 1.0 / 128);
  EXPECT_EQ(said.zmp.y_m, -1.0 / 128);
  EXPECT_EQ(said.zmp.frame, hal::Side::kRight);
  EXPECT_EQ(said.com_S_m, (std::array{1.0 / 256, -1.0 / 256, 3.0 / 16}));
}

// Place in mm, angles in units of 2^-16 turns.
TEST_F(TelemetryOfFrames, ShowsThePlaceAndTheGround) {
  hear(0x202, 7, {0x10, 0x27, 0xF6, 0xFF, 0x00, 0x20, 0x01});
  hear(0x302, 8, {0x00, 0x04, 0x00, 0xFE, 0x80, 0x00, 0xC0, 0xFF});
  const Telemetry::Place& place = reader_.now().place;
  EXPECT_NEAR(place.x_m, 10.0, 1e-12);
  EXPECT_NEAR(place.y_m, -0.01, 1e-12);
  EXPECT_NEAR(place.heading_rad, 45.0 * kDegree, 1e-12);
  EXPECT_TRUE(place.ground_valid);
  EXPECT_NEAR(place.slope_rad[0], 5.625 * kDegree, 1e-12);
  EXPECT_NEAR(place.slope_rad[1], -2.8125 * kDegree, 1e-12);
  EXPECT_NEAR(place.attitude_zero_rad[0], 0.703125 * kDegree, 1e-12);
  EXPECT_NEAR(place.attitude_zero_rad[1], -0.3515625 * kDegree, 1e-12);
  hear(0x202, 7, {0, 0, 0, 0, 0, 0, 0xFE});
  EXPECT_FALSE(reader_.now().place.ground_valid);
}

// Lengths in units of 2^-15 m; each flag by itself.
TEST_F(TelemetryOfFrames, ShowsThePlanAndTheMotionOfTheCentreOfMass) {
  hear(0x482, 8, {0x00, 0x04, 0x00, 0xFC, 0x00, 0x02, 0x00, 0xFE});
  EXPECT_EQ(reader_.now().com_motion.dcm_m, (std::array{1.0 / 32, -1.0 / 32}));
  EXPECT_EQ(reader_.now().com_motion.dcm_error_m, (std::array{1.0 / 64, -1.0 / 64}));
  hear(0x382, 8, {0, 0, 1 << 4, 0x00, 0x01, 0x00, 0xFF, 1 << 0});
  EXPECT_TRUE(reader_.now().planned_zmp.valid);
  EXPECT_EQ(reader_.now().planned_zmp.frame, hal::Side::kLeft);
  EXPECT_EQ(reader_.now().planned_zmp.x_m, 1.0 / 128);
  EXPECT_EQ(reader_.now().planned_zmp.y_m, -1.0 / 128);
  EXPECT_TRUE(reader_.now().com_motion.valid);
  EXPECT_EQ(reader_.now().com_motion.frame, hal::Side::kLeft);
  EXPECT_FALSE(reader_.now().com_motion.compared);
  EXPECT_EQ(reader_.now().com_motion.touches, (std::array{false, false}));
  hear(0x382, 8, {0, 0, 1 << 5, 0, 0, 0, 0, 1 << 1 | 1 << 2 | 1 << 3});
  EXPECT_FALSE(reader_.now().planned_zmp.valid);
  EXPECT_EQ(reader_.now().planned_zmp.frame, hal::Side::kRight);
  EXPECT_FALSE(reader_.now().com_motion.valid);
  EXPECT_EQ(reader_.now().com_motion.frame, hal::Side::kRight);
  EXPECT_TRUE(reader_.now().com_motion.compared);
  EXPECT_EQ(reader_.now().com_motion.touches, (std::array{true, false}));
  hear(0x382, 8, {0, 0, 0, 0, 0, 0, 0, 1 << 4});
  EXPECT_EQ(reader_.now().com_motion.touches, (std::array{false, true}));
}

TEST_F(TelemetryOfFrames, ShowsTargetsAndPositionsAsJointAngles) {
  hear(0x210, 6, {0x0F, 0x00, 0x00, 0x00, 0x02, 0x00});  // 2^17 encoder units: an eighth of a turn
  hear(0x191, 8, {0x37, 0x02, 0x00, 0x00, 0x02, 0x00, 0x64, 0x00});  // shaft at 45 degrees; it reads 90
                                                                     // degrees minus the joint angle
  EXPECT_NEAR(reader_.now().joints[0].target_rad, 45.0 * kDegree, 1e-8);
  EXPECT_NEAR(reader_.now().joints[1].position_rad, 45.0 * kDegree, 1e-8);
  EXPECT_EQ(reader_.now().joints[1].statusword, 0x0237);
  EXPECT_EQ(reader_.now().joints[1].torque_permille, -100.0);
}

TEST_F(TelemetryOfFrames, CountsEmergenciesButNotTheirEnds) {
  hear(0x090, 8, {0x30, 0x81, 0x11});
  hear(0x081, 8, {0x00, 0xFF, 0x81});
  hear(0x090, 8, {0x00, 0x00, 0x00});
  hear(0x0A4, 8, {0x00, 0xFF, 0x81});  // the inertial unit
  hear(0x0E3, 8, {0x00, 0xFF, 0x81});  // node 99, which the robot does not have
  EXPECT_EQ(reader_.now().emergencies, 3u);
}

TEST_F(TelemetryOfFrames, IgnoresUnknownFrames) {
  hear(0x080, 0, {});
  hear(0x1FF, 8, {1, 2, 3, 4, 5, 6, 7, 8});
  hear(0x210, 2, {0x06, 0x00});
  EXPECT_EQ(reader_.now().emergencies, 0u);
  EXPECT_EQ(reader_.now().joints[0].target_rad, 0.0);
}

}  // namespace
}  // namespace koboshi::simulation
