#include "sim_board/robot/load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sim_board/input/error.h"
#include "sim_board/robot/servo_types.h"
#include "tests/unit/sim_board/input/scratch_file.h"

namespace koboshi::sim {
namespace {

using testing::MatchesRegex;
using testing::StartsWith;

// Two links and a hinge, with frames that take some turning.
const char* const kSmallRobot = R"(<sdf version="1.9" xmlns:koboshi="https://koboshi.invalid/sdf">
  <model name="arm">
    <koboshi:servo_type name="small">
      <torque_constant_Nm_per_A>1</torque_constant_Nm_per_A>
      <resistance_ohm>5</resistance_ohm>
      <supply_V>7.5</supply_V>
      <rotor_inertia_kg_m2>0.001</rotor_inertia_kg_m2>
      <coulomb_friction_Nm>0.02</coulomb_friction_Nm>
      <viscous_friction_Nm_s>0.003</viscous_friction_Nm_s>
      <full_voltage_error_rad>0.1</full_voltage_error_rad>
    </koboshi:servo_type>
    <link name="hand">
      <pose relative_to="base">0 0 0.1 0 0 1.5707963267948966</pose>
      <inertial>
        <pose>0 0 0.05 0 0 0</pose>
        <mass>0.1</mass>
        <inertia><ixx>2e-4</ixx><iyy>3e-4</iyy><izz>4e-4</izz></inertia>
      </inertial>
      <collision name="box">
        <pose>0 0 0.05 0 0 0</pose>
        <geometry><box><size>0.02 0.03 0.1</size></box></geometry>
        <surface>
          <friction><ode><mu>0.7</mu><fdir1>0 1 0</fdir1></ode></friction>
          <bounce><restitution_coefficient>0.3</restitution_coefficient><threshold>0.05</threshold></bounce>
          <contact><ode><soft_cfm>2e-5</soft_cfm><soft_erp>0.4</soft_erp></ode></contact>
          <koboshi:reference_step_s>0.002</koboshi:reference_step_s>
          <koboshi:material>rubber</koboshi:material>
        </surface>
      </collision>
    </link>
    <link name="base">
      <pose>1 2 3 0 0 0</pose>
      <inertial>
        <mass>0.2</mass>
        <inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia>
      </inertial>
    </link>
    <joint name="wrist" type="revolute">
      <parent>base</parent>
      <child>hand</child>
      <axis>
        <xyz>1 0 0</xyz>
        <limit><lower>-1</lower><upper>2</upper><velocity>7</velocity></limit>
      </axis>
      <koboshi:servo type="small"/>
      <koboshi:encoder bits="14" offset_rad="0.01"/>
      <koboshi:drive node_id="17" serial_number="4294967295" sign="-1" zero_rad="0.5"/>
    </joint>
  </model>
</sdf>
)";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kSmallRobot;
  const auto place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text.replace(place, from.size(), to);
}

// What loading `text` complains about, with the file's name as FILE; "nothing" if it does not.
std::string complaint(const std::string& text) {
  const ScratchFile scratch("sdf", text);
  try {
    load_robot(scratch.path());
  } catch (const InputError& error) {
    std::string message = error.what();
    if (message.starts_with(scratch.path().string()))
      message.replace(0, scratch.path().string().size(), "FILE");
    return message;
  }
  return "nothing";
}

