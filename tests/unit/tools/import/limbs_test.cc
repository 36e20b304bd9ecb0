// Limbs of the kinds that robots have besides that of the firmware's tables: hips and ankles in other orders,
// inclined axes, waists, arms with a twist, and drives of their own.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>

#include "base/text/user_units.h"
#include "firmware/robot/leg.h"
#include "sim_board/description/load.h"
#include "sim_board/world/foot.h"
#include "simulation/model/robot_model.h"
#include "tests/unit/tools/import/kit_robot.h"
#include "tools/import/normalise/anchors.h"
#include "tools/import/normalise/sole_line.h"
#include "tools/import/pipeline/import_robot.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

class ImportLimbs : public testing::Test {
 protected:
  ~ImportLimbs() override { fs::remove_all(folder_); }

  ImportResult import(const KitRobot& kit) const {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "kit.urdf", std::ios::binary) << kit.text();
    return import_robot({.file = folder_ / "kit.urdf",
                         .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                         .decisions_source = "answers.yaml",
                         .output = folder_ / "out"});
  }
  // The robot as the simulation reads it. The firmware must accept it, with legs that walk.
  sim_board::RobotDescription load(const ImportResult& result) const {
    write_import_folder(folder_ / "out", result.files);
    sim_board::RobotDescription robot = sim_board::load_robot(folder_ / "out/robot.sdf");
    for (const InputError& error : simulation::find_model_errors(robot)) ADD_FAILURE() << error.what();
    const simulation::NamedModel named = simulation::load_named_model(robot);
    EXPECT_TRUE(robot::can_walk(named.model));
    return robot;
  }
  static const sim_board::JointDescription& joint(const sim_board::RobotDescription& robot,
                                                  const std::string& name) {
    return robot.joints.at(static_cast<std::size_t>(robot.find_joint(name).value()));
  }
  static std::string source_of(const ImportResult& result, const std::string& name) {
    const std::string& text = result.files.at("import.yaml");
    const std::size_t begin = text.find("  " + name + ": ") + name.size() + 4;
    return text.substr(begin, text.find('\n', begin) - begin);
  }

  fs::path folder_ =
      fs::temp_directory_path() /
      ("koboshi_limbs_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(ImportLimbs, HipsAndAnklesHaveTheirJointsInAnyOrder) {
  const ImportResult result = import({.hip_axes = "yxz", .ankle_axes = "xy"});
  EXPECT_TRUE(result.report.warnings.size() == 1U) << result.report.warnings.front();  // no licence
  EXPECT_LE(result.questions, 12U);
  EXPECT_EQ(source_of(result, "left_hip_pitch"), "j_l1");
  EXPECT_EQ(source_of(result, "left_hip_roll"), "j_l2");
  EXPECT_EQ(source_of(result, "right_hip_yaw"), "j_r3");
  EXPECT_EQ(source_of(result, "left_ankle_roll"), "j_l5");
  EXPECT_EQ(source_of(result, "left_ankle_pitch"), "j_l6");
  const sim_board::RobotDescription robot = load(result);
  // The foot is the last link, and has the sole and the sensor.
  const auto feet = sim_board::feet_of(robot);
  ASSERT_TRUE(feet[0] && feet[1]);
  EXPECT_EQ(robot.links[static_cast<std::size_t>(feet[0]->link)].name, "left_foot");
  EXPECT_TRUE(std::ranges::any_of(robot.links, [](const auto& link) { return link.name == "left_thigh"; }));
}

// Many robots have no ankle roll. They are imported, stand, and the firmware says what they lack.
TEST_F(ImportLimbs, LegsWithoutAnkleRollHaveTheirNames) {
  const ImportResult result = import({.hip_axes = "yxz", .ankle_axes = "y"});
  EXPECT_EQ(source_of(result, "left_hip_pitch"), "j_l1");
  EXPECT_EQ(source_of(result, "left_hip_roll"), "j_l2");
  EXPECT_EQ(source_of(result, "left_hip_yaw"), "j_l3");
  EXPECT_EQ(source_of(result, "right_ankle_pitch"), "j_r5");
  write_import_folder(folder_ / "out", result.files);
  const sim_board::RobotDescription robot = sim_board::load_robot(folder_ / "out/robot.sdf");
  EXPECT_TRUE(simulation::find_model_errors(robot).empty());
  EXPECT_TRUE(robot.left_ankle);
  EXPECT_TRUE(sim_board::feet_of(robot)[0]);
  EXPECT_FALSE(robot::can_walk(simulation::load_named_model(robot).model));
}

// The roll axis decides where joint zero of the ankle is, unless it is inclined to the sole.
TEST_F(ImportLimbs, AnInclinedAnkleLeavesTheSoleLevel) {
  const double incline_rad = 10.0 * kRadPerDegree;
  const sim_board::RobotDescription robot = load(import({.roll_incline_rad = incline_rad}));
  EXPECT_NEAR(joint(robot, "left_ankle_roll").axis_M.z(), -std::sin(incline_rad), 1e-6);
  const auto feet = sim_board::feet_of(robot);
  ASSERT_TRUE(feet[0]);
  double lowest = 1.0;
  double highest = -1.0;
  for (const Eigen::Vector3d& corner_L : feet[0]->corners_L) {
    lowest = std::min(lowest, corner_L.z());
    highest = std::max(highest, corner_L.z());
  }
  EXPECT_NEAR(lowest, highest, 1e-6);
}

