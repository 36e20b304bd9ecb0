#include "tools/import/pipeline/import_exported.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "sim_board/description/edit/model_field.h"
#include "sim_board/description/load.h"
#include "tools/import/decide/decisions_text.h"
#include "tools/import/decide/known_decisions.h"
#include "tools/import/pipeline/exported_robot.h"
#include "tools/import/read/urdf_reader.h"
#include "tools/import/write/import_page.h"
#include "tools/robot_file/urdf/export_urdf.h"
#include "tools/robot_file/urdf/urdf_text.h"

namespace koboshi::tools {
namespace {

namespace fs = std::filesystem;

bool names_servos(const ImportDecisions& decisions) {
  return !decisions.servos.empty() || decisions.answers.contains("servo");
}

// The robot's file decides what these would.
void warn_of_unused(const ImportDecisions& given, ImportReport& report) {
  std::vector<std::string> keys;
  if (!given.joints.empty()) keys.emplace_back("joints");
  if (!given.locked_deg.empty()) keys.emplace_back("locked_deg");
  if (!given.zero_deg.empty()) keys.emplace_back("zero_deg");
  if (!given.limits_deg.empty()) keys.emplace_back("limits_deg");
  if (!given.repairs.empty()) keys.emplace_back("repairs");
  if (keys.empty()) return;
  report.warnings.push_back(fmt::format(
      "{} of import.yaml left out, because the answer exported: yes takes the robot as it was exported",
      fmt::join(keys, ", ")));
}

// Adds the meshes by their paths relative to the URDF.
void add_meshes(const sim_board::RobotDescription& robot, FolderFiles& files) {
  for (const sim_board::LinkDescription& link : robot.links)
    for (const sim_board::MeshDescription& mesh : link.meshes) {
      const fs::path path = path_in_folder(mesh.file, robot.file.parent_path());
      if (!files.contains(path.generic_string()))
        files[path.generic_string()] = read_text_file(mesh.file, "a mesh");
    }
}

RobotFileParts parts_of(const sim_board::RobotDescription& robot, const XmlDocument& document,
                        const fs::path& source) {
  RobotFileParts parts{.name = robot.name, .source = source.filename().string()};
  for (const sim_board::JointDescription& joint : robot.joints)
    parts.servos[joint.name] =
        sim_board::find_field(document, joint.name + ".servo").value.value_or(std::string());
  return parts;
}

}  // namespace

std::optional<ImportResult> import_exported(const ImportOptions& options, Interview& interview,
                                            ImportReport& report) {
  const auto exported = find_exported_robot(options.file);
  if (!exported) return std::nullopt;
  ImportReport scratch;
  const ImportedRobot as_it_is = read_urdf(
      options.file, with_line_feeds(read_text_file(options.file, "a URDF, SDF or MJCF file")), scratch);
  require_known_names(interview.given(), as_it_is, options.decisions_source);
  const bool has_servos = names_servos(interview.given());
  if (!interview.yes(
          {"exported",
           "This URDF holds the robot's file from which it was exported: take servos, sensors, drives "
           "and roles from there?",
           has_servos ? "no" : "yes",
           {}}))
    return std::nullopt;
  if (has_servos)
    throw InputError(options.decisions_source, 0, "servos beside the answer exported: yes",
                     "exported: no, or no servos; koboshi model set changes those of the result");
  const auto text = updated_robot_file(options.file, *exported, report);
  if (!text) return std::nullopt;
  warn_of_unused(interview.given(), report);
  const fs::path source = options.file.parent_path() / "robot.sdf";
  const sim_board::RobotDescription robot = sim_board::load_robot(source, *text);
  ImportResult result;
  add_meshes(robot, result.files);
  add_licences(options.file, result.files, report);
  ImportReport ignored;
  result.robot = read_urdf(options.file, urdf_text(robot, "", ""), ignored);
  const RobotFileParts parts = parts_of(robot, XmlDocument(source, *text), options.file);
  result.files["robot.sdf"] = *text;
  result.files["import.yaml"] = decisions_text(interview, report, relative_source(options));
  result.files["import.md"] = import_page(result.robot, parts, interview, report, options.command);
  result.questions = interview.questions().size();
  result.report = std::move(report);
  return result;
}

}  // namespace koboshi::tools
