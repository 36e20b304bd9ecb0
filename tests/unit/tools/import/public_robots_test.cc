// What URDFs of humanoids do that a kit's exporter does not: each test shows one such way on a small robot of
// our own.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <tuple>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "simulation/model/abilities.h"
#include "simulation/model/robot_model.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/import/kit_robot.h"
#include "tools/import/normalise/anchors.h"
#include "tools/import/pipeline/import_robot.h"
#include "tools/import/read/robot_reader.h"
#include "tools/import/servo/stiff_servo.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

std::string replaced(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : std::string(text).replace(at, from.size(), to);
}

class PublicRobots : public testing::Test {
 protected:
  ImportResult import(const std::string& urdf, const ImportDecisions& decisions = {}) const {
    test::write_file(folder_.path / "kit.urdf", urdf);
    return import_robot({.file = folder_.path / "kit.urdf",
                         .servo_folder = servos_,
                         .decisions_source = "answers.yaml",
                         .decisions = decisions,
                         .output = folder_.path / "out"});
  }
  // The robot as the simulation reads it, which the firmware must accept.
  sim_board::RobotDescription load(const ImportResult& result) const {
    write_import_folder(folder_.path / "out", result.files);
    sim_board::RobotDescription robot = sim_board::load_robot(folder_.path / "out/robot.sdf");
    for (const InputError& error : simulation::find_model_errors(robot)) ADD_FAILURE() << error.what();
    return robot;
  }
  static std::string source_of(const ImportResult& result, const std::string& role) {
    const std::string& yaml = result.files.at("import.yaml");
    std::smatch match;
    return std::regex_search(yaml, match, std::regex("\n  " + role + ": (\\S+)")) ? match[1].str() : "";
  }
  static bool has_line(const std::vector<std::string>& lines, const std::string& part) {
    return std::ranges::any_of(lines,
                               [&](const std::string& line) { return line.find(part) != std::string::npos; });
  }

  const fs::path servos_ = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos";
  test::TemporaryFolder folder_;
};

// Arms with more joints than the legs, which point forward: they are not legs of a robot that lies.
TEST_F(PublicRobots, LegsHangLowestWhateverTheArmsDo) {
  KitRobot kit;
  for (const std::string side : {"l", "r"}) {
    std::string parent = side + "c";
    for (const std::string link : {"d", "e", "f", "g"}) {
      kit.extra +=
          kit.link(side + link, 0.02, 0.02, 0.02, 0.02, 0.0) +
          kit.hinge("j_" + side + link, parent, side + link, "0.06 0 0", "0 0 0", "1 0 0", -1.0, 1.0);
      parent = side + link;
    }
  }
  const ImportResult result = import(kit.text());
  EXPECT_EQ(source_of(result, "up"), "z");
  EXPECT_EQ(source_of(result, "left_knee"), "j_l4");
  EXPECT_EQ(source_of(result, "right_elbow"), "j_rc");
  load(result);
}

// The front follows the sides in the names of the joints, or, without sides, the way in which knees bend.
TEST_F(PublicRobots, FacesAsItsSidesAndKneesSay) {
  const auto turned = [](double yaw_rad) {
    KitRobot kit;
    kit.extra = fmt::format(
        "<link name=\"ground\"/><joint name=\"j_ground\" type=\"fixed\"><parent link=\"ground\"/>"
        "<child link=\"base\"/><origin xyz=\"0 0 0.3\" rpy=\"0 0 {}\"/></joint>",
        yaw_rad);
    return kit.text();
  };
  constexpr double kQuarter_rad = 1.5707963267948966;
  EXPECT_EQ(source_of(import(turned(0.0)), "forward"), "x");
  const ImportResult beside = import(turned(-kQuarter_rad));
  EXPECT_EQ(source_of(beside, "forward"), "-y");
  const sim_board::RobotDescription robot = load(beside);
  EXPECT_GT(robot.joints.at(static_cast<std::size_t>(robot.find_joint("left_knee").value())).p_MJ.y(), 0.0);

  const std::string without_sides = std::regex_replace(turned(2.0 * kQuarter_rad), std::regex("j_r"), "j_x");
  EXPECT_EQ(source_of(import(without_sides), "forward"), "-x");
}

