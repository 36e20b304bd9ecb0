#include "tools/robot_file/check/model_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include "base/text/text.h"
#include "base/xml/xml_draft.h"
#include "sim_board/description/schema/sdf_schema.h"
#include "tools/robot_file/check/checked_model.h"
#include "tools/robot_file/check/reader_findings.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;
using simulation::Severity;

void measure_mass(const sim_board::RobotDescription& robot, ModelReport& report) {
  double lowest_m = std::numeric_limits<double>::infinity();
  double highest_m = -lowest_m;
  for (const sim_board::LinkDescription& link : robot.links) {
    report.com_M_m += link.mass_kg * (link.X_ML * link.p_LCom_L);
    for (const sim_board::BoxDescription& box : link.collisions) {
      const Eigen::Isometry3d X_MG = link.X_ML * box.X_LG;
      const double half_m = 0.5 * X_MG.linear().row(2).cwiseAbs().dot(box.size_m);
      lowest_m = std::min(lowest_m, X_MG.translation().z() - half_m);
      highest_m = std::max(highest_m, X_MG.translation().z() + half_m);
    }
  }
  report.com_M_m /= robot.total_mass_kg();
  report.height_m = std::max(highest_m - lowest_m, 0.0);
}

void measure_legs(const sim_board::RobotDescription& robot, ModelReport& report) {
  constexpr std::array<const char*, 2> kSides{"left_", "right_"};
  const auto anchor = [&robot](int joint) -> const Vector3d& {
    return robot.joints[static_cast<std::size_t>(joint)].p_MJ;
  };
  for (std::size_t side = 0; side < 2; ++side) {
    const std::string prefix = kSides[side];
    const auto hip = robot.find_joint(prefix + "hip_pitch");
    const auto knee = robot.find_joint(prefix + "knee");
    const auto ankle = robot.find_joint(prefix + "ankle_pitch");
    if (hip && knee && ankle)
      report.leg_m[side] = (anchor(*hip) - anchor(*knee)).norm() + (anchor(*knee) - anchor(*ankle)).norm();
  }
}

// Whether a finding most likely follows from the repair of a fault of the reader.
bool is_consequence(const ModelFinding& finding, const std::set<std::string>& repaired) {
  return repaired.contains(finding.element) && (finding.code == "R002" || finding.code == "R003");
}

// Checks the robot, which may be that of a repaired file. `report` has the findings of the reader.
void check_robot(const ModelPlaces& places, MeshStore& meshes, ModelReport& report) {
  const sim_board::RobotDescription& robot = *report.robot;
  std::set<std::string> repaired;  // elements, and their mirror images
  for (const ModelFinding& finding : report.findings) {
    repaired.insert(finding.element);
    if (const std::string other = other_side(finding.element); !other.empty()) repaired.insert(other);
  }
  measure_mass(robot, report);
  measure_legs(robot, report);
  std::vector<ModelFinding> findings;
  CheckedModel model(robot, places, meshes, findings);
  check_inertias(model);
  check_sides(model);
  check_meshes(model, report.height_m);
  check_overlaps(model);
  check_ranges(model);
  check_soles(model);
  report.squat = check_squat(model);
  if (!report.is_repaired) check_firmware(model);
  for (ModelFinding& finding : findings)
    if (!is_consequence(finding, repaired)) report.findings.push_back(std::move(finding));
}

}  // namespace

bool ModelReport::has_errors() const {
  return std::ranges::any_of(
      findings, [](const ModelFinding& finding) { return finding.severity == Severity::kError; });
}

ModelReport ModelChecker::check(const std::filesystem::path& file, const std::string& text) {
  ReaderFindings reading = find_reader_findings(file, text);
  ModelReport report{
      .file = file, .robot = std::move(reading.robot), .findings = std::move(reading.findings)};
  report.is_repaired = report.robot && !report.findings.empty();
  if (report.robot) check_robot(*reading.places, meshes_, report);
  std::ranges::stable_sort(report.findings, {}, &ModelFinding::line);
  return report;
}

ModelReport ModelChecker::check(const std::filesystem::path& file, const std::string& text,
                                sim_board::RobotDescription robot) {
  ModelReport report{.file = file, .robot = std::move(robot)};
  check_robot(ModelPlaces(XmlDraft(file, text, sim_board::sdf_rule()).root()), meshes_, report);
  std::ranges::stable_sort(report.findings, {}, &ModelFinding::line);
  return report;
}

ModelReport check_model(const std::filesystem::path& file) {
  return check_model(file, read_text_file(file, "an XML file"));
}

ModelReport check_model(const std::filesystem::path& file, const std::string& text) {
  return ModelChecker().check(file, text);
}

}  // namespace koboshi::tools
