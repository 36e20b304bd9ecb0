#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "sim_board/description/load.h"
#include "sim_board/description/servo_types.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/base/scratch_file.h"
#include "tests/unit/sim_board/description/small_robot.h"

namespace koboshi::sim_board {
namespace {

const char* const kMeters =
    R"(      <voltmeter lowest_V="0" highest_V="15" resolution_V="0.02" noise_V="0.01" offset_V="0.03" scale_error="0.04"/>
      <thermometer lowest_C="-40" highest_C="125" resolution_K="0.5" noise_K="0.2" offset_K="2" sample_period_s="0.1"/>
)";

std::string with_effects(const std::string& from, const std::string& to) {
  return replaced(with(kServoNumbers, kServoNumbers + kServoEffects + kMeters), from, to);
}

TEST(LoadServo, ReadsTheEffectsOfAServo) {
  const ScratchFile scratch("sdf",
                            with_effects("<link name=\"hand\">", R"(<koboshi:battery open_circuit_V="7.8"
      internal_resistance_ohm="0.05"/><link name="hand">)"));
  const RobotDescription robot = load_robot(scratch.path());
  const ServoDescription& servo = robot.joints.at(0).servo;
  EXPECT_EQ(servo.max_duty, 0.9);
  EXPECT_EQ(servo.current_limit_A, 1.5);
  EXPECT_EQ(servo.stribeck.friction_Nm, 0.02);
  EXPECT_EQ(servo.stribeck.speed_rad_per_s, 2.0);
  EXPECT_EQ(servo.stribeck.exponent, 1.7);
  EXPECT_EQ(servo.load_friction.motor, 0.1);
  EXPECT_EQ(servo.load_friction.external, 0.2);
  EXPECT_EQ(servo.stribeck_load_friction.motor, 0.3);
  EXPECT_EQ(servo.stribeck_load_friction.external, 0.4);
  EXPECT_EQ(servo.quadratic_load_friction_per_Nm.motor, 0.01);
  EXPECT_EQ(servo.quadratic_load_friction_per_Nm.external, 0.02);
  EXPECT_EQ(servo.backlash_rad, 0.01);
  ASSERT_TRUE(servo.winding);
  EXPECT_EQ(servo.winding->thermal_resistance_K_per_W, 10.0);
  EXPECT_EQ(servo.winding->heat_capacity_J_per_K, 5.0);
  EXPECT_EQ(servo.winding->ambient_C, 20.0);
  EXPECT_EQ(servo.winding->derating_C, 70.0);
  EXPECT_EQ(servo.winding->shutdown_C, 90.0);
  EXPECT_EQ(servo.winding->derated_share, 0.3);
  EXPECT_EQ(servo.winding->copper_per_K, 0.004);
  EXPECT_EQ(servo.command.period_ms, 10);
  EXPECT_EQ(servo.command.write_delay_ms, 2);
  EXPECT_EQ(servo.command.read_delay_ms, 3);
  EXPECT_EQ(servo.command.dead_band_rad, 0.004);
  ASSERT_TRUE(servo.voltmeter);
  EXPECT_EQ(servo.voltmeter->lowest, 0.0);
  EXPECT_EQ(servo.voltmeter->highest, 15.0);
  EXPECT_EQ(servo.voltmeter->resolution, 0.02);
  EXPECT_EQ(servo.voltmeter->noise, 0.01);
  EXPECT_EQ(servo.voltmeter->offset, 0.03);
  EXPECT_EQ(servo.voltmeter->scale_error, 0.04);
  EXPECT_EQ(servo.voltmeter->sample_period_s, 0.01);
  ASSERT_TRUE(servo.thermometer);
  EXPECT_EQ(servo.thermometer->lowest, -40.0);
  EXPECT_EQ(servo.thermometer->highest, 125.0);
  EXPECT_EQ(servo.thermometer->resolution, 0.5);
  EXPECT_EQ(servo.thermometer->noise, 0.2);
  EXPECT_EQ(servo.thermometer->offset, 2.0);
  EXPECT_EQ(servo.thermometer->sample_period_s, 0.1);
  ASSERT_TRUE(robot.battery);
  EXPECT_EQ(robot.battery->open_circuit_V, 7.8);
  EXPECT_EQ(robot.battery->internal_resistance_ohm, 0.05);
}

TEST(LoadServo, HasOnlyTheEffectsOfItsFile) {
  const ScratchFile scratch("sdf", kSmallRobot);
  const RobotDescription robot = load_robot(scratch.path());
  const ServoDescription& servo = robot.joints.at(0).servo;
  EXPECT_FALSE(robot.battery);
  EXPECT_FALSE(servo.winding);
  EXPECT_FALSE(servo.voltmeter);
  EXPECT_FALSE(servo.thermometer);
  EXPECT_EQ(servo.backlash_rad, 0.0);
  EXPECT_EQ(servo.max_duty, 1.0);
  EXPECT_TRUE(std::isinf(servo.current_limit_A));
  EXPECT_EQ(robot.joints.at(0).encoder.noise_counts, 0.0);
}

TEST(LoadServo, RejectsImpossibleEffects) {
  EXPECT_EQ(complaint(with_effects("friction_Nm=\"0.02\"", "friction_Nm=\"-1\"")),
            "FILE:13: found friction_Nm = -1, expected a number from 0 to 100");
  EXPECT_EQ(complaint(with_effects("load_friction motor=\"0.1\"", "load_friction motor=\"1\"")),
            "FILE:14: found motor = 1, expected a number from 0 to 0.99");
  EXPECT_EQ(complaint(with_effects("period_ms=\"10\"", "period_ms=\"0.5\"")),
            "FILE:20: found period_ms = 0.5, expected a whole number from 1 to 100");
  EXPECT_EQ(complaint(with_effects("<backlash_rad>0.01", "<backlash_rad>1")),
            "FILE:17: found <backlash_rad> = 1, expected a number from 0 to 0.5 in rad; did you mean 1 deg?");
  EXPECT_EQ(complaint(with_effects("derating_C=\"70\"", "derating_C=\"95\"")),
            "FILE:18: found ambient_C = 20, derating_C = 95 and shutdown_C = 90, expected each above the one "
            "before");
  EXPECT_EQ(complaint(with_effects("<rotor_inertia_kg_m2>0.001", "<rotor_inertia_kg_m2>0")),
            "FILE:17: found backlash_rad = 0.01 with rotor_inertia_kg_m2 = 0, "
            "expected a rotor with inertia, which moves within its backlash");
  EXPECT_EQ(complaint(with_effects("highest_V=\"15\"", "highest_V=\"-1\"")),
            "FILE:21: found lowest_V = 0 and highest_V = -1, expected the highest above the lowest");
  EXPECT_EQ(complaint(with_effects("resolution_K=\"0.5\"", "resolution_K=\"0\"")),
            "FILE:22: found resolution_K = 0, expected a number from 1e-06 to 100");
}

const char* const kLibrary = R"(<koboshi:servo_types xmlns:koboshi="https://koboshi.invalid/sdf">
  <koboshi:servo_type name="large">
    <torque_constant_Nm_per_A>2</torque_constant_Nm_per_A>
    <resistance_ohm>3</resistance_ohm>
    <supply_V>15</supply_V>
    <rotor_inertia_kg_m2>0.02</rotor_inertia_kg_m2>
    <coulomb_friction_Nm>0.1</coulomb_friction_Nm>
    <viscous_friction_Nm_s>0.05</viscous_friction_Nm_s>
    <full_voltage_error_rad>0.2</full_voltage_error_rad>
  </koboshi:servo_type>
</koboshi:servo_types>
)";

TEST(LoadServo, ImportsServoTypesFromALibrary) {
  const koboshi::test::TemporaryFolder folder;
  koboshi::test::write_file(folder.path / "library.xml", kLibrary);
  const std::string take = "<koboshi:servo_types file=\"library.xml\"/><link name=\"hand\">";
  koboshi::test::write_file(folder.path / "robot.sdf",
                            replaced(with("type=\"small\"", "type=\"large\""), "<link name=\"hand\">", take));
  EXPECT_EQ(load_robot(folder.path / "robot.sdf").joints.at(0).servo.supply_V, 15.0);
  const ServoTypes types = read_servo_types(folder.path / "robot.sdf");
  EXPECT_EQ(types.size(), 2u);
  EXPECT_EQ(types.at("small").supply_V, 7.5);
}

TEST(LoadServo, RejectsAMissingServoLibrary) {
  EXPECT_EQ(
      complaint(with("<link name=\"hand\">", "<koboshi:servo_types file='no.xml'/><link name=\"hand\">")),
      "FILE:12: found file = no.xml, "
      "expected a library of servo types that exists, relative to this file's folder");
}

TEST(ServoTypes, AreReadFromALibraryAlone) {
  const ScratchFile library("xml", kLibrary);
  const ServoTypes types = read_servo_types(library.path());
  ASSERT_EQ(types.size(), 1u);
  EXPECT_EQ(types.at("large").torque_constant_Nm_per_A, 2.0);
}

TEST(ServoTypes, OfBamAreComplete) {
  const ServoTypes types =
      read_servo_types(std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/servos/bam.xml");
  EXPECT_EQ(types.size(), 9u);
  // M1 knows no load, M4 does not know from which side it comes, M6 does.
  EXPECT_EQ(types.at("xl_320_m1").load_friction.motor, 0.0);
  EXPECT_EQ(types.at("mx_106_m4").stribeck_load_friction.motor,
            types.at("mx_106_m4").stribeck_load_friction.external);
  EXPECT_GT(types.at("mx_106_m6").load_friction.motor, types.at("mx_106_m6").load_friction.external);
  EXPECT_GT(types.at("mx_106_m6").quadratic_load_friction_per_Nm.motor, 0.0);
}

}  // namespace
}  // namespace koboshi::sim_board
