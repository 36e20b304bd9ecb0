#pragma once

#include <string>

#include "tools/import/robot/imported_robot.h"
#include "tools/import/servo/servo_catalogue.h"

namespace koboshi::tools {

// Returns `usual`, or the next stronger servo of usual robots that is stiff enough to hold an aligned robot
// of this weight and height upright on its ankles. A type that is no servo of usual robots stays.
[[nodiscard]] std::string stiff_servo(const std::string& usual, const ImportedRobot& robot,
                                      const ServoCatalogue& catalogue);

}  // namespace koboshi::tools
