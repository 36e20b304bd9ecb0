#include "tools/robot_file/reference/reference.h"

namespace koboshi::tools {

std::vector<RobotReferenceFile> robot_reference_files() {
  return {{"robot-file.md", robot_page_text()},
          {"robot.xsd", robot_xsd_text()},
          {"robot-koboshi.xsd", koboshi_xsd_text()}};
}

}  // namespace koboshi::tools
