#include "tools/target/parts.h"

namespace koboshi::tools {
namespace {

struct Rule {
  std::string_view prefix;
  Part part;
};

// The first rule that matches counts.
constexpr Rule kRules[] = {
    {"app::Controller::read_inertial_unit", Part::kSensors},
    {"app::Controller::read_ankles", Part::kSensors},
    {"estimation::InertialSensor::add", Part::kSensors},
    {"estimation::InertialSensor::filter", Part::kSensors},
    {"estimation::", Part::kEstimation},
    {"app::", Part::kBehaviour},
    {"balance::", Part::kBehaviour},
    {"behaviour::", Part::kBehaviour},
    {"motion::", Part::kInterpreter},
    {"canopen::", Part::kCanopen},
    {"drive::", Part::kDrives},
};

}  // namespace

std::optional<Part> part_of(std::string_view function) {
  for (const Rule& rule : kRules) {
    if (function.starts_with(rule.prefix)) return rule.part;
  }
  return std::nullopt;
}

}  // namespace koboshi::tools
