// A robot that leaves as a URDF and comes back.

#include <gtest/gtest.h>

#include <fstream>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/load.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/import/kit_robot.h"
#include "tools/import/pipeline/import_robot.h"
#include "tools/import/read/robot_reader.h"
#include "tools/robot_file/urdf/export_urdf.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

class ExportedRobotTest : public testing::Test {
 protected:
  // A folder below, because licences are searched two folders above the robot's.
  ExportedRobotTest() { fs::create_directories(root_); }

  ImportResult import(const fs::path& file, const ImportDecisions& decisions = {}) const {
    return import_robot({.file = file,
                         .servo_folder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/servos",
                         .decisions_source = "answers.yaml",
                         .decisions = decisions,
                         .output = root_ / "out"});
  }
  fs::path exported(const fs::path& robot_file) const {
    export_urdf(robot_file, root_ / "urdf/robot.urdf", "");
    return root_ / "urdf/robot.urdf";
  }
  static void replace_in(const fs::path& file, const std::string& before, const std::string& after) {
    std::string text = read_text_file(file, "a file");
    const std::size_t at = text.find(before);
    ASSERT_NE(at, std::string::npos) << before;
    text.replace(at, before.size(), after);
    std::ofstream(file, std::ios::binary) << text;
  }
  static bool warns(const ImportResult& result, const std::string& part) {
    return std::ranges::any_of(result.report.warnings, [&](const std::string& warning) {
      return warning.find(part) != std::string::npos;
    });
  }
  // The URDF by itself, without the robot's file in it: places, masses and limits.
  void expect_same_robot(const sim_board::RobotDescription& robot, const fs::path& urdf) const {
    ImportReport report;
    const ImportedRobot read = read_foreign_robot(urdf, report);
    EXPECT_TRUE(report.ignored.empty()) << report.ignored.front();
    ASSERT_EQ(read.links.size(), robot.links.size());
    ASSERT_EQ(read.joints.size(), robot.joints.size());
    const Eigen::Isometry3d X_MB = robot.links.front().X_ML;
    const std::vector<Eigen::Isometry3d> X_BF = link_poses(read);
    for (std::size_t i = 0; i < read.links.size(); ++i) {
      const ImportedLink& link = read.links[i];
      const auto& ours = robot.links[static_cast<std::size_t>(robot.find_link(link.name).value())];
      EXPECT_EQ(link.mass_kg, ours.mass_kg);
      EXPECT_LT((X_MB * X_BF[i] * link.p_LCom_L - ours.X_ML * ours.p_LCom_L).norm(), 2e-8) << link.name;
      EXPECT_TRUE(link.I_LCom_L.isApprox(ours.I_LCom_L, 1e-6)) << link.name;
      ASSERT_EQ(link.collisions.size(), ours.collisions.size());
      for (std::size_t k = 0; k < link.collisions.size(); ++k) {
        const Eigen::Isometry3d X_MG = X_MB * X_BF[i] * link.collisions[k].X_LG;
        EXPECT_TRUE(X_MG.isApprox(ours.X_ML * ours.collisions[k].X_LG, 1e-7)) << link.name;
        EXPECT_TRUE(link.collisions[k].size_m.isApprox(ours.collisions[k].size_m, 1e-7)) << link.name;
      }
      EXPECT_EQ(link.visuals.size(), ours.meshes.size() + ours.visual_boxes.size());
    }
    for (const ImportedJoint& joint : read.joints) {
      const auto& ours = robot.joints[static_cast<std::size_t>(robot.find_joint(joint.name).value())];
      const Eigen::Isometry3d X_MF = X_MB * X_BF[static_cast<std::size_t>(joint.child)];
      EXPECT_LT((X_MF.translation() - ours.p_MJ).norm(), 2e-8) << joint.name;
      EXPECT_LT((X_MF.linear() * joint.axis_L - ours.axis_M).norm(), 1e-8) << joint.name;
      EXPECT_NEAR(*joint.lower_rad, ours.lower_rad, 1e-9);
      EXPECT_NEAR(*joint.upper_rad, ours.upper_rad, 1e-9);
      EXPECT_NEAR(joint.speed_rad_per_s, ours.max_speed_rad_per_s, 1e-9);
    }
  }

