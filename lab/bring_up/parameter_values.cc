#include "lab/bring_up/parameter_values.h"

#include <algorithm>
#include <utility>

namespace koboshi::lab {
namespace {

using simulation::ParameterSetting;
using simulation::RobotParameters;

}  // namespace

const double* find_value(const RobotParameters& parameters, std::string_view key) {
  const auto found = std::ranges::find(
      parameters.settings, key,
      [](const ParameterSetting& setting) -> std::string_view { return setting.name.text; });
  return found == parameters.settings.end() ? nullptr : &found->value;
}

double* find_value(RobotParameters& parameters, std::string_view key) {
  return const_cast<double*>(find_value(std::as_const(parameters), key));
}

double value_or(const RobotParameters& parameters, std::string_view key, double otherwise) {
  const double* value = find_value(parameters, key);
  return value == nullptr ? otherwise : *value;
}

void multiply_value(RobotParameters& parameters, std::string_view key, double factor) {
  if (double* value = find_value(parameters, key)) *value *= factor;
}

void set_value(RobotParameters& parameters, const std::string& key, double value) {
  if (double* present = find_value(parameters, key)) {
    *present = value;
  } else {
    parameters.settings.push_back({{key, parameters.file, 0}, value});
  }
}

}  // namespace koboshi::lab
