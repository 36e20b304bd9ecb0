#include "tools/import/pipeline/import_robot.h"

#include <algorithm>
#include <set>
#include <string>
#include <system_error>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "tools/import/collision/clear_boxes.h"
#include "tools/import/collision/fit_boxes.h"
#include "tools/import/decide/decisions_text.h"
#include "tools/import/decide/known_decisions.h"
#include "tools/import/decide/roles.h"
#include "tools/import/mesh/surfaces.h"
#include "tools/import/normalise/align.h"
#include "tools/import/normalise/followers.h"
#include "tools/import/normalise/linkages.h"
#include "tools/import/normalise/lock_joints.h"
#include "tools/import/normalise/merge_links.h"
#include "tools/import/normalise/one_sided_locks.h"
#include "tools/import/normalise/repair_links.h"
#include "tools/import/normalise/symmetry.h"
#include "tools/import/normalise/zero_pose.h"
#include "tools/import/pipeline/import_exported.h"
#include "tools/import/read/robot_reader.h"
#include "tools/import/servo/decide_servos.h"
#include "tools/import/write/import_page.h"

namespace koboshi::tools {
namespace {

// Ranges that import.yaml sets.
void apply_given_limits(ImportedRobot& robot, Interview& interview) {
  for (const auto& [name, limits_deg] : interview.given().limits_deg) {
    const auto index = robot.find_joint(name);
    if (!index)
      throw interview.error("limits_deg", name, "no joint " + one_line(name) + " for limits_deg",
                            "a joint of robot.sdf");
    ImportedJoint& joint = robot.joints[static_cast<std::size_t>(*index)];
    joint.lower_rad = kRadPerDegree * limits_deg[0];
    joint.upper_rad = kRadPerDegree * limits_deg[1];
    interview.taken.limits_deg[name] = limits_deg;
  }
}

// No drawing of a tree shows rods beside it.
void ask_for_linkages(Interview& interview, ImportReport& report) {
  if (interview.yes({"linkage",
                     "Does a parallel linkage that the drawing leaves out move a knee or an ankle?",
                     "no",
                     {}}))
    report.warnings.push_back(
        "a linkage moves joints together: ranges and torques here are those of separate servos");
}

}  // namespace

std::filesystem::path relative_source(const ImportOptions& options) {
  std::error_code error;
  // Absolute: of two relative paths, the one that begins with a folder that does not exist yet would stay so.
  const std::filesystem::path file = std::filesystem::absolute(options.file, error);
  if (error) return options.file;
  const std::filesystem::path output = std::filesystem::absolute(options.output, error);
  if (error) return options.file;
  const std::filesystem::path relative = std::filesystem::relative(file, output, error);
  return error || relative.empty() ? options.file : relative;
}

ImportResult import_robot(const ImportOptions& options) {
  ImportResult result;
  ImportReport& report = result.report;
  Interview interview(options.decisions, options.ask, options.decisions_source);
  if (auto exported = import_exported(options, interview, report)) return std::move(*exported);
  ServoCatalogue catalogue(options.servo_folder);

  ImportedRobot source = read_foreign_robot(options.file, report);
  const std::set<std::string> source_names = names_in(source);
  require_known_names(interview.given(), source, options.decisions_source);
  load_surfaces(source, MeshPaths(options.file, options.paths), report);
  repair_links(source, interview, report);
  move_actuators(source, report);
  const ImportedRobot unlocked = source;
  lock_undriven_joints(source, interview, report);
  ImportedRobot robot = merge_fixed_links(source);

  const Eigen::Matrix3d R_MR = decide_axes(robot, interview);
  decide_roles(robot, R_MR, interview, report);
  lock_extra_joints(robot, interview, report);
  robot = merge_fixed_links(robot);
  warn_of_one_sided_locks(unlocked, robot, R_MR, interview, report);
  if (robot.joints.empty()) throw InputError(options.file, 0, "a robot without driven hinges", "one or more");
  limit_continuous_joints(robot, interview, report);
  repair_masses(robot, interview, report);

  const std::vector<double> zero_rad = decide_zero_pose(robot, R_MR, interview, report);
  robot = align_robot(robot, R_MR, zero_rad, interview, report);
  repair_symmetry(robot, interview, report);
  apply_given_limits(robot, interview);
  limit_followers(robot, report);
  ask_for_linkages(interview, report);
  decide_servos(robot, catalogue, interview, report);

  const auto triangles = static_cast<std::size_t>(interview.number(
      {"triangles", "How many triangles may the meshes of a link have?", "4000", {}}, 12, 1e6));
  RobotFileParts parts = decide_parts(robot, catalogue, interview, report);
  parts.meshes = make_link_meshes(robot, triangles, result.files, report);
  fit_boxes(robot, interview.taken.answers.at("symmetric") == "yes", report);
  clear_boxes(robot, interview, report);
  add_licences(options.file, result.files, report);
  require_known(interview.given(), interview.taken, source_names, robot, options.decisions_source);

  result.files["robot.sdf"] = robot_sdf(robot, parts, catalogue);
  result.files["import.yaml"] = decisions_text(interview, report, relative_source(options));
  result.files["import.md"] = import_page(robot, parts, interview, report, options.command);
  result.questions = interview.questions().size();
  result.robot = std::move(robot);
  return result;
}

}  // namespace koboshi::tools
