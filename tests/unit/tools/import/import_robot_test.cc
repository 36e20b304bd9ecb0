#include "tools/import/pipeline/import_robot.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "sim_board/world/box_overlap.h"
#include "simulation/model/robot_model.h"
#include "tests/unit/tools/import/kit_robot.h"
#include "tools/import/mesh/merge.h"
#include "tools/import/mesh/primitives.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

class ImportRobot : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  ImportResult import(const KitRobot& kit, const ImportDecisions& decisions = {}) const {
    return import_robot({.file = write("kit.urdf", kit.text()),
                         .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                         .decisions_source = "answers.yaml",
                         .decisions = decisions,
                         .output = folder_ / "out"});
  }
  // The robot as the simulation reads it, which the firmware must accept.
  sim_board::RobotDescription load(const ImportResult& result) const {
    write_import_folder(folder_ / "out", result.files);
    sim_board::RobotDescription robot = sim_board::load_robot(folder_ / "out/robot.sdf");
    for (const InputError& error : simulation::find_model_errors(robot)) ADD_FAILURE() << error.what();
    return robot;
  }
  static const sim_board::JointDescription& joint(const sim_board::RobotDescription& robot,
                                                  const std::string& name) {
    return robot.joints.at(static_cast<std::size_t>(robot.find_joint(name).value()));
  }
  static bool has_line(const std::vector<std::string>& lines, const std::string& part) {
    return std::ranges::any_of(lines,
                               [&](const std::string& line) { return line.find(part) != std::string::npos; });
  }
  static const ImportRepair* find_repair(const ImportResult& result, const std::string& key) {
    const auto found = std::ranges::find(result.report.repairs, key, &ImportRepair::key);
    return found == result.report.repairs.end() ? nullptr : &*found;
  }

  const test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path;
};

TEST_F(ImportRobot, NamesJointsByTreeAndSide) {
  const ImportResult result = import({});
  const sim_board::RobotDescription robot = load(result);
  ASSERT_EQ(robot.joints.size(), 20U);
  EXPECT_EQ(robot.joints.front().name, "left_hip_yaw");
  EXPECT_LE(result.questions, 12U);
  EXPECT_NE(result.files.at("import.yaml").find("left_ankle_roll: j_l6"), std::string::npos);
  EXPECT_NE(result.files.at("import.yaml").find("right_elbow: j_rc"), std::string::npos);
  EXPECT_NE(result.files.at("import.yaml").find("head_tilt: j_h"), std::string::npos);
  EXPECT_NEAR(joint(robot, "left_knee").p_MJ.y(), 0.04, 1e-9);
  EXPECT_NEAR(robot.left_ankle->height_above_sole_m, 0.04, 1e-9);
}

// The axes of a link are its author's choice: a forearm whose frame is turned about the elbow, with the same
// shapes in the same places.
TEST_F(ImportRobot, StraightensTheElbowWhateverTheAxesOfTheForearm) {
  const KitRobot kit;
  std::string text = kit.text();
  const auto replace = [&](const std::string& part, const std::string& other) {
    const std::size_t at = text.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    text.replace(at, part.size(), other);
  };
  constexpr double kTurn_rad = 0.4;
  const double up_m = -0.01 - 0.5 * kit.forearm_length_m;
  const std::string straight = kit.link("lc", 0.06, 0.02, kit.forearm_width_m, kit.forearm_length_m, up_m);
  std::string turned = straight;
  const std::string place = fmt::format("xyz=\"0 0 {}\"", up_m);
  for (std::size_t at = turned.find(place); at != std::string::npos; at = turned.find(place))
    turned.replace(at, place.size(),
                   fmt::format("xyz=\"{} 0 {}\" rpy=\"0 {} 0\"", -up_m * std::sin(kTurn_rad),
                               up_m * std::cos(kTurn_rad), -kTurn_rad));
  replace(straight, turned);
  replace(kit.hinge("j_lc", "lb", "lc", "0 0 -0.08", "0 0 0", "0 1 0", -2.0, 0.5),
          kit.hinge("j_lc", "lb", "lc", "0 0 -0.08", fmt::format("0 {} 0", kTurn_rad), "0 1 0", -2.0, 0.5));
  const ImportResult result = import_robot({.file = write("turned.urdf", text),
                                            .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                                            .decisions_source = "answers.yaml",
                                            .output = folder_ / "out"});
  EXPECT_EQ(result.files.at("import.yaml").find("left_elbow: -"), std::string::npos) << "no other zero";
  const sim_board::RobotDescription robot = load(result);
  EXPECT_NEAR(joint(robot, "left_elbow").lower_rad, joint(robot, "right_elbow").lower_rad, 1e-4);
  EXPECT_NEAR(joint(robot, "left_elbow").upper_rad, joint(robot, "right_elbow").upper_rad, 1e-4);
}