  test::TemporaryFolder folder_;
  const fs::path root_ = folder_.path / "a/b/c";
  const fs::path koboshi_ = fs::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi/robot.sdf";
};

TEST_F(ExportedRobotTest, DefaultRobotComesBackByteForByte) {
  const fs::path urdf = exported(koboshi_);
  expect_same_robot(sim_board::load_robot(koboshi_), urdf);
  const ImportResult result = import(urdf);
  EXPECT_EQ(result.files.at("robot.sdf"), read_text_file(koboshi_, "a robot"));
  EXPECT_EQ(result.questions, 1U);
  EXPECT_TRUE(result.report.repairs.empty());
  for (const auto& entry : fs::directory_iterator(koboshi_.parent_path() / "meshes"))
    EXPECT_EQ(result.files.at("meshes/" + entry.path().filename().string()),
              read_text_file(entry.path(), "a mesh"));
  write_import_folder(root_ / "out", result.files);
  EXPECT_NO_THROW(static_cast<void>(sim_board::load_robot(root_ / "out/robot.sdf")));
}

TEST_F(ExportedRobotTest, ImportedRobotComesBackByteForByte) {
  std::ofstream(root_ / "kit.urdf") << KitRobot{.arms_out_rad = 1.0}.text();
  write_import_folder(root_ / "kit", import(root_ / "kit.urdf").files);
  const fs::path urdf = exported(root_ / "kit/robot.sdf");
  expect_same_robot(sim_board::load_robot(root_ / "kit/robot.sdf"), urdf);
  EXPECT_EQ(import(urdf).files.at("robot.sdf"), read_text_file(root_ / "kit/robot.sdf", "a robot"));
}

TEST_F(ExportedRobotTest, ChecksTheNamesInDecisions) {
  const fs::path urdf = exported(koboshi_);
  ImportDecisions misspelt;
  misspelt.zero_deg["left_kne"] = 5;
  EXPECT_THROW(static_cast<void>(import(urdf, misspelt)), InputError);
  ImportDecisions unused;
  unused.zero_deg["left_knee"] = 5;
  unused.repairs["trunk.mass"] = "keep";
  EXPECT_TRUE(warns(import(urdf, unused), "zero_deg, repairs of import.yaml left out, because"));
  EXPECT_FALSE(warns(import(urdf), "left out"));
}

TEST_F(ExportedRobotTest, ServoTypesOfLibrariesComeAlong) {
  fs::create_directories(root_ / "kit/meshes");
  fs::copy(koboshi_.parent_path() / "meshes", root_ / "kit/meshes");
  fs::copy(koboshi_, root_ / "kit/robot.sdf");
  // The default robot's own type moves into a library.
  std::string text = read_text_file(koboshi_, "a robot");
  const std::size_t begin = text.find("<koboshi:servo_type ");
  const std::string kEnd = "</koboshi:servo_type>";
  const std::size_t end = text.find(kEnd) + kEnd.size();
  std::ofstream(root_ / "types.xml") << "<koboshi:servo_types xmlns:koboshi=\"https://koboshi.invalid/sdf\">"
                                     << text.substr(begin, end - begin) << "</koboshi:servo_types>\n";
  text.replace(begin, end - begin, "<koboshi:servo_types file=\"../types.xml\"/>");
  std::ofstream(root_ / "kit/robot.sdf") << text;
  const sim_board::RobotDescription before = sim_board::load_robot(root_ / "kit/robot.sdf");
  const ImportResult result = import(exported(root_ / "kit/robot.sdf"));
  EXPECT_EQ(result.files.at("robot.sdf").find("types.xml"), std::string::npos);
  write_import_folder(root_ / "far/out", result.files);
  const sim_board::RobotDescription after = sim_board::load_robot(root_ / "far/out/robot.sdf");
  EXPECT_EQ(after.joints.front().servo.resistance_ohm, before.joints.front().servo.resistance_ohm);
}

