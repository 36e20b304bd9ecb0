#include "tools/import/read/robot_reader.h"

#include <algorithm>
#include <cstddef>
#include <string>

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

}  // namespace

ImportedRobot read_foreign_robot(const std::filesystem::path& file, ImportReport& report) {
  if (extension_of(file) == ".xacro") refuse_xacro(file, 0);
  const std::string text = with_line_feeds(read_text_file(file, "a URDF, SDF or MJCF file"));
  const std::string root = xml_root_name(file);
  ImportedRobot robot;
  if (root == "robot") {
    if (const auto at = std::min(text.find("<xacro:"), text.find("\"${")); at != std::string::npos)
      refuse_xacro(file, static_cast<int>(
                             std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')) +
                             1);
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
  static_cast<void>(root_link(robot));  // throws for a closed loop
  return robot;
}

}  // namespace koboshi::tools