// base_footprint: the root on the ground, with the legs above it.
TEST_F(ImportRobot, FindsTheGroundWhereTheRootIsOnIt) {
  KitRobot kit;
  kit.extra =
      "<link name=\"base_footprint\"/>" + KitRobot::fixed("ground", "base_footprint", "base", "0 0 0.3");
  const sim_board::RobotDescription robot = load(import(kit));
  EXPECT_NEAR(joint(robot, "left_knee").p_MJ.z(), 0.12, 1e-6);
}

TEST_F(ImportRobot, RepeatsItselfFromItsDecisions) {
  const ImportResult first = import({.arms_out_rad = 1.0, .inertia_factor = 1000.0});
  const ImportDecisions decisions = read_decisions(write("import.yaml", first.files.at("import.yaml")));
  const ImportResult second = import({.arms_out_rad = 1.0, .inertia_factor = 1000.0}, decisions);
  EXPECT_EQ(first.files, second.files);
}

// Meshes above the limit of triangles go through the simplifier, whose ties a symmetrical ball has many of.
// The second import finds other bytes in memory that nobody has written.
TEST_F(ImportRobot, GivesTheSameBytesTwice) {
  const auto ball = primitive_surface(ShapeKind::kSphere, {0.03, 0.03, 0.03});
  std::string obj;
  for (const Eigen::Vector3f& vertex : ball->vertices_m)
    obj += fmt::format("v {} {} {}\n", vertex.x(), vertex.y(), vertex.z());
  for (const auto& triangle : ball->triangles)
    obj += fmt::format("f {} {} {}\n", triangle[0] + 1, triangle[1] + 1, triangle[2] + 1);
  write("ball.obj", obj);
  write("ball.stl", stl_bytes(*ball));
  KitRobot kit;
  for (const char* name : {"ball.obj", "ball.stl"})
    kit.extra += fmt::format(
        "<link name=\"{0}\"><visual><geometry><mesh filename=\"{0}\"/></geometry></visual></link>\n{1}", name,
        KitRobot::fixed(std::string("to_") + name, "body", name, "0.02 0 0.1"));
  ImportDecisions decisions;
  decisions.answers["triangles"] = "300";
  std::vector<FolderFiles> results;
  for (const int byte : {0xA5, 0x5A}) {
    static_cast<void>(mallopt(M_PERTURB, byte));  // glibc's only; a sanitizer's allocator refuses it
    results.push_back(import(kit, decisions).files);
  }
  static_cast<void>(mallopt(M_PERTURB, 0));
  EXPECT_EQ(results[0], results[1]);
  EXPECT_TRUE(results[0].contains("meshes/trunk.stl"));
  EXPECT_LT(results[0].at("meshes/trunk.stl").size(), 84U + 50U * 400U);
}

TEST_F(ImportRobot, FindsTheMidPlane) {
  const ImportResult result = import({.middle_m = 0.0095});
  const sim_board::RobotDescription robot = load(result);
  EXPECT_TRUE(has_line(result.report.normalised, "mid-plane found at y = 9.5 mm"));
  EXPECT_EQ(joint(robot, "left_hip_yaw").p_MJ.y(), -joint(robot, "right_hip_yaw").p_MJ.y());
}

TEST_F(ImportRobot, SlidesAndSnapsAxesThatNearlyMeet) {
  const ImportResult result =
      import({.ankle_miss_m = 0.0006, .axis_tilt_rad = 0.004, .hip_yaw_slide_m = 0.0286});
  const sim_board::RobotDescription robot = load(result);
  EXPECT_EQ(joint(robot, "left_hip_yaw").p_MJ, joint(robot, "left_hip_pitch").p_MJ);
  EXPECT_EQ(joint(robot, "left_ankle_pitch").p_MJ, joint(robot, "left_ankle_roll").p_MJ);
  EXPECT_EQ(joint(robot, "left_hip_pitch").axis_M, Eigen::Vector3d::UnitY());
  EXPECT_TRUE(has_line(result.report.normalised,
                       "left_ankle_pitch and left_ankle_roll: axes made to meet, 0.6 mm apart"));
  EXPECT_TRUE(has_line(result.report.normalised, "left_hip_yaw: anchor slid by -28.600 mm"));
}