// One motor drives both hip yaws.
TEST_F(PublicRobots, CouplesBothHipsThatOneMotorTurns) {
  // The right hip's zero is turned by 0.05 rad in the file, and so is the law of its angle.
  const std::string text =
      replaced(KitRobot().text(), "<child link=\"r1\"/>\n    <origin xyz=\"0 -0.04 -0.03\" rpy=\"0 0 0\"/>",
               "<child link=\"r1\"/><origin xyz=\"0 -0.04 -0.03\" rpy=\"0 0 -0.05\"/>"
               "<mimic joint=\"j_l1\" multiplier=\"-1\" offset=\"0.05\"/>");
  const ImportResult result = import(text);
  EXPECT_TRUE(has_line(result.report.normalised, "j_r1 follows j_l1, as -1 times its angle and 2.86 deg"));
  EXPECT_EQ(source_of(result, "left_hip_yaw"), "j_l1");
  EXPECT_EQ(source_of(result, "right_hip_yaw"), "j_r1");
  EXPECT_EQ(source_of(result, "one_motor"), "yes");
  const sim_board::RobotDescription robot = load(result);
  EXPECT_EQ(robot.joints.size(), 19U);
  ASSERT_EQ(robot.followers.size(), 1U);
  const sim_board::FollowerDescription& follower = robot.followers[0];
  EXPECT_EQ(follower.hinge.name, "right_hip_yaw");
  EXPECT_EQ(robot.joints[static_cast<std::size_t>(follower.leader)].name, "left_hip_yaw");
  EXPECT_DOUBLE_EQ(follower.multiplier, -1.0);
  // Joint zero is a pose of both.
  EXPECT_NEAR(follower.offset_rad, 0.0, 1e-6);
  const std::vector<simulation::LostAbility> lost =
      simulation::find_lost_abilities(simulation::load_named_model(robot).model);
  EXPECT_TRUE(std::ranges::none_of(
      lost, [](const auto& ability) { return ability.ability == robot::Ability::kTurning; }));
  EXPECT_EQ(import(text, read_decisions(folder_.path / "out/import.yaml")).files.at("robot.sdf"),
            result.files.at("robot.sdf"));
}

// Before this question, entries for both in `joints` gave each a motor of its own.
TEST_F(PublicRobots, GivesEachHipAMotorIfAsked) {
  const std::string text = replaced(KitRobot().text(), "<child link=\"r1\"/>",
                                    "<child link=\"r1\"/><mimic joint=\"j_l1\" multiplier=\"1\"/>");
  ImportDecisions named;
  named.joints = {{"left_hip_yaw", "j_l1"}, {"right_hip_yaw", "j_r1"}};
  EXPECT_EQ(load(import(text, named)).joints.size(), 20U);
  ImportDecisions asked;
  asked.answers["one_motor"] = "no";
  const sim_board::RobotDescription robot = load(import(text, asked));
  EXPECT_EQ(robot.joints.size(), 20U);
  EXPECT_TRUE(robot.followers.empty());
  // Both turn to the same side: the robot has the coupling, but cannot turn by it.
  const sim_board::RobotDescription coupled = load(import(text));
  ASSERT_EQ(coupled.followers.size(), 1U);
  EXPECT_DOUBLE_EQ(coupled.followers[0].multiplier, 1.0);
  const std::vector<simulation::LostAbility> lost =
      simulation::find_lost_abilities(simulation::load_named_model(coupled).model);
  EXPECT_TRUE(std::ranges::any_of(
      lost, [](const auto& ability) { return ability.ability == robot::Ability::kTurning; }));
}

// A motor for two other joints of the legs is none that the firmware walks with.
TEST_F(PublicRobots, LocksOtherJointsThatOneMotorTurns) {
  KitRobot kit;
  kit.hip_axes = "xzy";
  const ImportResult result =
      import(replaced(kit.text(), "<child link=\"r1\"/>", "<child link=\"r1\"/><mimic joint=\"j_l1\"/>"));
  EXPECT_TRUE(has_line(result.report.warnings, "one motor turns j_r1 and j_l1: both are locked"));
  const sim_board::RobotDescription robot = load(result);
  EXPECT_EQ(robot.joints.size(), 18U);
  EXPECT_TRUE(robot.followers.empty());
}

