#include "tools/target/parts.h"

namespace koboshi::tools {
namespace {

struct Rule {
  std::string_view prefix;
  Part part;
};

// The first that fits.
constexpr Rule kRules[] = {
    {"app::Controller::read_inertial_unit", Part::kSensors},
    {"app::Controller::read_ankles", Part::kSensors},
    {"app::Controller::watch_sensors", Part::kSensors},
    {"app::Controller::silent_sensor", Part::kSensors},
    {"balance::InertialSensor::add", Part::kSensors},
    {"balance::InertialSensor::filter", Part::kSensors},
    {"balance::", Part::kEstimation},
    {"app::", Part::kBehaviour},
    {"recovery::", Part::kBehaviour},
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
