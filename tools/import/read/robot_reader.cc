#include "tools/import/read/robot_reader.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/shell_word.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "base/xml/xml_draft.h"
#include "base/xml/xml_reader.h"
#include "tools/import/read/mjcf_reader.h"
#include "tools/import/read/sdf_reader.h"
#include "tools/import/read/urdf_reader.h"

namespace koboshi::tools {
namespace {

// A file that xacro has still to expand, whatever its name. Expanded ones keep only the declaration of its
// namespace.
[[noreturn]] void refuse_xacro(const std::filesystem::path& file, int line) {
  const bool by_name = extension_of(file) == ".xacro";
  std::filesystem::path urdf = by_name ? std::filesystem::path(file).replace_extension("")
                                       : file.parent_path() / (file.stem().string() + "_expanded.urdf");
  if (urdf.extension() != ".urdf") urdf += ".urdf";
  throw InputError(
      file, line, "a file for xacro",
      "a URDF; expand it with: xacro " + shell_word(file.string()) + " > " + shell_word(urdf.string()));
}

bool has_substitution(const std::string_view text) {
  return text.find("${") != std::string_view::npos || text.find("$(") != std::string_view::npos;
}

// Returns the line of the first element that xacro would replace by a part of the robot; 0 if there is none.
// Files are found that xacro has expanded but for simulator plugins, arguments and conditions about them.
int line_of_xacro(const tinyxml2::XMLElement& element, bool is_conditional) {
  const std::string_view name = element.Name();
  if (name == "gazebo" || name == "xacro:arg" || name == "xacro:property") return 0;
  const bool is_condition = name == "xacro:if" || name == "xacro:unless";
  const bool is_part = name == "link" || name == "joint" || name == "transmission";
  if ((name.starts_with("xacro:") && !is_condition) || (is_conditional && is_part))
    return element.GetLineNum();
  if (!is_condition) {
    for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next())
      if (has_substitution(attribute->Value())) return element.GetLineNum();
    if (const char* const text = element.GetText(); text != nullptr && has_substitution(text))
      return element.GetLineNum();
  }
  for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    if (const int line = line_of_xacro(*child, is_conditional || is_condition); line != 0) return line;
  return 0;
}

// Throws InputError for a URDF that xacro has still to expand.
void require_expanded(const std::filesystem::path& file, const std::string& text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr)
    return;  // read_urdf() names the fault
  if (const int line = line_of_xacro(*document.RootElement(), false); line != 0) refuse_xacro(file, line);
}

constexpr double kMost_rad = 4.0 * std::numbers::pi;  // two turns, beyond which no servo of a joint turns

double farthest_rad(const ImportedJoint& joint) {
  if (joint.kind != JointKind::kHinge) return 0.0;
  return std::max(std::abs(joint.lower_rad.value_or(0.0)), std::abs(joint.upper_rad.value_or(0.0)));
}

// Whether a limit that passes for one in radians is rather one in degrees: beyond half a turn, which no joint
// of a humanoid needs, and not the turn that files give joints without limits.
bool looks_like_degrees(const ImportedJoint& joint) {
  constexpr double kRounding_rad = 0.02;
  const double far_rad = farthest_rad(joint);
  return far_rad > std::numbers::pi + kRounding_rad && far_rad <= kMost_rad &&
         std::abs(far_rad - 2.0 * std::numbers::pi) > kRounding_rad;
}

// Names the joints whose limits are in degrees, too, but small enough to pass for radians.
std::string small_degrees(const ImportedRobot& robot) {
  std::string names;
  for (const ImportedJoint& joint : robot.joints)
    if (looks_like_degrees(joint)) names += (names.empty() ? "" : ", ") + one_line(joint.name);
  return names.empty() ? "" : " The limits of " + names + " look like degrees, too";
}

void warn_of_degrees(const ImportedRobot& robot, ImportReport& report) {
  for (const ImportedJoint& joint : robot.joints)
    if (looks_like_degrees(joint))
      report.warnings.push_back(fmt::format(
          "line {}: {} turns by up to {:.4g} rad; if the file means degrees, write {:.4g}", joint.line,
          one_line(joint.name), farthest_rad(joint), kRadPerDegree * farthest_rad(joint)));
}

// A misspelt kind would make a fixed joint of one that turns, and degrees one that turns anywhere.
void require_plausible(const ImportedJoint& joint, const ImportedRobot& robot,
                       const std::filesystem::path& file) {
  // Of URDF, SDF and MJCF.
  static const std::vector<std::string> kKinds{"revolute",  "continuous", "fixed",   "prismatic", "floating",
                                               "planar",    "revolute2",  "gearbox", "ball",      "screw",
                                               "universal", "hinge",      "slide"};
  if (joint.kind == JointKind::kOther && std::ranges::find(kKinds, joint.kind_name) == kKinds.end())
    throw InputError(file, joint.line, "a joint of the type " + one_line(joint.kind_name),
                     expected_names(joint.kind_name, kKinds));
  if (joint.kind != JointKind::kHinge) return;
  for (const std::optional<double>& limit_rad : {joint.lower_rad, joint.upper_rad}) {
    if (!limit_rad || std::abs(*limit_rad) <= kMost_rad) continue;
    throw InputError(file, joint.line,
                     fmt::format("a limit of {} rad for {}", number_text(*limit_rad), one_line(joint.name)),
                     fmt::format("at most {:.4g} rad, two turns; did you mean {} degrees?{}", kMost_rad,
                                 number_text(*limit_rad), small_degrees(robot)));
  }
}

}  // namespace

ImportedRobot read_foreign_robot(const std::filesystem::path& file, ImportReport& report) {
  if (extension_of(file) == ".xacro") refuse_xacro(file, 0);
  const std::string text = with_line_feeds(read_text_file(file, "a URDF, SDF or MJCF file"));
  const std::string root = xml_root_name(file);
  ImportedRobot robot;
  if (root == "robot") {
    require_expanded(file, text);
    robot = read_urdf(file, text, report);
  } else if (root == "sdf") {
    robot = read_sdf(file, text, report);
  } else if (root == "mujoco") {
    robot = read_mjcf(file, text, report);
  } else {
    if (!text.empty())
      static_cast<void>(XmlDraft(file, text, XmlRule{.name = root}));  // names the line of a fault
    throw InputError(file, 0, root.empty() ? "no well-formed XML" : "<" + one_line(root) + ">",
                     "<robot> of a URDF, <sdf> of an SDF model or <mujoco> of an MJCF model");
  }
  for (const ImportedJoint& joint : robot.joints) require_plausible(joint, robot, file);
  warn_of_degrees(robot, report);
  static_cast<void>(root_link(robot));  // throws for a closed loop
  return robot;
}

}  // namespace koboshi::tools
