#include "tools/robot_file/check/model_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/robot_file/planted_robot.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

// A binary STL without normals.
std::string stl_of(const std::vector<std::array<std::array<float, 3>, 3>>& faces) {
  std::string bytes(80, ' ');
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(static_cast<std::uint32_t>(faces.size()));
  for (const auto& face : faces) {
    append(std::array<float, 3>{});
    append(face);
    append(std::uint16_t{0});
  }
  return bytes;
}

using ModelCheckTest = PlantedRobotTest;

TEST_F(ModelCheckTest, FindsNothingInTheDefaultRobot) {
  const ModelReport report = check_model(source() / "robot.sdf");
  for (const ModelFinding& one : report.findings)
    ADD_FAILURE() << one.code << " line " << one.line << ": " << one.found << ", expected " << one.expected;
  EXPECT_FALSE(report.has_errors());
  EXPECT_NEAR(report.robot->total_mass_kg(), 1.2, 0.1);
  EXPECT_NEAR(report.height_m, 0.38, 0.04);
  ASSERT_TRUE(report.leg_m[0] && report.leg_m[1]);
  EXPECT_NEAR(*report.leg_m[0], 0.13, 1e-6);
  EXPECT_NEAR(report.com_M_m.y(), 0.0, 1e-6);
  ASSERT_TRUE(report.squat);
  EXPECT_GT(report.squat->share, 0.05);
  EXPECT_LT(report.squat->share, 0.8);
}

TEST_F(ModelCheckTest, PrintsLineSeverityCodeAndRepair) {
  plant("<joint name=\"left_knee\"", "<xyz>0 1 0", "<xyz>0 0.8 0");
  const std::string text = model_report_text(check());
  EXPECT_NE(
      text.find("robot.sdf:" + std::to_string(line_) + ": error[R014]: found <xyz> = 0 0.8 0, of length 0.8"),
      std::string::npos);
  EXPECT_NE(text.find("\n  = The unit vector in this direction is 0 1 0.\n"), std::string::npos);
  EXPECT_NE(text.find("The reader refuses this file."), std::string::npos);
}

TEST_F(ModelCheckTest, RefusesAFileThatIsMissing) {
  EXPECT_THROW(static_cast<void>(check_model(folder_.path / "nobody.sdf")), InputError);
}

TEST_F(ModelCheckTest, FindsAllThatTheFirmwareCannotRepresent) {
  plant("<model name=\"koboshi\">", "koboshi", "a_robot_with_a_name_of_thirty_letters");
  const int name_line = line_;
  plant("<joint name=\"left_ankle_roll\"", "left_ankle_roll", "left_ankle_rol");
  std::vector<int> lines;
  for (const ModelFinding& one : check().findings) {
    if (one.code != "R028") continue;
    EXPECT_EQ(one.severity, simulation::Severity::kError);
    lines.push_back(one.line);
  }
  ASSERT_EQ(lines.size(), 3u);  // the name, the ankle without a sole, and its counterpart on the other side
  EXPECT_EQ(lines[0], name_line);
  EXPECT_LE(lines[1], line_);
  EXPECT_GT(lines[2], line_);
}

TEST_F(ModelCheckTest, FindsErrorsInTheParametersBesideTheRobot) {
  const fs::path file = folder_.path / "parameters.yaml";
  test::write_file(file, "version: 1\nrobot: koboshi\nparameters:\n  step_tme_ms: 240\n");
  const ModelFinding unknown = finding("R029");
  EXPECT_EQ(unknown.file, file);
  EXPECT_EQ(unknown.line, 4);
  test::write_file(file, "version: 1\nrobot: okina\nparameters: {}\n");
  EXPECT_EQ(finding("R029").line, 2);
}

