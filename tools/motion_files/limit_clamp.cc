#include "tools/motion_files/limit_clamp.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "tools/motion_files/motion_text.h"

namespace koboshi::tools {

double LimitClamp::operator()(std::size_t joint, double angle_rad, const std::string& place,
                              std::vector<std::string>& report) {
  const robot::Joint& limits = robot_.model.joints[joint];
  const double bounded_rad =
      std::clamp(angle_rad, fixed::to_double(limits.lower), fixed::to_double(limits.upper));
  const double beyond_rad = std::abs(angle_rad - bounded_rad);
  if (beyond_rad == 0.0) return angle_rad;
  const double noise_rad = robot_.encoder_steps_rad[joint];
  if (largest_rad_ && beyond_rad > std::max(*largest_rad_, noise_rad))
    throw InputError(file_, 0,
                     fmt::format("{}: {} at {} degrees, {} beyond its limit", place,
                                 robot_.joint_names[joint], degrees(angle_rad), degrees(beyond_rad)),
                     fmt::format("at most {} degrees beyond it (--clamp)", degrees(*largest_rad_)));
  if (beyond_rad > 5e-4 * kRadPerDegree) {
    ++count_;
    report.push_back(fmt::format("{}: {} {} -> {} degrees, its limit", place, robot_.joint_names[joint],
                                 degrees(angle_rad), degrees(bounded_rad)));
  }
  return bounded_rad;
}

}  // namespace koboshi::tools