TEST_F(ImportRobot, KeepsAxesThatMissByMoreAndAsks) {
  const ImportResult result = import({.ankle_miss_m = 0.004});
  EXPECT_TRUE(
      has_line(result.report.warnings, "left_ankle_pitch and left_ankle_roll: axes 4.00 mm apart in z"));
  ImportDecisions decisions;
  decisions.answers["max_miss_mm"] = "5";
  load(import({.ankle_miss_m = 0.004}, decisions));
}

TEST_F(ImportRobot, LetsArmsHang) {
  const ImportResult result = import({.arms_out_rad = 1.2});
  const sim_board::RobotDescription robot = load(result);
  EXPECT_TRUE(has_line(result.report.normalised, "left_shoulder_roll: zero is at -68.75 deg of j_lb"));
  EXPECT_NEAR(joint(robot, "left_elbow").p_MJ.y(), joint(robot, "left_shoulder_roll").p_MJ.y(), 1e-6);
  EXPECT_LT(joint(robot, "left_elbow").p_MJ.z(), joint(robot, "left_shoulder_roll").p_MJ.z());
}

// The shaft keeps the direction of the source, the joint gets that of the firmware.
TEST_F(ImportRobot, TurnsJointsInTheFirmwaresDirection) {
  const sim_board::RobotDescription robot = load(import({.left_knee_sign = -1}));
  const sim_board::JointDescription knee = joint(robot, "left_knee");
  EXPECT_EQ(knee.axis_M, Eigen::Vector3d::UnitY());
  EXPECT_EQ(knee.drive.sign, -1);
  EXPECT_NEAR(knee.lower_rad, 0.0, 1e-6);
  EXPECT_GT(knee.upper_rad, 1.5);
  EXPECT_EQ(joint(robot, "right_knee").drive.sign, 1);
}

TEST_F(ImportRobot, RepairsInertiasOutOfProportion) {
  const ImportResult result = import({.inertia_factor = 1000.0});
  const ImportRepair* const repair = find_repair(result, "body.inertia");
  ASSERT_NE(repair, nullptr);
  EXPECT_EQ(repair->because, "that is 1e+03 times the inertia of a uniform box of its size");
  const sim_board::RobotDescription robot = load(result);
  EXPECT_NEAR(robot.links.front().I_LCom_L(2, 2), 0.6 / 12.0 * (0.01 + 0.0144), 1e-5);
}

TEST_F(ImportRobot, KeepsWhatItsDecisionsKeep) {
  ImportDecisions decisions;
  decisions.repairs["h.inertia"] = "keep";
  const ImportResult result = import({.inertia_factor = 4.0}, decisions);
  const sim_board::RobotDescription robot = load(result);
  const auto head = static_cast<std::size_t>(robot.find_link("head").value());
  EXPECT_NEAR(robot.links[head].I_LCom_L(0, 0), 4.0 * 0.1 / 12.0 * 0.0072, 1e-6);
}

TEST_F(ImportRobot, ComparesLeftAndRight) {
  const ImportResult result = import({.right_hip_mass_kg = 0.1});
  ASSERT_NE(find_repair(result, "left_hip_yaw_link.mass"), nullptr);
  const sim_board::RobotDescription robot = load(result);
  for (const char* link : {"left_hip_yaw_link", "right_hip_yaw_link"})
    EXPECT_NEAR(robot.links[static_cast<std::size_t>(robot.find_link(link).value())].mass_kg, 0.09, 1e-9);
}