TEST_F(ExportedRobotTest, WritesGearsAsTransmissions) {
  fs::copy(koboshi_.parent_path(), root_ / "kit", fs::copy_options::recursive);
  replace_in(root_ / "kit/robot.sdf", "<koboshi:servo type=\"krs_2552\"/>",
             "<koboshi:servo type=\"krs_2552\" gear=\"2\"/>");
  const fs::path urdf = exported(root_ / "kit/robot.sdf");
  const sim_board::RobotDescription robot = sim_board::load_robot(root_ / "kit/robot.sdf");
  expect_same_robot(robot, urdf);
  ImportReport ignored;
  for (const ImportedJoint& joint : read_foreign_robot(urdf, ignored).joints)
    EXPECT_EQ(joint.reduction, joint.name == robot.joints.front().name ? 2.0 : 1.0) << joint.name;
  EXPECT_EQ(import(urdf).files.at("robot.sdf"), read_text_file(root_ / "kit/robot.sdf", "a robot"));
}

TEST_F(ExportedRobotTest, TakesValuesThatWereChangedInTheUrdf) {
  const fs::path urdf = exported(koboshi_);
  replace_in(urdf, "<mass value=\"0.36\"", "<mass value=\"0.4\"");
  replace_in(urdf, "ixx=\"0.00052908\"", "ixx=\"0.0006\"");
  const ImportResult result = import(urdf);
  write_import_folder(root_ / "out", result.files);
  const sim_board::RobotDescription robot = sim_board::load_robot(root_ / "out/robot.sdf");
  EXPECT_EQ(robot.links.front().mass_kg, 0.4);
  EXPECT_NEAR(robot.links.front().I_LCom_L(0, 0), 0.0006, 1e-12);
  ASSERT_GE(result.report.normalised.size(), 2U);
  EXPECT_EQ(result.report.normalised.front(),
            "trunk.mass: 0.36 -> 0.4, because the URDF was changed after the export");
}

TEST_F(ExportedRobotTest, ImportsAnotherShapeAsAnyUrdf) {
  const fs::path urdf = exported(koboshi_);
  replace_in(urdf, "<box size=\"0.06 0.08 0.106\"/>", "<box size=\"0.06 0.08 0.09\"/>");
  const ImportResult result = import(urdf);
  EXPECT_TRUE(warns(result, "because a box of link trunk differs in the URDF"))
      << result.report.warnings.front();
  EXPECT_GT(result.questions, 5U);
  EXPECT_NE(result.files.at("robot.sdf"), read_text_file(koboshi_, "a robot"));
}

TEST_F(ExportedRobotTest, ImportsAnyUrdfAfterTheAnswerNo) {
  const fs::path urdf = exported(koboshi_);
  ImportDecisions decisions;
  decisions.answers["servo"] = "ax_12";
  EXPECT_NE(import(urdf, decisions).files.at("robot.sdf").find("ax_12"), std::string::npos);
  decisions.answers["exported"] = "yes";
  EXPECT_THROW(static_cast<void>(import(urdf, decisions)), InputError);
}

TEST_F(ExportedRobotTest, NeverTakesAFileOutsideOfTheFolder) {
  const fs::path urdf = exported(koboshi_);
  fs::copy(koboshi_.parent_path() / "meshes/trunk_frame.stl", root_ / "outside.stl");
  replace_in(urdf, "<uri>meshes/trunk_frame.stl</uri>", "<uri>meshes/../../outside.stl</uri>");
  const ImportResult result = import(urdf);
  EXPECT_TRUE(warns(result, "a mesh outside of the folder"));
  for (const auto& [file, text] : result.files) EXPECT_EQ(file.find(".."), std::string::npos) << file;
}

}  // namespace
}  // namespace koboshi::tools
