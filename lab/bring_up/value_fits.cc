#include "lab/bring_up/value_fits.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>

#include "base/text/error.h"
#include "base/text/user_units.h"
#include "lab/bring_up/parameter_values.h"
#include "lab/bring_up/standing_pose.h"
#include "simulation/assembly/robot_parameters.h"

namespace koboshi::lab {
namespace {

using simulation::RobotParameters;

// Changes a value that the robot's body refuses; false for one that cannot be mended.
bool mend(RobotParameters& parameters, const std::string& refused, const BodyMeasures& body) {
  constexpr double kLess = 0.98;
  const double least_mm = kMmPerM * body.sole_width_m + 2.0;
  if (refused == "com_height_mm" || refused == "longest_step_mm") {
    multiply_value(parameters, refused, kLess);
    return *find_value(parameters, refused) >
           0.3 * kMmPerM * (refused == "com_height_mm" ? body.com_m : 0.2 * body.leg_m);
  }
  if (refused == "widest_step_mm") {
    const double* width = find_value(parameters, "step_width_mm");
    multiply_value(parameters, refused, kLess);
    return width != nullptr && *find_value(parameters, refused) > *width;
  }
  if (refused == "step_width_mm" || refused == "narrowest_step_mm") {
    set_value(parameters, refused, std::max(*find_value(parameters, refused) + 1.0, least_mm));
    if (*find_value(parameters, "step_width_mm") < *find_value(parameters, "narrowest_step_mm"))
      set_value(parameters, "step_width_mm", *find_value(parameters, "narrowest_step_mm"));
    if (*find_value(parameters, "widest_step_mm") < *find_value(parameters, "step_width_mm"))
      set_value(parameters, "widest_step_mm", 1.3 * *find_value(parameters, "step_width_mm"));
    return *find_value(parameters, refused) < 3.0 * least_mm;
  }
  if (refused.starts_with("fall_to_the_")) {
    *find_value(parameters, refused) += 1.0;
    return *find_value(parameters, refused) < 60.0;
  }
  if (refused == "touchdown_load_N") {
    set_value(parameters, refused, 0.0);
    return true;
  }
  return false;
}

// Changes the values that the robot's body refuses. Throws InputError for one that cannot be mended.
void mend_all(RobotParameters& parameters, const BodyMeasures& body, const robot::RobotModel& model) {
  constexpr int kMostChanges = 200;
  std::map<std::string, InputError> first;  // by parameter: with the value that was not changed yet
  for (int change = 0;; ++change) {
    try {
      static_cast<void>(simulation::compile_robot_parameters(parameters, model));
      return;
    } catch (const InputError& error) {
      const std::string refused = error.found().substr(0, error.found().find(' '));
      if (change == kMostChanges || find_value(parameters, refused) == nullptr ||
          !mend(parameters, refused, body)) {
        if (const auto earlier = first.find(refused); earlier != first.end())
          throw InputError(earlier->second);
        throw;
      }
      first.emplace(refused, error);
    }
  }
}

// Shares of the way by which a CoM is lowered that are tried where the legs do not reach their poses or
// steps: ankles of some robots bend little, and heavy legs bend more for the same CoM height.
constexpr std::array<double, 5> kLoweredShares{1.0, 0.85, 0.7, 0.55, 0.4};

}  // namespace

void fit_values(RobotParameters& parameters, const BodyMeasures& body, const robot::RobotModel& model) {
  const RobotParameters unfitted = parameters;
  const double lowered_m = body.com_m - value_or(parameters, "com_height_mm", 0.0) / kMmPerM;
  std::optional<InputError> first;
  for (const double share : kLoweredShares) {
    parameters = unfitted;
    if (share < 1.0) set_value(parameters, "com_height_mm", kMmPerM * (body.com_m - share * lowered_m));
    try {
      return mend_all(parameters, body, model);
    } catch (const InputError& error) {
      if (!first) first = error;
    }
    if (lowered_m <= 0.0) break;
  }
  throw InputError(*first);
}

void set_com_height(StartValues& values, const BodyMeasures& body, double height_m) {
  values.com_height_m = height_m;
  values.com_lowered_m = body.com_m - height_m;
  values.leg_use = (body.limb_m - values.com_lowered_m) / body.limb_m;
}

void fit_stance(StartValues& values, const BodyMeasures& body, const simulation::NamedModel& model) {
  constexpr std::array<double, 5> kNarrower{1.0, 0.9, 0.8, 0.7, 0.6};
  const StartValues unfitted = values;
  const double least_m = values.value("narrowest_step_mm") / kMmPerM;
  const auto is_reached = [&](double lowered, double narrower, bool with_all) {
    values = unfitted;
    values.step_width_m = std::max(narrower * unfitted.step_width_m, least_m);
    if (narrower < 1.0) set_value(values.parameters, "step_width_mm", kMmPerM * values.step_width_m);
    try {
      if (lowered < 1.0) {
        set_com_height(values, body, body.com_m - lowered * unfitted.com_lowered_m);
        set_value(values.parameters, "com_height_mm", kMmPerM * values.com_height_m);
      }
      if (lowered < 1.0 || narrower < 1.0) mend_all(values.parameters, body, model.model);
      return standing_pose(values, model, "A trial").unreached.empty() || !with_all;
    } catch (const InputError&) {
      return false;
    }
  };
  // A robot that reaches no squat or no shift may stand.
  for (const bool with_all : {true, false})
    for (const double lowered : kLoweredShares)
      for (const double narrower : kNarrower)
        if (is_reached(lowered, narrower, with_all)) return;
  values = unfitted;
}

}  // namespace koboshi::lab