// A knee that mimics the hip of its own leg is a linkage, not one motor for both legs.
TEST_F(PublicRobots, LeavesAnotherJointOfTheSameLeg) {
  const ImportResult result = import(
      replaced(KitRobot().text(), "<child link=\"r2\"/>", "<child link=\"r2\"/><mimic joint=\"j_r1\"/>"));
  EXPECT_FALSE(has_line(result.report.warnings, "one motor"));
  EXPECT_EQ(source_of(result, "right_hip_yaw"), "j_r1");
  EXPECT_TRUE(has_line(result.report.normalised, "joint j_r2 is locked at 0 deg, because it mimics j_r1"));
}

// A spine of four joints, at whose top arms and head part.
TEST_F(PublicRobots, ArmsPartAboveALongSpine) {
  KitRobot kit;
  std::string parent = "body";
  for (int i = 1; i <= 4; ++i) {
    const std::string link = i == 4 ? "chest" : fmt::format("s{}", i);
    kit.extra += kit.link(link, 0.03, 0.03, 0.03, 0.01, 0.0) +
                 kit.hinge(fmt::format("j_s{}", i), parent, link, i == 1 ? "0 0 0.14" : "0 0 0.01", "0 0 0",
                           i % 2 == 0 ? "1 0 0" : "0 1 0", -0.5, 0.5);
    parent = link;
  }
  std::string text = kit.text();
  for (const std::string link : {"la", "ra", "n"})
    text = replaced(text, "<parent link=\"body\"/><child link=\"" + link + "\"/>",
                    "<parent link=\"chest\"/><child link=\"" + link + "\"/>");
  const ImportResult result = import(text);
  EXPECT_EQ(source_of(result, "left_shoulder_pitch"), "j_la");
  EXPECT_EQ(source_of(result, "right_elbow"), "j_rc");
  EXPECT_EQ(source_of(result, "head_pan"), "j_n");
  EXPECT_EQ(source_of(result, "left_hip_yaw"), "j_l1");
  EXPECT_EQ(load(result).joints.size(), 20U);
}

// Elbows that end 2 degrees before they are straight, and knees that always bend by 3: joint zero is where
// the robot can be.
TEST_F(PublicRobots, PutsJointZeroIntoTheRange) {
  std::string text = KitRobot().text();
  for (const std::string side : {"l", "r"}) {
    for (const auto& [joint, lower, upper] :
         {std::tuple{"c", "-2", "-0.035"}, std::tuple{"4", "0.052", "2"}}) {
      const std::size_t at = text.find("<joint name=\"j_" + side + joint + "\"");
      ASSERT_NE(at, std::string::npos);
      const std::size_t begin = text.find("<limit", at);
      text.replace(
          begin, text.find("/>", begin) - begin,
          fmt::format("<limit lower=\"{}\" upper=\"{}\" effort=\"10\" velocity=\"20\"", lower, upper));
    }
  }
  const ImportResult result = import(text);
  EXPECT_FALSE(has_line(result.report.warnings, "joint zero is outside of its range"));
  const sim_board::RobotDescription robot = load(result);
  for (const sim_board::JointDescription& joint : robot.joints) {
    EXPECT_LE(joint.lower_rad, 0.0) << joint.name;
    EXPECT_GE(joint.upper_rad, 0.0) << joint.name;
  }
}

// Collision shapes on the feet alone: trunk and legs get boxes of what is seen of them.
TEST_F(PublicRobots, GivesBoxesToARobotWhoseFeetAloneHaveShapes) {
  std::string text = KitRobot().text();
  std::string feet_only;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find("</link>", at), text.size());
    std::string link = text.substr(at, end - at);
    if (link.find("\"l6\">") == std::string::npos && link.find("\"r6\">") == std::string::npos)
      link = std::regex_replace(link, std::regex("<collision>.*</collision>"), "");
    feet_only += link;
    at = end;
    if (at < text.size()) feet_only += text.substr(at, 7), at += 7;
  }
  const sim_board::RobotDescription robot = load(import(feet_only));
  for (const sim_board::LinkDescription& link : robot.links)
    EXPECT_EQ(link.collisions.size(), 1U) << link.name;
}