// A mean with a mass that nobody gave would take half of the weighed side's.
TEST_F(ImportRobot, TakesTheSideThatHasAMass) {
  const KitRobot kit;
  std::string text = kit.text();
  const auto link_mass = [&](const std::string& link, const std::string& mass) {
    const std::size_t at = text.find("<mass value=\"", text.find("<link name=\"" + link + "\"")) + 13;
    text.replace(at, text.find('"', at) - at, mass);
  };
  link_mass("r4", "0");  // a shank
  link_mass("l6", "0");  // a foot
  const ImportResult result = import_robot({.file = write("light.urdf", text),
                                            .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                                            .output = folder_ / "out"});
  const ImportRepair* const repair = find_repair(result, "left_shank.mass");
  ASSERT_NE(repair, nullptr);
  EXPECT_EQ(repair->found, "left_shank of 100.0 g and right_shank with a part without a mass");
  const sim_board::RobotDescription robot = load(result);
  const sim_board::RobotDescription whole = load(import(kit));
  for (const char* name : {"left_shank", "right_shank", "left_foot", "right_foot"}) {
    const auto& link = robot.links[static_cast<std::size_t>(robot.find_link(name).value())];
    const auto& other = whole.links[static_cast<std::size_t>(whole.find_link(name).value())];
    EXPECT_NEAR(link.mass_kg, other.mass_kg, 1e-9) << name;
    EXPECT_LT((link.p_LCom_L - other.p_LCom_L).norm(), 1e-9) << name;
    EXPECT_LT((link.I_LCom_L - other.I_LCom_L).norm(), 1e-9) << name;
  }
}

// A foot with a frame turned by 30 degrees about the ankle, with the same masses and shapes in the same
// places.
TEST_F(ImportRobot, MeasuresLinksWhateverTheirAxes) {
  for (const double factor : {1.0, 4.0}) {  // both right and out of proportion
    const KitRobot kit{.inertia_factor = factor, .foot_ahead_m = 0.02};
    std::string text = kit.text();
    constexpr double kTurn_rad = 0.5;
    for (const std::string side : {"l", "r"}) {
      const std::size_t begin = text.find("<link name=\"" + side + "6\"");
      std::string foot = text.substr(begin, text.find("</link>", begin) - begin);
      const auto turn = [&](const std::string& place, double x_m, double z_m) {
        const std::string turned = fmt::format(
            "<origin xyz=\"{} 0 {}\" rpy=\"0 {} 0\"/>", x_m * std::cos(kTurn_rad) - z_m * std::sin(kTurn_rad),
            x_m * std::sin(kTurn_rad) + z_m * std::cos(kTurn_rad), -kTurn_rad);
        for (std::size_t at = foot.find(place); at != std::string::npos; at = foot.find(place))
          foot.replace(at, place.size(), turned);
      };
      turn("<origin xyz=\"0 0 -0.035\"/>", 0.0, -0.035);
      turn("<origin xyz=\"0.02 0 -0.035\"/>", 0.02, -0.035);
      text.replace(begin, text.find("</link>", begin) - begin, foot);
      // The axis of the joint is that of the link's frame, so its own direction turns back.
      const std::string joint = "<joint name=\"j_" + side + "6\"";
      std::size_t at = text.find("rpy=\"0 0 0\"", text.find(joint));
      text.replace(at, 11, fmt::format("rpy=\"0 {} 0\"", kTurn_rad));
      at = text.find("<axis xyz=\"1 0 -0\"", at);
      ASSERT_NE(at, std::string::npos);
      text.replace(at, 18, fmt::format("<axis xyz=\"{} 0 {}\"", std::cos(kTurn_rad), std::sin(kTurn_rad)));
    }
    const ImportResult turned = import_robot({.file = write("kit.urdf", text),
                                              .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                                              .output = folder_ / "out"});
    const ImportResult straight = import(kit);
    EXPECT_EQ(turned.report.repairs.size(), straight.report.repairs.size()) << factor;
    EXPECT_EQ(find_repair(turned, "l6.inertia") != nullptr, factor > 3.3);
    ASSERT_EQ(turned.robot.links.size(), straight.robot.links.size());
    for (std::size_t i = 0; i < turned.robot.links.size(); ++i) {
      const ImportedLink& one = turned.robot.links[i];
      const ImportedLink& other = straight.robot.links[i];
      EXPECT_EQ(one.name, other.name);
      EXPECT_LT((one.p_LCom_L - other.p_LCom_L).norm(), 1e-6) << one.name;
      EXPECT_LT((one.I_LCom_L - other.I_LCom_L).norm(), 1e-4 * other.I_LCom_L.norm()) << one.name;
    }
  }
}

