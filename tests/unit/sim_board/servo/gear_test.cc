// A servo behind a stage, against the servo itself at the speed and torque of its own shaft.

#include <gtest/gtest.h>

#include "sim_board/description/servo_types.h"
#include "sim_board/servo/dry_friction.h"

namespace koboshi::sim_board {
namespace {

constexpr double kRatio = 2.5;

class ServoBehindGear : public testing::TestWithParam<const char*> {
 protected:
  const ServoDescription servo_ =
      read_servo_types(KOBOSHI_SOURCE_DIR "/robots/servos/bam.xml").at(GetParam());
  const ServoDescription joint_ = behind_gear(servo_, kRatio);
};

INSTANTIATE_TEST_SUITE_P(, ServoBehindGear, testing::Values("xl_320_m1", "mx_64_m4", "mx_106_m6"));

TEST_P(ServoBehindGear, HasTheTorqueAndSpeedOfTheMotorThroughTheStage) {
  const auto motor_Nm = [](const ServoDescription& servo, double speed_rad_per_s) {
    const double kt = servo.torque_constant_Nm_per_A;
    return kt * (servo.supply_V - kt * speed_rad_per_s) / servo.resistance_ohm -
           servo.viscous_friction_Nm_s * speed_rad_per_s;
  };
  for (const double speed_rad_per_s : {0.0, 0.7, -2.0}) {
    const double expected_Nm = kRatio * motor_Nm(servo_, kRatio * speed_rad_per_s);
    EXPECT_NEAR(motor_Nm(joint_, speed_rad_per_s), expected_Nm, 1e-12);
  }
}

TEST_P(ServoBehindGear, HasItsKineticEnergy) {
  constexpr double kSpeed_rad_per_s = 1.3;
  const double of_servo_J = 0.5 * servo_.rotor_inertia_kg_m2 * std::pow(kRatio * kSpeed_rad_per_s, 2);
  EXPECT_NEAR(0.5 * joint_.rotor_inertia_kg_m2 * std::pow(kSpeed_rad_per_s, 2), of_servo_J, 1e-12);
}

TEST_P(ServoBehindGear, HasItsFrictionThroughTheStage) {
  const DryFriction of_servo(servo_);
  const DryFriction of_joint(joint_);
  for (const double motor_Nm : {-3.0, 0.5, 2.0})
    for (const double external_Nm : {-2.0, 0.0, 2.5})
      for (const double speed_rad_per_s : {0.0, 0.4, -1.5}) {
        const double expected_Nm =
            kRatio * of_servo.bound_Nm(motor_Nm / kRatio, external_Nm / kRatio, kRatio * speed_rad_per_s);
        EXPECT_NEAR(of_joint.bound_Nm(motor_Nm, external_Nm, speed_rad_per_s), expected_Nm, 1e-12);
      }
}

TEST(ServoGear, ScalesAnglesAndGains) {
  const ServoDescription servo{.full_voltage_error_rad = 0.2,
                               .velocity_gain_V_s_per_rad = 0.3,
                               .backlash_rad = 0.01,
                               .command = {.dead_band_rad = 0.004}};
  const ServoDescription joint = behind_gear(servo, 2.0);
  EXPECT_EQ(joint.full_voltage_error_rad, 0.1);
  EXPECT_EQ(joint.velocity_gain_V_s_per_rad, 0.6);
  EXPECT_EQ(joint.backlash_rad, 0.005);
  EXPECT_EQ(joint.command.dead_band_rad, 0.002);
  EXPECT_EQ(joint.supply_V, servo.supply_V);
}

}  // namespace
}  // namespace koboshi::sim_board