TEST(SoleLine, IsTheLongEdgeAtTheBottom) {
  const double tilt_rad = 0.2;
  std::vector<Eigen::Vector2d> points;
  const Eigen::Rotation2Dd turn(tilt_rad);
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d{-0.05, 0.0}, {0.1, 0.0}, {0.1, 0.04}, {-0.05, 0.06}})
    points.push_back(turn * corner);
  const auto line = sole_line(points);
  ASSERT_TRUE(line);
  EXPECT_NEAR(std::atan2(line->y(), line->x()), tilt_rad, 1e-12);
  // A round foot has no sole, and a point neither.
  std::vector<Eigen::Vector2d> ball;
  for (int i = 0; i < 100; ++i) ball.emplace_back(std::cos(0.0628 * i), std::sin(0.0628 * i));
  EXPECT_FALSE(sole_line(ball));
  EXPECT_FALSE(sole_line({{0.0, 0.0}, {0.0, 0.0}}));
}

TEST_F(ImportLimbs, AJointThatTwistsTheArmIsNoElbow) {
  const ImportResult result = import({.has_arm_twist = true});
  EXPECT_EQ(source_of(result, "left_elbow"), "j_lc");
  EXPECT_EQ(joint(load(result), "left_elbow").axis_M, Eigen::Vector3d::UnitY());
}

// Arms that part behind three joints in the mid-plane are two limbs, and no fingers of one.
TEST_F(ImportLimbs, ArmsAboveAWaistOfThreeJointsAreArms) {
  const ImportResult result = import({.has_waist = true});
  EXPECT_EQ(source_of(result, "left_elbow"), "j_lc");
  EXPECT_EQ(source_of(result, "right_shoulder_pitch"), "j_ra");
  EXPECT_EQ(load(result).joints.size(), 20U);  // the waist is locked
}

TEST_F(ImportLimbs, RobotsTooHeavyForServosOfKitsHaveDrivesAsStrongAsTheFileSays) {
  const ImportResult result = import({.mass_factor = 4.5, .effort_Nm = 15.0});
  const sim_board::RobotDescription robot = load(result);
  const sim_board::ServoDescription& servo = joint(robot, "left_knee").servo;
  const double at_rest_Nm = servo.torque_constant_Nm_per_A * servo.supply_V / servo.resistance_ohm;
  EXPECT_NEAR(at_rest_Nm - servo.coulomb_friction_Nm, 15.0, 0.01);
  EXPECT_NE(result.files.at("import.yaml").find("servo: source"), std::string::npos);
  EXPECT_NE(result.files.at("robot.sdf").find("name=\"drive_15\""), std::string::npos);
  // 1000 N m on 10 kg are a placeholder.
  const ImportResult placeholder = import({.mass_factor = 4.5, .effort_Nm = 1000.0});
  EXPECT_TRUE(std::ranges::any_of(placeholder.report.warnings, [](const std::string& line) {
    return line.find("left_knee: an effort of 1000 N m, which no such robot has") != std::string::npos;
  }));
  EXPECT_EQ(placeholder.files.at("robot.sdf").find("drive_1000"), std::string::npos);
}

// CAD leaves the robot looking anywhere; legs beside each other along x look along y, where the feet are
// longer.
TEST_F(ImportLimbs, LooksAcrossTheLineBetweenTheLegs) {
  for (const auto& [turned_rad, forward] :
       {std::pair{0.5 * std::numbers::pi, "y"}, {-0.5 * std::numbers::pi, "-y"}}) {
    const ImportResult result = import({.turned_rad = turned_rad, .foot_ahead_m = 0.02});
    EXPECT_NE(result.files.at("import.yaml").find(std::string("forward: ") + forward), std::string::npos);
    EXPECT_EQ(source_of(result, "left_knee"), "j_l4");
    EXPECT_GT(joint(load(result), "left_knee").upper_rad, 1.5);
  }
}

// A bracket that is the same part on both sides has its anchor in front of the limb on one of them.
TEST(AlignAnchors, SlidesAnchorsOfBothSidesAlongTheirHinges) {
  JointAnchors anchors{.names = {"left_hip_roll", "right_hip_roll"},
                       .axes = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitX()},
                       .points_m = {{0.019, 0.04, 0.0}, {-0.019, -0.04, 0.0}}};
  ImportReport report;
  static_cast<void>(align_anchors(anchors, 0.001, report));
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_LT((anchors.points_m[0] - Eigen::Vector3d(0.0, 0.04, 0.0)).norm(), 1e-9);
  EXPECT_LT((anchors.points_m[1] - Eigen::Vector3d(0.0, -0.04, 0.0)).norm(), 1e-9);
}

TEST(AlignAnchors, LeavesAxesThatAreFarApartWhereTheyAre) {
  JointAnchors anchors{
      .names = {"left_hip_yaw", "left_hip_roll", "left_hip_pitch", "left_knee", "left_ankle_pitch",
                "left_ankle_roll"},
      .axes = {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
               Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()},
      .points_m = {
          {0, 0.1, 0}, {0, 0.1, -0.02}, {0, 0.1, 0}, {0, 0.1, -0.3}, {0, 0.1, -0.6}, {0, 0.1, -0.612}}};
  ImportReport report;
  static_cast<void>(align_anchors(anchors, 0.001, report));
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_NEAR(anchors.points_m[1].z() - anchors.points_m[2].z(), -0.02, 1e-9);
}

}  // namespace
}  // namespace koboshi::tools
