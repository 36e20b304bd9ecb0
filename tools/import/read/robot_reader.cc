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
#include "base/text/text.h"
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
  throw InputError(file, line, "a file for xacro",
                   "a URDF; expand it with: xacro " + file.string() + " > " + urdf.string());
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

// A misspelt kind would make a fixed joint of one that turns, and degrees one that turns anywhere.
void require_plausible(const ImportedJoint& joint, const std::filesystem::path& file) {
  // Of URDF, SDF and MJCF.
  static const std::vector<std::string> kKinds{"revolute",  "continuous", "fixed",   "prismatic", "floating",
                                               "planar",    "revolute2",  "gearbox", "ball",      "screw",
                                               "universal", "hinge",      "slide"};
  constexpr double kMost_rad = 4.0 * std::numbers::pi;  // two turns, beyond which no servo of a joint turns
  if (joint.kind == JointKind::kOther && std::ranges::find(kKinds, joint.kind_name) == kKinds.end())
    throw InputError(file, joint.line, "a joint of the type " + one_line(joint.kind_name),
                     expected_names(joint.kind_name, kKinds));
  if (joint.kind != JointKind::kHinge) return;
  for (const std::optional<double>& limit_rad : {joint.lower_rad, joint.upper_rad}) {
    if (!limit_rad || std::abs(*limit_rad) <= kMost_rad) continue;
    throw InputError(file, joint.line,
                     fmt::format("a limit of {} rad for {}", number_text(*limit_rad), one_line(joint.name)),
                     fmt::format("at most {:.4g} rad, two turns; did you mean {} degrees?", kMost_rad,
                                 number_text(*limit_rad)));
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
  for (const ImportedJoint& joint : robot.joints) require_plausible(joint, file);
  static_cast<void>(root_link(robot));  // throws for a closed loop
  return robot;
}

}  // namespace koboshi::tools
