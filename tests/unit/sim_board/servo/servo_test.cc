#include "sim_board/servo/servo.h"

#include <gtest/gtest.h>

#include <cmath>

namespace koboshi::sim_board {
namespace {

constexpr double kRadPerCount = 2.0 * std::numbers::pi / 4096;
constexpr std::int32_t kUnitsPerCount = 256;

TEST(Encoder, RoundsToTheNearestCountOnEitherSideOfZero) {
  Encoder encoder({.bits = 12});
  EXPECT_EQ(encoder.read_counts(0.0), 0);
  EXPECT_EQ(encoder.read_counts(0.49 * kRadPerCount), 0);
  EXPECT_EQ(encoder.read_counts(0.51 * kRadPerCount), 1);
  EXPECT_EQ(encoder.read_counts(-0.49 * kRadPerCount), 0);
  EXPECT_EQ(encoder.read_counts(-0.51 * kRadPerCount), -1);
  EXPECT_EQ(encoder.read_counts(3.0 * 2.0 * std::numbers::pi), 3 * 4096);
}

TEST(Encoder, ShowsItsMountingError) {
  Encoder encoder({.bits = 12, .offset_rad = 10 * kRadPerCount});
  EXPECT_EQ(encoder.read_counts(0.0), 10);
}

TEST(Encoder, GivesPositionsInUnitsOfTheBus) {
  EXPECT_EQ(Encoder({.bits = 12}).position_units(-3), -3 * kUnitsPerCount);
  EXPECT_EQ(Encoder({.bits = 20}).position_units(7), 7);
}

TEST(PositionController, CommandsTheFullSupplyAtItsFullError) {
  const ServoDescription servo{.supply_V = 7.5, .full_voltage_error_rad = 0.25 * std::numbers::pi};
  const PositionController controller(servo);
  EXPECT_NEAR(controller.duty((1 << 20) / 8, 0, 0), 1.0, 1e-12);
  EXPECT_NEAR(controller.duty(0, (1 << 20) / 16, (1 << 20) / 16), -0.5, 1e-12);
}

TEST(PositionController, DampsByTheSpeedOfTheEncoder) {
  const PositionController controller({.supply_V = 5.0, .velocity_gain_V_s_per_rad = 0.5});
  const double one_count_a_period = kRadPerCount / 0.001;
  EXPECT_NEAR(controller.duty(kUnitsPerCount, kUnitsPerCount, 0), -0.1 * one_count_a_period, 1e-12);
}

TEST(Bridge, LimitsItsOutputToTheSupplyAndTheLargestDuty) {
  EXPECT_EQ(Bridge(ServoDescription{}).limit(1.5, 1.0), 1.0);
  const Bridge bridge({.max_duty = 0.9});
  EXPECT_EQ(bridge.limit(-1.5, 1.0), -0.9);
  EXPECT_EQ(bridge.limit(1.5, 0.5), 0.45);
  EXPECT_EQ(bridge.limit(0.3, 0.5), 0.3);
}

ServoTorque driven(Servo& servo, std::int32_t target_units, const JointState& joint = {},
                   double supply_V = 7.5) {
  servo.sense(joint);
  servo.drive(target_units);
  servo.draw(joint);
  return servo.torque(supply_V);
}

TEST(Servo, StallsWithTheWholeSupplyOverItsResistance) {
  JointDescription joint;
  Servo servo(joint);
  const ServoTorque torque = driven(servo, 1 << 18);
  EXPECT_NEAR(torque.drive_Nm, 1.373, 5e-4);  // KONDO's stall torque
  EXPECT_NEAR(torque.damping_Nm_s, 1.0027 * 1.0027 / 5.477 + 0.0033, 1e-12);
  EXPECT_EQ(torque.friction_Nm, 0.0275);
  EXPECT_EQ(torque.rotor_inertia_kg_m2, 0.00116);
  servo.sense({});
  EXPECT_NEAR(servo.current_A(), 7.5 / 5.477, 1e-12);
  EXPECT_NEAR(servo.torque_Nm(), 1.373, 5e-4);
}

TEST(Servo, DrawsLessCurrentTheFasterItTurns) {
  JointDescription joint;
  Servo servo(joint);
  driven(servo, 1 << 18);
  servo.sense({.position_rad = 0.0, .speed_rad_per_s = 7.48});  // no load
  EXPECT_NEAR(servo.current_A(), 0.0, 2e-3);
}

TEST(Servo, AppliesItsDutyToThePresentSupply) {
  JointDescription joint;
  Servo servo(joint);
  const std::int32_t target_units = 1 << 13;  // 0.049 rad, less than half the full error
  const double nominal_Nm = driven(servo, target_units).drive_Nm;
  EXPECT_NEAR(driven(servo, target_units, {}, 6.0).drive_Nm / nominal_Nm, 6.0 / 7.5, 1e-12);
}

TEST(Servo, HasFrictionAndRotorInertiaOnlyWhenReleased) {
  JointDescription joint;
  Servo servo(joint);
  driven(servo, 1 << 18);
  servo.release();
  servo.draw({});
  const ServoTorque torque = servo.torque(7.5);
  EXPECT_EQ(torque.drive_Nm, 0.0);
  EXPECT_EQ(torque.damping_Nm_s, 0.0033);
  EXPECT_EQ(torque.friction_Nm, 0.0275);
  EXPECT_EQ(torque.rotor_inertia_kg_m2, 0.00116);
  servo.sense({.position_rad = 0.0, .speed_rad_per_s = 5.0});
  EXPECT_EQ(servo.current_A(), 0.0);
}

TEST(Servo, MountedInReverseTurnsTheJointBackwards) {
  JointDescription joint;
  joint.drive.sign = -1;
  joint.drive.zero_rad = std::numbers::pi;
  Servo servo(joint);
  const JointState state{.position_rad = 0.5 * std::numbers::pi, .speed_rad_per_s = 1.0};
  EXPECT_LT(driven(servo, (1 << 20) / 2, state).drive_Nm, 0.0);
  EXPECT_EQ(servo.position_units(), (1 << 20) / 4);  // pi - pi/2 of the shaft
  servo.sense(state);
  EXPECT_GT(servo.current_A(), 7.5 / 5.477);  // the shaft turns against its voltage
}

TEST(Servo, MeasuresNoSpeedInItsFirstSample) {
  JointDescription joint;
  joint.servo.velocity_gain_V_s_per_rad = 1.0;
  Servo servo(joint);
  servo.sense({.position_rad = 1.0});
  EXPECT_EQ(driven(servo, servo.position_units(), {.position_rad = 1.0}).drive_Nm, 0.0);
}

}  // namespace
}  // namespace koboshi::sim_board