TEST_F(ModelCheckTest, FindsInertiasOutOfProportion) {
  plant("<link name=\"trunk\">", "<ixx>5.2908e-04</ixx><iyy>4.4508e-04</iyy><izz>3.0000e-04</izz>",
        "<ixx>5.2908e-02</ixx><iyy>4.4508e-02</iyy><izz>3.0000e-02</izz>");
  EXPECT_NE(finding("R002").found.find("trunk"), std::string::npos);
}

TEST_F(ModelCheckTest, FindsSidesThatAreNotMirrorImages) {
  const std::string original = text_;
  plant("<link name=\"right_shank\">", "<mass>0.05</mass>", "<mass>0.06</mass>");
  EXPECT_NE(finding("R003").found.find("the mass of right_shank: 0.06 kg"), std::string::npos);
  text_ = original;
  plant("<joint name=\"right_elbow\"", "2.356194", "2.1");
  EXPECT_NE(finding("R003").found.find("the limits of right_elbow"), std::string::npos);
}

TEST_F(ModelCheckTest, FindsMeshesInTheWrongUnit) {
  plant("<visual name=\"chest_cover\">", "<scale>0.001 0.001 0.001</scale>", "<scale>1 1 1</scale>");
  const ModelReport report = check();
  EXPECT_TRUE(
      std::ranges::any_of(report.findings, [](const ModelFinding& one) { return one.code == "R006"; }));
  const auto found = std::ranges::find(report.findings, std::string("R006"), &ModelFinding::code);
  ASSERT_NE(found, report.findings.end());
  EXPECT_NE(found->repair.find("0.001"), std::string::npos);
}

TEST_F(ModelCheckTest, FindsMeshesThatAreOpenOrInverted) {
  fs::remove(folder_.path / "meshes");
  fs::copy(source() / "meshes", folder_.path / "meshes");
  const fs::path mesh = folder_.path / "meshes" / "chest_cover.stl";
  test::write_file(mesh, "solid in_ascii\nendsolid in_ascii\n");
  EXPECT_EQ(finding("R010").found, "chest_cover.stl, which cannot be shown: no triangle");
  EXPECT_EQ(finding("R010").severity, simulation::Severity::kError);
  test::write_file(mesh, "v 0 0 0\n");
  EXPECT_EQ(finding("R010").severity, simulation::Severity::kWarning);
  // A tetrahedron whose faces look inwards, and the same without one face.
  using Corner = std::array<float, 3>;
  const Corner o{0, 0, 0};
  const Corner x{50, 0, 0};
  const Corner y{0, 50, 0};
  const Corner z{0, 0, 50};
  std::vector<std::array<Corner, 3>> faces{{o, x, y}, {o, y, z}, {o, z, x}, {x, z, y}};
  test::write_file(mesh, stl_of(faces));
  EXPECT_EQ(finding("R005").found, "chest_cover.stl with triangles that face inwards");
  faces.pop_back();
  test::write_file(mesh, stl_of(faces));
  EXPECT_EQ(finding("R004").found, "chest_cover.stl with 3 open edges");
}

TEST_F(ModelCheckTest, FindsLinksThatOverlapAtRest) {
  plant("<link name=\"head\">", "<size>", "<size>0.5 0.5 0.6</size><!--");
  plant("<link name=\"head\">", "</size></box>", "--></box>");
  const ModelReport report = check();
  EXPECT_TRUE(
      std::ranges::any_of(report.findings, [](const ModelFinding& one) { return one.code == "R007"; }));
}

