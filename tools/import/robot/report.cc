#include "tools/import/robot/report.h"

#include <fmt/format.h>

#include "base/text/user_units.h"

namespace koboshi::tools {

std::string millimetres(const Eigen::Vector3d& p_m) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", kMmPerM * p_m.x(), kMmPerM * p_m.y(), kMmPerM * p_m.z());
}

}  // namespace koboshi::tools