TEST_F(ImportRobot, LimitsSpeedAndEffortToTheServo) {
  ImportDecisions decisions;
  decisions.answers["servo"] = "krs_2552";
  decisions.servos["left_knee"] = "mx_64_m6";
  const ImportResult result = import({}, decisions);
  EXPECT_TRUE(has_line(result.report.normalised, "left_hip_yaw: an effort of 10 N m -> 1.35 N m"));
  ASSERT_NE(find_repair(result, "left_knee.speed"), nullptr);
  const sim_board::RobotDescription robot = load(result);
  EXPECT_LT(joint(robot, "left_hip_yaw").max_speed_rad_per_s, 7.5);
  EXPECT_NE(joint(robot, "left_knee").servo.resistance_ohm, joint(robot, "right_knee").servo.resistance_ohm);
}

TEST_F(ImportRobot, LocksWhatIsNoDrivenHinge) {
  KitRobot kit;
  kit.extra = kit.link("slide", 0.01, 0.01, 0.01, 0.01, 0.0) +
              kit.link("finger", 0.01, 0.01, 0.01, 0.01, 0.0) +
              kit.link("thumb", 0.01, 0.01, 0.01, 0.01, 0.0) +
              "  <joint name=\"slider\" type=\"prismatic\"><parent link=\"body\"/><child link=\"slide\"/>"
              "<limit lower=\"0\" upper=\"1\"/></joint>\n"
              "  <joint name=\"j_thumb\" type=\"revolute\"><parent link=\"lc\"/><child link=\"thumb\"/><axis "
              "xyz=\"1 0 0\"/>"
              "<limit lower=\"0\" upper=\"1\"/><mimic joint=\"j_finger\"/></joint>\n"
              "  <joint name=\"j_finger\" type=\"continuous\"><parent link=\"lc\"/><child "
              "link=\"finger\"/><axis xyz=\"1 0 0\"/></joint>\n";
  const ImportResult result = import(kit);
  EXPECT_TRUE(has_line(result.report.normalised,
                       "joint slider is locked at 0 deg, because it is prismatic, no hinge"));
  EXPECT_TRUE(
      has_line(result.report.normalised, "joint j_thumb is locked at 0 deg, because it mimics j_finger"));
  EXPECT_TRUE(has_line(result.report.normalised,
                       "joint j_finger is locked at 0 deg, because the firmware has no name for it"));
  EXPECT_TRUE(has_line(result.report.normalised, "joint j_finger without limits -> 175 deg to either side"));
  EXPECT_EQ(load(result).joints.size(), 20U);

  ImportDecisions decisions;
  decisions.joints["left_wrist"] = "slider";
  EXPECT_THROW(static_cast<void>(import(kit, decisions)), InputError);
}

TEST_F(ImportRobot, KeepsOtherJointsIfAsked) {
  KitRobot kit;
  kit.extra = kit.link("hand", 0.01, 0.01, 0.01, 0.01, 0.0) +
              kit.hinge("wrist/../../x", "lc", "hand", "0 0 -0.07", "0 0 0", "1 0 0", -1.0, 1.0);
  ImportDecisions decisions;
  decisions.answers["lock_other_joints"] = "no";
  const ImportResult result = import(kit, decisions);
  EXPECT_EQ(load(result).joints.size(), 21U);
  for (const auto& [file, text] : result.files) EXPECT_EQ(file.find(".."), std::string::npos) << file;
}

TEST_F(ImportRobot, EndsRangesWhereTheBodyIsInTheWay) {
  KitRobot kit;
  std::string text = kit.text();
  const std::string knee = "<limit lower=\"0\" upper=\"2\"";
  for (std::size_t at = text.find(knee); at != std::string::npos; at = text.find(knee))
    text.replace(at, knee.size(), "<limit lower=\"0\" upper=\"3.1\"");
  const ImportResult result = import_robot({.file = write("wide.urdf", text),
                                            .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                                            .output = folder_ / "out"});
  ASSERT_NE(find_repair(result, "left_knee.upper"), nullptr);
  const sim_board::RobotDescription robot = load(result);
  EXPECT_EQ(joint(robot, "left_knee").upper_rad, joint(robot, "right_knee").upper_rad);
  EXPECT_LT(joint(robot, "left_knee").upper_rad, 3.0);
}