// A trunk box that reaches down to the thighs touches none at joint angles zero, and none while one joint
// alone turns by a few degrees, but holds the hips of a robot that walks.
TEST_F(ModelCheckTest, FindsBoxesThatTouchWhileJointsTurn) {
  plant("<link name=\"trunk\">", "<pose>0 0 0.083 0 0 0</pose>\n        <geometry>",
        "<pose>0 0 0.068 0 0 0</pose>\n        <geometry>");
  plant("<link name=\"trunk\">", "<size>0.06 0.08 0.106</size>", "<size>0.06 0.08 0.136</size>");
  const ModelReport report = check();
  EXPECT_FALSE(has(report, "R007"));
  const auto found = std::ranges::find(report.findings, std::string("R032"), &ModelFinding::code);
  ASSERT_NE(found, report.findings.end());
  EXPECT_EQ(found->severity, simulation::Severity::kWarning);
  EXPECT_EQ(found->element, "left_thigh");
  EXPECT_NE(found->found.find("trunk and left_thigh overlapping by "), std::string::npos) << found->found;
  EXPECT_NE(found->found.find("left_hip_pitch at -"), std::string::npos) << found->found;
}

TEST_F(ModelCheckTest, FindsServosThatAreTooWeak) {
  plant("<koboshi:servo_type name=\"krs_2552\">", "<torque_constant_Nm_per_A>1.0027",
        "<torque_constant_Nm_per_A>0.1");
  const ModelReport report = check();
  const auto found = std::ranges::find(report.findings, std::string("R009"), &ModelFinding::code);
  ASSERT_NE(found, report.findings.end());
  EXPECT_EQ(found->severity, simulation::Severity::kError);
  EXPECT_TRUE(report.has_errors());
}

TEST_F(ModelCheckTest, FindsSolesThatAreNotLevel) {
  const std::size_t foot = text_.find("<link name=\"left_foot\">");
  ASSERT_NE(foot, std::string::npos);
  const std::size_t collision = text_.find("<collision", foot);
  const std::size_t pose = text_.find("<pose>", collision);
  const std::size_t end = text_.find("</pose>", pose);
  std::string numbers = text_.substr(pose + 6, end - pose - 6);
  numbers.replace(numbers.find(' ', numbers.find(' ', numbers.find(' ') + 1) + 1), std::string::npos,
                  " 0 0.1 0");
  text_.replace(pose + 6, end - pose - 6, numbers);
  const ModelReport report = check();
  EXPECT_TRUE(
      std::ranges::any_of(report.findings, [](const ModelFinding& one) { return one.code == "R008"; }));
}

TEST_F(ModelCheckTest, ChecksARobotThatIsAlreadyLoaded) {
  plant("<link name=\"right_shank\">", "<mass>0.05</mass>", "<mass>0.06</mass>");
  const ModelReport loaded = checker_.check(file_, text_, sim_board::load_robot(file_, text_));
  EXPECT_EQ(model_report_json(loaded), model_report_json(check()));
  EXPECT_EQ(loaded.findings.size(), 1U);
}

TEST_F(ModelCheckTest, ReadsAMeshAgainOnlyAfterAChange) {
  fs::remove(folder_.path / "meshes");
  fs::copy(source() / "meshes", folder_.path / "meshes");
  const fs::path mesh = folder_.path / "meshes" / "servo.stl";
  MeshStore store;
  EXPECT_TRUE(store.of(mesh).stl.mesh);
  EXPECT_TRUE(store.of(mesh).stl.mesh);
  EXPECT_EQ(store.reads(), 1U);
  test::write_file(mesh, "solid in_ascii\nendsolid in_ascii\n");
  EXPECT_FALSE(store.of(mesh).stl.mesh);
  EXPECT_EQ(store.reads(), 2U);
}

TEST_F(ModelCheckTest, WritesTheSameAsJson) {
  plant("<link name=\"right_shank\">", "<mass>0.05</mass>", "<mass>0.06</mass>");
  const ModelReport report = check();
  const auto json = nlohmann::json::parse(model_report_json(report));
  EXPECT_EQ(json["robot"], "koboshi");
  EXPECT_EQ(json["links"].size(), report.robot->links.size());
  ASSERT_EQ(json["findings"].size(), 1U);
  EXPECT_EQ(json["findings"][0]["code"], "R003");
  EXPECT_GT(json["findings"][0]["line"], 0);
}

}  // namespace
}  // namespace koboshi::tools
