#include "sim_board/description/load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "tests/unit/base/scratch_file.h"
#include "tests/unit/sim_board/description/small_robot.h"

namespace koboshi::sim_board {
namespace {

using testing::MatchesRegex;
using testing::StartsWith;

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

TEST(LoadRobot, RotatesInertiasIntoTheAxesOfTheLink) {
  const ScratchFile scratch("sdf", with("<pose>0 0 0.05 0 0 0</pose>\n        <mass>",
                                        "<pose>0 0 0.05 1.5707963267948966 0 0</pose>\n        <mass>"));
  const RobotDescription robot = load_robot(scratch.path());
  EXPECT_TRUE(robot.links[1].I_LCom_L.diagonal().isApprox(Eigen::Vector3d(2e-4, 4e-4, 3e-4)));
}

TEST(LoadRobot, RejectsFilesThatAreNotARobot) {
  EXPECT_EQ(complaint(""), "FILE:1: found an empty file, expected an XML element");
  EXPECT_THAT(complaint("<robot name='urdf'/>"),
              StartsWith("FILE:1: found a URDF, expected a robot.sdf; make it with: koboshi model import "));
  EXPECT_EQ(complaint("<world name='flat'/>"), "FILE:1: found <world>, expected <sdf>");
  EXPECT_EQ(complaint("<sdf version='1.9'/>"), "FILE:1: found <sdf> without <model>, expected that element");
  EXPECT_EQ(complaint(with("\"1.9\"", "\"1.4\"")),
            "FILE:1: found version = 1.4, expected 1.5, 1.6, 1.7, 1.8 or 1.9");
  EXPECT_EQ(complaint(with("<mass>0.1</mass>", "<mass>0.1</mas>")),
            "FILE:16: found XML error: mismatched element, expected well-formed XML");
  EXPECT_THROW(load_robot("no/such.sdf"), InputError);
}

TEST(LoadRobot, RejectsUnknownDuplicateAndMissingElements) {
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

// kSmallRobot with a second hand, which the wrist's motor turns as well.
std::string with_follower(const std::string& mimic, const std::string& more = "") {
  return with("  </model>", R"(    <link name="claw">
      <pose relative_to="base">0 0 0.2 0 0 0</pose>
      <inertial><mass>0.1</mass><inertia><ixx>2e-4</ixx><iyy>3e-4</iyy><izz>4e-4</izz></inertia></inertial>
    </link>
    <joint name="grip" type="revolute">
      <parent>base</parent>
      <child>claw</child>
      <axis>
        <xyz>0 0 1</xyz>
        <limit><lower>-3</lower><upper>3</upper><velocity>1</velocity></limit>
        )" + mimic + R"(
      </axis>
)" + more + R"(    </joint>
  </model>)");
}

TEST(LoadRobot, ReadsAJointThatFollowsAnother) {
  const ScratchFile scratch(
      "sdf", with_follower("<mimic joint=\"wrist\"><multiplier>-0.5</multiplier><offset>0.1</offset>"
                           "<reference>0.4</reference></mimic>"));
  const RobotDescription robot = load_robot(scratch.path());
  ASSERT_EQ(robot.joints.size(), 1U);
  ASSERT_EQ(robot.followers.size(), 1U);
  const FollowerDescription& grip = robot.followers[0];
  EXPECT_EQ(grip.hinge.name, "grip");
  EXPECT_EQ(grip.leader, 0);
  EXPECT_EQ(grip.multiplier, -0.5);
  EXPECT_DOUBLE_EQ(grip.offset_rad, 0.3);
  EXPECT_DOUBLE_EQ(grip.position_rad(0.4), 0.1);
  // The range that the wrist's, -1 to 2, leaves it.
  EXPECT_DOUBLE_EQ(grip.hinge.lower_rad, -0.7);
  EXPECT_DOUBLE_EQ(grip.hinge.upper_rad, 0.8);
  EXPECT_DOUBLE_EQ(grip.hinge.max_speed_rad_per_s, 3.5);
  EXPECT_EQ(robot.hinge_count(), 2U);
  const std::vector<double> positions_rad = robot.hinge_positions_rad({0.4});
  ASSERT_EQ(positions_rad.size(), 2U);
  EXPECT_DOUBLE_EQ(positions_rad[1], 0.1);
}

TEST(LoadRobot, RefusesCouplingsOfNoMotor) {
  const auto mimic = [](const std::string& joint, const std::string& multiplier = "1") {
    return "<mimic joint=\"" + joint + "\"><multiplier>" + multiplier + "</multiplier></mimic>";
  };
  EXPECT_THAT(complaint(with_follower(mimic("elbow"))),
              testing::EndsWith("found joint = elbow, expected the name of a joint with a drive"));
  EXPECT_THAT(complaint(with_follower(mimic("grip"))),
              testing::EndsWith("found joint = grip, expected the name of a joint with a drive"));
  EXPECT_THAT(complaint(with_follower(mimic("wrist", "0.01"))),
              testing::EndsWith("found a multiplier of 0.01, expected at least 0.05 or at most -0.05"));
  EXPECT_THAT(complaint(with_follower(mimic("wrist", "9"))),
              testing::EndsWith("found <multiplier> = 9, expected a number from -8 to 8"));
  EXPECT_THAT(complaint(with_follower("<mimic joint=\"wrist\"/>")),
              testing::EndsWith("found <mimic> without <multiplier>, expected that element"));
  EXPECT_THAT(
      complaint(with_follower(mimic("wrist"), "      <koboshi:encoder bits=\"12\"/>\n")),
      testing::EndsWith("found <koboshi:encoder> of grip, which has <mimic>, expected that element on the "
                        "joint that it follows, or no <mimic>"));
  // Without it the joint needs a drive.
  EXPECT_THAT(complaint(with_follower("")),
              testing::EndsWith("found <joint> without <koboshi:servo>, expected that element"));
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

TEST(LoadRobot, RejectsImpossibleBodies) {
  EXPECT_EQ(complaint(with("<izz>4e-4</izz>", "<izz>6e-4</izz>")),
            "FILE:17: found principal moments 2e-04, 3e-04 and 6e-04 kg m^2 in link hand, "
            "expected none greater than the sum of the others");
  EXPECT_THAT(complaint(with("<izz>4e-4</izz>", "<izz>4e-4</izz><ixy>3e-4</ixy>")),
              MatchesRegex("FILE:17: found principal moments -.*, expected positive ones"));
}

TEST(LoadRobot, RejectsImpossibleJoints) {
  EXPECT_EQ(complaint(with("\"revolute\"", "\"prismatic\"")),
            "FILE:38: found type = prismatic, expected revolute");
  EXPECT_EQ(complaint(with("<xyz>1 0 0", "<xyz>1 0 0.1")),
            "FILE:42: found <xyz> = 1 0 0.1, of length 1.004987562112089, expected a unit vector");
  EXPECT_EQ(complaint(with("<lower>-1", "<lower>3")),
            "FILE:43: found lower 3 and upper 2, expected lower below upper");
  EXPECT_EQ(complaint(with("<lower>-1", "<lower>-2.8")),
            "FILE:47: found a shaft at 3.3 rad where joint wrist is at -2.8, "
            "expected less than half a turn to either side");
  EXPECT_EQ(
      complaint(with("type=\"small\"", "type=\"large\"")),
      "FILE:45: found type = large, expected the name of a koboshi:servo_type: small; <koboshi:servo_types "
      "file=\"...\"/> in the model includes those of a library");
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

TEST(LoadRobot, RejectsJointsThatFormNoTree) {
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

TEST(LoadRobot, RefusesNodeIdsOfTheControllerAndTheSensors) {
  const auto refusal = [](int node_id) {
    return complaint(
        with("</model>", another_link("tip") + another_joint("elbow", "hand", "tip", node_id) + "</model>"));
  };
  EXPECT_EQ(refusal(1), "FILE:59: found node_id = 1, that of the controller, expected another from 3 to 127");
  EXPECT_EQ(refusal(2),
            "FILE:59: found node_id = 2, that of the controller's telemetry, expected another from 3 to 127");
  EXPECT_EQ(refusal(36),
            "FILE:59: found node_id = 36, that of the inertial sensor, expected another from 3 to 127");
  EXPECT_EQ(refusal(37),
            "FILE:59: found node_id = 37, that of the left ankle sensor, expected another from 3 to 127");
  EXPECT_EQ(refusal(38),
            "FILE:59: found node_id = 38, that of the right ankle sensor, expected another from 3 to 127");
  for (const int node_id : {3, 35, 39, 127}) EXPECT_EQ(refusal(node_id), "nothing") << node_id;
}

TEST(LoadRobot, RejectsPosesRelativeToUnknownFrames) {
  EXPECT_EQ(complaint(with("relative_to=\"base\"", "relative_to=\"moon\"")),
            "FILE:13: found relative_to = moon, expected the name of a link or joint");
  EXPECT_EQ(complaint(with("<xyz>", "<xyz expressed_in=\"moon\">")),
            "FILE:42: found expressed_in = moon, expected the name of a link or joint");
}

TEST(LoadRobot, ReadsPoseScaleAndColourOfVisuals) {
  const ScratchFile mesh("stl", "");
  const ScratchFile scratch(
      "sdf",
      with("<collision name",
           "<visual name='shell'><pose>0.1 0.2 0.3 0 0 1.5707963267948966</pose>\n"
           "<geometry><mesh><uri>" +
               mesh.path().string() +
               "</uri><scale>0.001 0.002 0.003</scale></mesh></geometry>\n"
               "<material><ambient>1 1 1 1</ambient><diffuse>0.25 0.5 1 1</diffuse></material></visual>\n"
               "<visual name='bare'><geometry><mesh><uri>" +
               mesh.path().string() +
               "</uri></mesh></geometry></visual>\n"
               "<visual name='block'><geometry><box><size>1 2 3</size></box></geometry>\n"
               "<material><diffuse>1 0 0 1</diffuse></material></visual>\n<collision name"));
  const LinkDescription hand = load_robot(scratch.path()).links.at(1);
  ASSERT_EQ(hand.meshes.size(), 2u);
  const MeshDescription& shell = hand.meshes[0];
  EXPECT_EQ(shell.name, "shell");
  EXPECT_EQ(shell.file, mesh.path());
  EXPECT_EQ(shell.scale, Eigen::Vector3d(0.001, 0.002, 0.003));
  EXPECT_TRUE(shell.X_LG.translation().isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  EXPECT_TRUE((shell.X_LG.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_EQ(shell.colour, (ColourDescription{0.25F, 0.5F, 1.0F}));
  EXPECT_EQ(hand.meshes[1].scale, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(hand.meshes[1].colour, std::nullopt);
  EXPECT_EQ(hand.visual_boxes.at(0).colour, (ColourDescription{1.0F, 0.0F, 0.0F}));
}

TEST(LoadRobot, RefusesColoursThatAreNone) {
  for (const std::string bad : {"red", "1 0 0", "2 0 0 1"}) {
    EXPECT_EQ(complaint(with("<collision name",
                             "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry>\n"
                             "<material><diffuse>" +
                                 bad + "</diffuse></material></visual>\n<collision name")),
              "FILE:20: found <diffuse> = " + bad + ", expected 4 times a number from 0 to 1");
  }
}

TEST(LoadRobot, RejectsMissingMeshes) {
  EXPECT_EQ(
      complaint(with(
          "<collision name",
          "<visual name='v'><geometry><mesh><uri>no.stl</uri></mesh></geometry></visual>\n<collision name")),
      "FILE:19: found <uri> = no.stl, expected a mesh file that exists, relative to this file's folder");
}

TEST(LoadRobot, RefusesAFrictionWithoutDirectionOrMaterialWithoutName) {
  EXPECT_THAT(complaint(with("0 1 0</fdir1>", "0 0 0</fdir1>")),
              MatchesRegex("FILE:[0-9]+: found <fdir1> = 0 0 0, expected a direction, any but zero"));
  EXPECT_THAT(complaint(with("0 1 0</fdir1>", "0 2 0</fdir1>")),
              MatchesRegex("FILE:[0-9]+: .*from -1 to 1.*"));
  EXPECT_THAT(complaint(with(">rubber<", "><")), MatchesRegex("FILE:[0-9]+: .*koboshi:material.*"));
}

}  // namespace
}  // namespace koboshi::sim_board