// The smallest gap between a forearm and the links of the leg on its side in a squat with hanging arms.
double smallest_gap_of_forearms_m(const ImportedRobot& robot, double knee_rad, double spread_rad) {
  std::vector<double> angles_rad(robot.joints.size(), 0.0);
  const auto turn = [&](const std::string& role, double left_rad, double right_rad) {
    angles_rad.at(static_cast<std::size_t>(robot.find_joint("left_" + role).value())) = left_rad;
    angles_rad.at(static_cast<std::size_t>(robot.find_joint("right_" + role).value())) = right_rad;
  };
  turn("hip_roll", spread_rad, -spread_rad);
  turn("hip_pitch", -0.5 * knee_rad, -0.5 * knee_rad);
  turn("knee", knee_rad, knee_rad);
  turn("ankle_pitch", -0.5 * knee_rad, -0.5 * knee_rad);
  const std::vector<Eigen::Isometry3d> X_MLs = link_poses(robot, angles_rad);
  const auto index_of = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(robot.links, name, &ImportedLink::name) -
                                    robot.links.begin());
  };
  double smallest_m = 1.0;
  for (const std::string side : {"left_", "right_"}) {
    const std::size_t arm = index_of(side + "forearm");
    const ImportedShape& box = robot.links.at(arm).collisions.front();
    for (const char* part : {"thigh", "shank", "ankle_link"}) {
      const std::size_t leg = index_of(side + part);
      const ImportedShape& other = robot.links.at(leg).collisions.front();
      smallest_m = std::min(smallest_m, sim_board::box_separation(X_MLs[arm] * box.X_LG, 0.5 * box.size_m,
                                                                  X_MLs[leg] * other.X_LG, 0.5 * other.size_m)
                                            .gap_m);
    }
  }
  return smallest_m;
}

// DARwIn-OP ended scenarios at once: its shanks were 4 mm beside the hanging forearms with the legs straight,
// and within them with the knees at 44 degrees and the legs apart by 4.
TEST_F(ImportRobot, KeepsHangingArmsClearOfBentLegs) {
  const KitRobot kit{.forearm_width_m = 0.06, .forearm_length_m = 0.15};
  const ImportResult result = import(kit);
  static_cast<void>(load(result));
  for (const double spread_rad : {0.0, 0.07})
    for (double knee_rad = 0.0; knee_rad < 1.5; knee_rad += 0.1)
      EXPECT_GT(smallest_gap_of_forearms_m(result.robot, knee_rad, spread_rad), 0.002)
          << knee_rad << " " << spread_rad;
  EXPECT_TRUE(has_line(result.report.normalised, "left_forearm: box shrunk to "));
  EXPECT_FALSE(has_line(result.report.warnings, "apart"));
  // Slender arms stay as they are.
  EXPECT_FALSE(has_line(import({}).report.normalised, "left_forearm: box shrunk to "));
}

TEST_F(ImportRobot, NamesAnAnswerThatIsNone) {
  ImportDecisions decisions;
  decisions.answers["servo"] = "mx28";
  try {
    static_cast<void>(import({}, decisions));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("the answer mx28 to the question servo"), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("mx_28"), std::string::npos);
  }
}

// Our own robot, read as a stranger's SDF, stays the same.
TEST_F(ImportRobot, ReadsSdfToTheSameRobot) {
  const fs::path file = fs::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf";
  const sim_board::RobotDescription own = sim_board::load_robot(file);
  const ImportResult result = import_robot({.file = file,
                                            .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                                            .output = folder_ / "out"});
  const sim_board::RobotDescription robot = load(result);
  EXPECT_EQ(robot.joint_names(), own.joint_names());
  // With a straight arm, its box meets the trunk's before the end of the shoulder's range.
  ASSERT_EQ(result.report.repairs.size(), 2U);
  EXPECT_EQ(result.report.repairs[0].key, "left_shoulder_roll.lower");
  EXPECT_EQ(result.report.repairs[1].key, "right_shoulder_roll.upper");
  for (std::size_t i = 0; i < own.joints.size(); ++i) {
    const sim_board::JointDescription& one = robot.joints[i];
    const sim_board::JointDescription& other = own.joints[i];
    EXPECT_EQ(one.axis_M, other.axis_M) << one.name;
    EXPECT_LT((one.p_MJ - other.p_MJ).norm(), 2e-6) << one.name;
    const double shortened_rad = one.name.ends_with("shoulder_roll") ? 0.1 : 1e-5;
    EXPECT_NEAR(one.lower_rad, other.lower_rad, shortened_rad) << one.name;
    EXPECT_NEAR(one.upper_rad, other.upper_rad, shortened_rad) << one.name;
    const sim_board::LinkDescription& link = robot.links[static_cast<std::size_t>(one.child)];
    const sim_board::LinkDescription& own_link = own.links[static_cast<std::size_t>(other.child)];
    EXPECT_NEAR(link.mass_kg, own_link.mass_kg, 1e-9) << one.name;
    EXPECT_LT((link.p_LCom_L - own_link.p_LCom_L).norm(), 2e-6) << one.name;
    EXPECT_LT((link.I_LCom_L - own_link.I_LCom_L).norm(), 1e-5 * own_link.I_LCom_L.norm()) << one.name;
  }
}

