#include "tools/import/read/robot_reader.h"

#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "base/xml/xml_reader.h"
#include "tools/import/read/mjcf_reader.h"
#include "tools/import/read/sdf_reader.h"
#include "tools/import/read/urdf_reader.h"

namespace koboshi::tools {

ImportedRobot read_foreign_robot(const std::filesystem::path& file, ImportReport& report) {
  if (extension_of(file) == ".xacro") {
    const std::string urdf = std::filesystem::path(file).replace_extension("").string();
    throw InputError(file, 0, "a file for xacro",
                     "a URDF; expand it with: xacro " + file.string() + " > " +
                         (urdf.ends_with(".urdf") ? urdf : urdf + ".urdf"));
  }
  const std::string text = with_line_feeds(read_text_file(file, "a URDF, SDF or MJCF file"));
  const std::string root = xml_root_name(file);
  ImportedRobot robot;
  if (root == "robot") {
    robot = read_urdf(file, text, report);
  } else if (root == "sdf") {
    robot = read_sdf(file, text, report);
  } else if (root == "mujoco") {
    robot = read_mjcf(file, report);
  } else {
    throw InputError(file, 0, root.empty() ? "no well-formed XML" : "<" + one_line(root) + ">",
                     "<robot> of a URDF, <sdf> of an SDF model or <mujoco> of an MJCF model");
  }
  static_cast<void>(root_link(robot));  // throws for a closed loop
  return robot;
}

}  // namespace koboshi::tools