TEST(LoadRobot, ReadsEveryNumber) {
  const ScratchFile scratch("sdf", kSmallRobot);
  const RobotDescription robot = load_robot(scratch.path());
  EXPECT_EQ(robot.name, "arm");
  ASSERT_EQ(robot.links.size(), 2u);
  EXPECT_EQ(robot.links[0].name, "base");
  EXPECT_DOUBLE_EQ(robot.total_mass_kg(), 0.3);

  const LinkDescription& hand = robot.links[1];
  EXPECT_TRUE(hand.X_ML.translation().isApprox(Eigen::Vector3d(1, 2, 3.1)));
  EXPECT_TRUE((hand.X_ML.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_EQ(hand.p_LCom_L, Eigen::Vector3d(0, 0, 0.05));
  EXPECT_TRUE(hand.I_LCom_L.diagonal().isApprox(Eigen::Vector3d(2e-4, 3e-4, 4e-4)));
  const BoxDescription& box = hand.collisions.at(0);
  EXPECT_EQ(box.size_m, Eigen::Vector3d(0.02, 0.03, 0.1));
  EXPECT_EQ(box.surface.friction, 0.7);
  EXPECT_EQ(box.surface.friction_second, 0.7);
  EXPECT_EQ(box.surface.bounce, 0.3);
  EXPECT_EQ(box.surface.bounce_threshold_m_per_s, 0.05);
  EXPECT_EQ(box.surface.error_reduction, 0.4);
  EXPECT_EQ(box.surface.constraint_force_mixing, 2e-5);
  EXPECT_EQ(box.surface.reference_step_s, 0.002);
  EXPECT_EQ(box.surface.friction_direction, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(box.surface.material, "rubber");

  const JointDescription& wrist = robot.joints.at(0);
  EXPECT_EQ(wrist.parent, 0);
  EXPECT_EQ(wrist.child, 1);
  EXPECT_TRUE(wrist.p_MJ.isApprox(Eigen::Vector3d(1, 2, 3.1)));
  EXPECT_TRUE(wrist.axis_M.isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_EQ(wrist.lower_rad, -1);
  EXPECT_EQ(wrist.upper_rad, 2);
  EXPECT_EQ(wrist.max_speed_rad_per_s, 7);
  EXPECT_EQ(wrist.servo.resistance_ohm, 5);
  EXPECT_EQ(wrist.encoder.bits, 14);
  EXPECT_EQ(wrist.encoder.offset_rad, 0.01);
  EXPECT_EQ(wrist.drive.node_id, 17);
  EXPECT_EQ(wrist.drive.serial_number, 4294967295u);
  EXPECT_EQ(wrist.drive.sign, -1);
  EXPECT_EQ(wrist.drive.zero_rad, 0.5);
}

const char* const kEffects = R"(<full_voltage_error_rad>0.1</full_voltage_error_rad>
      <max_duty>0.9</max_duty>
      <current_limit_A>1.5</current_limit_A>
      <stribeck friction_Nm="0.02" speed_rad_per_s="2" exponent="1.7"/>
      <load_friction motor="0.1" external="0.2"/>
      <stribeck_load_friction motor="0.3" external="0.4"/>
      <quadratic_load_friction motor_per_Nm="0.01" external_per_Nm="0.02"/>
      <backlash_rad>0.01</backlash_rad>
      <winding thermal_resistance_K_per_W="10" heat_capacity_J_per_K="5" ambient_C="20" derating_C="70" shutdown_C="90"
               derated_share="0.3" copper_per_K="0.004"/>
      <command period_ms="10" write_delay_ms="2" read_delay_ms="3" dead_band_rad="0.004"/>)";

std::string with_effects(const std::string& from, const std::string& to) {
  std::string text = with("<full_voltage_error_rad>0.1</full_voltage_error_rad>", kEffects);
  const auto place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text.replace(place, from.size(), to);
}

TEST(LoadRobot, ReadsTheEffectsOfAServo) {
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
  ASSERT_TRUE(robot.battery);
  EXPECT_EQ(robot.battery->open_circuit_V, 7.8);
  EXPECT_EQ(robot.battery->internal_resistance_ohm, 0.05);
}

TEST(LoadRobot, HasNoEffectThatItsFileDoesNotName) {
  const ScratchFile scratch("sdf", kSmallRobot);
  const RobotDescription robot = load_robot(scratch.path());
  const ServoDescription& servo = robot.joints.at(0).servo;
  EXPECT_FALSE(robot.battery);
  EXPECT_FALSE(servo.winding);
  EXPECT_EQ(servo.backlash_rad, 0.0);
  EXPECT_EQ(servo.max_duty, 1.0);
  EXPECT_TRUE(std::isinf(servo.current_limit_A));
  EXPECT_EQ(robot.joints.at(0).encoder.noise_counts, 0.0);
}

TEST(LoadRobot, RefusesEffectsThatCannotBe) {
  EXPECT_EQ(complaint(with_effects("friction_Nm=\"0.02\"", "friction_Nm=\"-1\"")),
            "FILE:13: found friction_Nm = -1, expected a number from 0 to 100");
  EXPECT_EQ(complaint(with_effects("load_friction motor=\"0.1\"", "load_friction motor=\"1\"")),
            "FILE:14: found motor = 1, expected a number from 0 to 0.99");
  EXPECT_EQ(complaint(with_effects("period_ms=\"10\"", "period_ms=\"0.5\"")),
            "FILE:20: found period_ms = 0.5, expected a whole number from 1 to 100");
  EXPECT_EQ(complaint(with_effects("<backlash_rad>0.01", "<backlash_rad>1")),
            "FILE:17: found <backlash_rad> = 1, expected a number from 0 to 0.5");
  EXPECT_EQ(complaint(with_effects("derating_C=\"70\"", "derating_C=\"95\"")),
            "FILE:18: found ambient_C = 20, derating_C = 95 and shutdown_C = 90, expected each above the one "
            "before");
  EXPECT_EQ(complaint(with_effects("<rotor_inertia_kg_m2>0.001", "<rotor_inertia_kg_m2>0")),
            "FILE:17: found backlash_rad = 0.01 with rotor_inertia_kg_m2 = 0, "
            "expected a rotor with inertia, which moves within its backlash");
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

TEST(LoadRobot, TakesServoTypesOverFromALibrary) {
  const ScratchFile library("xml", kLibrary);
  const std::string take =
      "<koboshi:servo_types file=\"" + library.path().filename().string() + "\"/><link name=\"hand\">";
  std::string text = with("type=\"small\"", "type=\"large\"");
  const std::string link = "<link name=\"hand\">";
  const ScratchFile scratch("sdf", text.replace(text.find(link), link.size(), take));
  EXPECT_EQ(load_robot(scratch.path()).joints.at(0).servo.supply_V, 15.0);
  const ServoTypes types = read_servo_types(scratch.path());
  EXPECT_EQ(types.size(), 2u);
  EXPECT_EQ(types.at("small").supply_V, 7.5);
}

TEST(LoadRobot, RefusesAServoLibraryThatIsNotThere) {
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

TEST(ServoTypes, OfBamAreAllThere) {
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

TEST(LoadRobot, TurnsInertiasIntoTheAxesOfTheLink) {
  const ScratchFile scratch("sdf", with("<pose>0 0 0.05 0 0 0</pose>\n        <mass>",
                                        "<pose>0 0 0.05 1.5707963267948966 0 0</pose>\n        <mass>"));
  const RobotDescription robot = load_robot(scratch.path());
  EXPECT_TRUE(robot.links[1].I_LCom_L.diagonal().isApprox(Eigen::Vector3d(2e-4, 4e-4, 3e-4)));
}

TEST(LoadRobot, RefusesFilesThatAreNoRobot) {
  EXPECT_EQ(complaint(""), "FILE: found XML error: empty document, expected well-formed XML");
  EXPECT_EQ(complaint("<robot name='urdf'/>"), "FILE:1: found <robot>, expected <sdf>");
  EXPECT_EQ(complaint("<sdf version='1.9'/>"), "FILE:1: found <sdf> without <model>, expected that element");
  EXPECT_EQ(complaint(with("\"1.9\"", "\"1.6\"")), "FILE:1: found SDF version 1.6, expected 1.9");
  EXPECT_EQ(complaint(with("<mass>0.1</mass>", "<mass>0.1</mas>")),
            "FILE:16: found XML error: mismatched element, expected well-formed XML");
  EXPECT_THROW(load_robot("no/such.sdf"), InputError);
}

TEST(LoadRobot, RefusesUnknownDoubledAndMissingElements) {
  EXPECT_EQ(complaint(with("<mass>0.1</mass>", "<mass>0.1</mass><colour/>")),
            "FILE:16: found the unknown element <colour> in <inertial>, expected pose, mass or inertia");
  EXPECT_EQ(complaint(with("<mass>0.1</mass>", "<mass>0.1</mass>\n<mass>0.2</mass>")),
            "FILE:17: found a second <mass> (the first is in line 16), expected one in <inertial>");
  EXPECT_EQ(complaint(with("<mass>0.1</mass>", "")),
            "FILE:14: found <inertial> without <mass>, expected that element");
  EXPECT_THAT(complaint(with("sign=", "sing=")),
              StartsWith("FILE:47: found the unknown attribute sing of <koboshi:drive>, expected node_id, "));
  EXPECT_EQ(complaint(with(" node_id=\"17\"", "")),
            "FILE:47: found <koboshi:drive> without node_id, expected that attribute");
  EXPECT_EQ(complaint(with("<koboshi:servo type=\"small\"/>", "")),
            "FILE:38: found <joint> without <koboshi:servo>, expected that element");
  EXPECT_EQ(complaint(with("<box><size>0.02 0.03 0.1</size></box>", "<sphere><radius>1</radius></sphere>")),
            "FILE:21: found the unknown element <sphere> in <geometry>, expected box");
}

TEST(LoadRobot, RefusesBadNumbers) {
  EXPECT_EQ(complaint(with("<mass>0.1", "<mass>-0.1")),
            "FILE:16: found <mass> = -0.1, expected a number from 1e-06 to 1000");
  EXPECT_EQ(complaint(with("<mass>0.1", "<mass>nan")),
            "FILE:16: found <mass> = nan, expected a number from 1e-06 to 1000");
  EXPECT_EQ(complaint(with("0.02 0.03 0.1", "0.02 0.03")),
            "FILE:21: found <size> = 0.02 0.03, expected 3 times a number from 1e-04 to 10");
  EXPECT_EQ(complaint(with("node_id=\"17\"", "node_id=\"128\"")),
            "FILE:47: found node_id = 128, expected a whole number from 1 to 127");
  EXPECT_EQ(complaint(with("sign=\"-1\"", "sign=\"0\"")), "FILE:47: found sign = 0, expected 1 or -1");
}

TEST(LoadRobot, RefusesBodiesThatCannotBe) {
  EXPECT_EQ(complaint(with("<izz>4e-4</izz>", "<izz>6e-4</izz>")),
            "FILE:17: found principal moments 2e-04, 3e-04 and 6e-04 kg m^2 in link hand, "
            "expected none greater than the sum of the others");
  EXPECT_THAT(complaint(with("<izz>4e-4</izz>", "<izz>4e-4</izz><ixy>3e-4</ixy>")),
              MatchesRegex("FILE:17: found principal moments -.*, expected positive ones"));
}

TEST(LoadRobot, RefusesJointsThatCannotBe) {
  EXPECT_EQ(complaint(with("\"revolute\"", "\"prismatic\"")),
            "FILE:38: found joint wrist of type prismatic, expected revolute");
  EXPECT_EQ(complaint(with("<xyz>1 0 0", "<xyz>1 0 0.1")),
            "FILE:42: found <xyz> = 1 0 0.1, of length 1.004987562112089, expected a unit vector");
  EXPECT_EQ(complaint(with("<lower>-1", "<lower>3")),
            "FILE:43: found lower 3 and upper 2, expected lower below upper");
  EXPECT_EQ(complaint(with("<lower>-1", "<lower>-2.8")),
            "FILE:47: found a shaft at 3.3 rad where joint wrist is at -2.8, "
            "expected less than half a turn to either side");
  EXPECT_EQ(complaint(with("type=\"small\"", "type=\"large\"")),
            "FILE:45: found type = large, expected the name of a koboshi:servo_type");
  EXPECT_EQ(complaint(with("<parent>base", "<parent>bass")),
            "FILE:39: found <parent> = bass, expected the name of a link");
}

// The hinge of kSmallRobot once more, between other links.
std::string another_joint(const std::string& name, const std::string& parent, const std::string& child,
                          int node_id) {
  std::string text = kSmallRobot;
  const auto begin = text.find("<joint");
  text = text.substr(begin, text.find("</joint>") + 8 - begin);
  const auto replace = [&text](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("wrist", name);
  replace("<parent>base", "<parent>" + parent);
  replace("<child>hand", "<child>" + child);
  replace("\"17\"", "\"" + std::to_string(node_id) + "\"");
  return text + "\n";
}

std::string another_link(const std::string& name) {
  return "<link name='" + name +
         "'><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></"
         "link>\n";
}

TEST(LoadRobot, RefusesWhatIsNoTree) {
  EXPECT_EQ(complaint(with("</model>", another_joint("elbow", "base", "hand", 18) + "</model>")),
            "FILE:49: found a second joint that moves link hand, expected one joint a link");
  EXPECT_EQ(
      complaint(with("</model>", another_joint("elbow", "hand", "base", 18) + "</model>")),
      "FILE:2: found no link that is no joint's child, expected a base from which the joints make a tree");
  EXPECT_EQ(complaint(with("</model>", another_link("lost") + "</model>")),
            "FILE:49: found link lost, no joint's child, expected only base to be that");
  EXPECT_EQ(
      complaint(with("</model>", another_link("a") + another_link("b") + another_joint("j", "a", "b", 18) +
                                     another_joint("k", "b", "a", 19) + "</model>")),
      "FILE:49: found link a in a ring of joints, expected a tree from base");
}

TEST(LoadRobot, RefusesNamesAndNodesUsedTwice) {
  EXPECT_EQ(complaint(with("</model>", another_link("hand") + "</model>")),
            "FILE:49: found a second hand, expected each name once");
  EXPECT_EQ(complaint(with("</model>", another_link("wrist") + "</model>")),
            "FILE:38: found a second wrist, expected each name once");
  EXPECT_EQ(complaint(with("</model>",
                           another_link("tip") + another_joint("elbow", "hand", "tip", 17) + "</model>")),
            "FILE:59: found a second node_id 17, expected each node id once");
}

TEST(LoadRobot, RefusesPosesThatHangInTheAir) {
  EXPECT_EQ(complaint(with("relative_to=\"base\"", "relative_to=\"moon\"")),
            "FILE:13: found relative_to = moon, expected the name of a link or joint");
  EXPECT_EQ(complaint(with("<xyz>", "<xyz expressed_in=\"moon\">")),
            "FILE:42: found expressed_in = moon, expected the name of a link or joint");
  EXPECT_THAT(complaint(with("relative_to=\"base\"", "relative_to=\"hand\"")),
              MatchesRegex("FILE:[0-9]+: found .*, expected a model that libsdformat accepts"));
}

TEST(LoadRobot, RefusesMeshesThatAreNotThere) {
  EXPECT_EQ(
      complaint(with(
          "<collision name",
          "<visual name='v'><geometry><mesh><uri>no.stl</uri></mesh></geometry></visual>\n<collision name")),
      "FILE:19: found <uri> = no.stl, expected a mesh file that exists, relative to this file's folder");
}

// The file of the default robot, its meshes where they are.
std::string default_robot_text() {
  const auto folder = std::filesystem::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi";
  std::ostringstream text;
  text << std::ifstream(folder / "robot.sdf").rdbuf();
  std::string changed = text.str();
  for (auto place = changed.find("meshes/"); place != std::string::npos;
       place = changed.find("meshes/", place + 1)) {
    const std::string absolute = (folder / "meshes/").string();
    changed.replace(place, 7, absolute);
    place += absolute.size();
  }
  return changed;
}

std::string sensor_complaint(const std::string& from, const std::string& to) {
  std::string text = default_robot_text();
  return complaint(text.replace(text.find(from), from.size(), to));
}

TEST(LoadRobot, RefusesAFrictionWithoutDirectionOrMaterialWithoutName) {
  EXPECT_THAT(complaint(with("0 1 0</fdir1>", "0 0 0</fdir1>")),
              MatchesRegex("FILE:[0-9]+: found <fdir1> = 0 0 0, expected a direction, any but zero"));
  EXPECT_THAT(complaint(with("0 1 0</fdir1>", "0 2 0</fdir1>")),
              MatchesRegex("FILE:[0-9]+: .*from -1 to 1.*"));
  EXPECT_THAT(complaint(with(">rubber<", "><")), MatchesRegex("FILE:[0-9]+: .*koboshi:material.*"));
}

TEST(LoadRobot, RefusesSensorsItCannotSimulate) {
  EXPECT_EQ(sensor_complaint("koboshi", "koboshi"), "nothing");
  EXPECT_THAT(sensor_complaint("type=\"imu\"", "type=\"sonar\""),
              MatchesRegex("FILE:[0-9]+: found a sensor of type sonar, expected imu"));
  EXPECT_THAT(
      sensor_complaint("child_to_parent", "parent_to_child"),
      MatchesRegex("FILE:[0-9]+: found <measure_direction> = parent_to_child, expected child_to_parent"));
  EXPECT_THAT(sensor_complaint("<frame>sensor", "<frame>parent"),
              MatchesRegex("FILE:[0-9]+: found <frame> = parent, expected sensor"));
  EXPECT_THAT(sensor_complaint("\"right_ankle\"", "\"left_ankle\""),
              MatchesRegex("FILE:[0-9]+: found a second sensor left_ankle, expected one"));
  EXPECT_THAT(sensor_complaint("<range>17.4533", "<range>174.533"),
              MatchesRegex(
                  "FILE:[0-9]+: found <koboshi:gyro> of range 174.533 .*, expected counts that fit 16 bits"));
}

// Gives an optional element of a sensor a value, whether the text has it or not: in front of `place`.
void set_sensor_error(std::string& text, const std::string& place, const std::string& name,
                      const std::string& value) {
  const std::string end = "</" + name + ">";
  const auto present = text.find("<" + name + ">");
  if (present != std::string::npos) text.erase(present, text.find(end, present) + end.size() - present);
  text.insert(text.find(place), "<" + name + ">" + value + end);
}

std::string error_complaint(const std::string& place, const std::string& name, const std::string& value) {
  std::string text = default_robot_text();
  set_sensor_error(text, place, name, value);
  return complaint(text);
}

TEST(LoadRobot, ReadsTheErrorsOfSensors) {
  std::string text = default_robot_text();
  const std::string gyro = "<bandwidth_Hz>98";  // the first in the file
  set_sensor_error(text, gyro, "bias_instability", "3e-5");
  set_sensor_error(text, gyro, "random_walk", "1e-6");
  set_sensor_error(text, gyro, "scale_error", "0.04");
  set_sensor_error(text, gyro, "cross_axis", "0.05");
  set_sensor_error(text, gyro, "g_sensitivity", "2e-4");
  set_sensor_error(text, "<koboshi:gyro>", "koboshi:jitter_s", "2e-5");
  set_sensor_error(text, "<force_torque>", "koboshi:crosstalk", "0.07");
  const ScratchFile scratch("sdf", text);
  const RobotDescription robot = load_robot(scratch.path());
  EXPECT_EQ(robot.imu->gyro.bias_instability, 3e-5);
  EXPECT_EQ(robot.imu->gyro.random_walk, 1e-6);
  EXPECT_EQ(robot.imu->gyro.scale_error, 0.04);
  EXPECT_EQ(robot.imu->gyro.cross_axis, 0.05);
  EXPECT_EQ(robot.imu->g_sensitivity, 2e-4);
  EXPECT_EQ(robot.imu->gyro.jitter_s, 2e-5);
  EXPECT_EQ(robot.imu->accelerometer.jitter_s, 2e-5);
  EXPECT_EQ(robot.left_ankle->crosstalk, 0.07);
  EXPECT_EQ(robot.left_ankle->force.jitter_s, 0.0);
}

TEST(LoadRobot, NamesFieldValueAndRangeOfBadSensorErrors) {
  const std::string gyro = "<bandwidth_Hz>98";  // the first in the file
  const std::string ankle = "<force_torque>";
  for (const char* name : {"koboshi:jitter_s", "koboshi:crosstalk"}) {
    EXPECT_THAT(error_complaint(ankle, name, "-1"), MatchesRegex("FILE:[0-9]+: found <" + std::string(name) +
                                                                 "> = -1, expected a number from 0 to 0.5"));
  }
  for (const char* name : {"bias_instability", "random_walk"}) {
    EXPECT_THAT(error_complaint(gyro, name, "-1"), MatchesRegex("FILE:[0-9]+: found <" + std::string(name) +
                                                                "> = -1, expected a number of 0 or more"));
  }
  for (const char* name : {"scale_error", "cross_axis"}) {
    EXPECT_THAT(error_complaint(gyro, name, "0.6"), MatchesRegex("FILE:[0-9]+: found <" + std::string(name) +
                                                                 "> = 0.6, expected a number from 0 to 0.5"));
  }
  EXPECT_THAT(error_complaint(gyro, "g_sensitivity", "2"),
              MatchesRegex("FILE:[0-9]+: found <g_sensitivity> = 2, expected a number from 0 to 1"));
  EXPECT_THAT(error_complaint("<koboshi:gyro>", "koboshi:jitter_s", "0.0005"),
              MatchesRegex("FILE:[0-9]+: found <koboshi:jitter_s> = 5e-04, expected less than half the "
                           "sampling period, 5e-04"));
  EXPECT_THAT(error_complaint("<koboshi:gyro>", "koboshi:crosstalk", "0.01"),
              MatchesRegex("FILE:[0-9]+: found the unknown element <koboshi:crosstalk> in <sensor>.*"));
}

}  // namespace
}  // namespace koboshi::sim