TEST_F(ImportRobot, RefusesAFolderThatIsSomethingElse) {
  fs::create_directories(folder_ / "other");
  std::ofstream(folder_ / "other/robot.sdf") << "<sdf/>";
  EXPECT_THROW(check_import_folder(folder_ / "other"), InputError);
  EXPECT_NO_THROW(check_import_folder(folder_ / "new"));
}

// All joints but the left knee have actuators of their own gearboxes only.
std::string transmissions(const char* left_knee) {
  const auto transmission = [](const std::string& joint, const std::string& ratio) {
    return "<transmission><joint name=\"" + joint + "\"/><actuator><mechanicalReduction>" + ratio +
           "</mechanicalReduction></actuator></transmission>";
  };
  std::string text = transmission("j_n", "1") + transmission("j_h", "1");
  for (const char* side : {"l", "r"})
    for (const char* part : {"1", "2", "3", "4", "5", "6", "a", "b", "c"}) {
      const std::string joint = std::string("j_") + side + part;
      text += transmission(joint, joint == "j_l4" ? left_knee : "1");
    }
  return text;
}

TEST_F(ImportRobot, KeepsAStageBehindTheServo) {
  const ImportResult result = import({.extra = transmissions("-2.5")});
  const sim_board::RobotDescription robot = load(result);
  const sim_board::JointDescription left = joint(robot, "left_knee");
  const sim_board::JointDescription right = joint(robot, "right_knee");
  EXPECT_EQ(left.gear, 2.5);
  EXPECT_EQ(right.gear, 1.0);
  EXPECT_EQ(left.servo.torque_constant_Nm_per_A, 2.5 * right.servo.torque_constant_Nm_per_A);
  EXPECT_EQ(left.encoder.bits, right.encoder.bits + 1);
  EXPECT_LT(left.max_speed_rad_per_s, 0.5 * right.max_speed_rad_per_s);
  EXPECT_NE(result.files.at("import.yaml").find("transmission: outside"), std::string::npos);
  EXPECT_TRUE(has_line(result.report.normalised, "left_knee: a transmission of 2.5 : 1 behind the servo"));
}

TEST_F(ImportRobot, TakesAGearboxForThatOfTheServo) {
  const ImportResult result = import({.extra = transmissions("193")});
  EXPECT_EQ(joint(load(result), "left_knee").gear, 1.0);
  EXPECT_TRUE(has_line(result.report.normalised, "left_knee: a transmission of 193 : 1 in the servo"));
  ImportDecisions outside;
  outside.answers["transmission"] = "outside";
  EXPECT_THROW(static_cast<void>(import({.extra = transmissions("193")}, outside)), InputError);
  EXPECT_THROW(static_cast<void>(import({.extra = transmissions("0")})), InputError);
}

TEST_F(ImportRobot, WarnsOfAMimicOfAJointThatDoesNotExist) {
  KitRobot kit;
  kit.extra =
      "<link name=\"jaw\"/><joint name=\"j_jaw\" type=\"revolute\"><parent link=\"h\"/><child "
      "link=\"jaw\"/><axis xyz=\"0 1 0\"/><limit lower=\"0\" upper=\"1\"/><mimic "
      "joint=\"nobody\"/></joint>";
  EXPECT_TRUE(has_line(import(kit).report.warnings, "j_jaw mimics nobody, which does not exist"));
}

}  // namespace
}  // namespace koboshi::tools