// The left ankle misses the hip by more than the tolerance, the right one by less: both roll axes still slide
// to the pitch axis.
TEST_F(PublicRobots, SlidesBothAnklesWhereOneMisses) {
  JointAnchors anchors;
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0.0 ? "left_" : "right_";
    const double y_m = 0.05 * side;
    const auto add = [&](const char* role, const Eigen::Vector3d& axis, const Eigen::Vector3d& point_m) {
      anchors.names.push_back(name + role);
      anchors.axes.push_back(axis);
      anchors.points_m.push_back(point_m);
    };
    add("hip_yaw", Eigen::Vector3d::UnitZ(), {0.0, y_m, 0.02});
    add("hip_roll", Eigen::Vector3d::UnitX(), {-0.03, y_m, 0.0});
    add("hip_pitch", Eigen::Vector3d::UnitY(), {0.0, 1.2 * y_m, 0.0});
    add("knee", Eigen::Vector3d::UnitY(), {0.0, y_m, -0.1});
    add("ankle_pitch", Eigen::Vector3d::UnitY(), {0.0, y_m, -0.2});
    add("ankle_roll", Eigen::Vector3d::UnitX(), {-0.07, y_m + (side > 0.0 ? 0.0015 : 0.0008), -0.2});
  }
  ImportReport report;
  static_cast<void>(align_anchors(anchors, 1e-3, report));
  for (const std::size_t ankle_roll : {std::size_t{5}, std::size_t{11}})
    EXPECT_NEAR(anchors.points_m[ankle_roll].x(), anchors.points_m[ankle_roll - 1].x(), 1e-9);
}

// Two robots of one mass: the taller one gets the stiffer servo.
TEST_F(PublicRobots, NamesAServoThatHoldsTheHeight) {
  const ServoCatalogue catalogue(servos_);
  const auto servo_for = [&](double com_m) {
    ImportedRobot robot;
    robot.links.push_back({.name = "trunk", .mass_kg = 3.1, .p_LCom_L = {0.0, 0.0, com_m}});
    return stiff_servo("mx_28", robot, catalogue);
  };
  EXPECT_EQ(servo_for(0.15), "mx_28");
  EXPECT_EQ(servo_for(0.25), "xm430_w350");
  EXPECT_EQ(servo_for(0.6), "mx_64_m6");
  EXPECT_EQ(servo_for(100.0), "mx_28");  // none of them would do
}

// Conditions and arguments of simulator plugins that xacro left; a part of the robot among them is refused.
TEST_F(PublicRobots, ReadsFilesWithLeftoversOfXacro) {
  const fs::path file = folder_.path / "kit.urdf";
  const std::string head =
      "<robot name='kit' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<link name='a'/>\n";
  const std::string plugin =
      "<xacro:arg name='walk' default='no'/>\n<gazebo><plugin><ns>$(arg ns)</ns></plugin></gazebo>\n"
      "<xacro:if value='${walk}'><gazebo><plugin/></gazebo></xacro:if>\n";
  ImportReport report;
  test::write_file(file, head + plugin + "</robot>\n");
  EXPECT_EQ(read_foreign_robot(file, report).links.size(), 1U);
  for (const char* part : {"<xacro:if value='1'><link name='b'/></xacro:if>", "<xacro:include filename='b'/>",
                           "<link name='${side}_b'/>"}) {
    test::write_file(file, head + plugin + part + "</robot>\n");
    try {
      static_cast<void>(read_foreign_robot(file, report));
      ADD_FAILURE() << part;
    } catch (const InputError& error) {
      EXPECT_EQ(error.found(), "a file for xacro") << part;
      EXPECT_EQ(error.line(), 6) << part;
    }
  }
}

}  // namespace
}  // namespace koboshi::tools
