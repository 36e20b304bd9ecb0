#include "simulation/assembly/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "firmware/app/controller_objects.h"
#include "simulation/assembly/controller_parameters.h"

namespace koboshi::simulation {
namespace {

InputError error_at(const SourcedName& name, const std::string& found, const std::string& expected) {
  return {name.source, name.line, found, expected};
}

// Parameters that have been renamed. Error messages for the old name give the new one.
struct Renamed {
  std::string_view old_name;
  std::string_view name;
};
constexpr std::array<Renamed, 9> kRenamed{{{"acceleration_of_turn", "acceleration_turn"},
                                           {"acceleration_sideways", "acceleration_lateral"},
                                           {"capture_ahead", "capture_forward"},
                                           {"capture_aside", "capture_lateral"},
                                           {"highest_velocity_sideways", "highest_velocity_lateral"},
                                           {"least_lean_of_a_fall", "smallest_lean_of_a_fall"},
                                           {"swing_ease", "swing_profile"},
                                           {"touch_down_load", "touchdown_load"},
                                           {"zmp_ahead", "zmp_forward"}}};

// Returns whether `text` is the old name of this parameter, with its unit or without.
bool is_old_name(std::string_view text, const Parameter& parameter) {
  const auto renamed = std::ranges::find(kRenamed, parameter.name_without_unit, &Renamed::name);
  if (renamed == kRenamed.end()) return false;
  const std::string unit = parameter.key.substr(parameter.name_without_unit.size());
  return text == renamed->old_name || text == std::string(renamed->old_name) + unit;
}

const Parameter& find(const SourcedName& name) {
  const std::span<const Parameter> parameters = controller_parameters();
  const auto found = std::ranges::find(parameters, name.text, &Parameter::key);
  if (found != parameters.end()) return *found;
  const auto old = std::ranges::find(parameters, name.text, &Parameter::name_without_unit);
  if (old != parameters.end()) throw error_at(name, "parameter " + name.text + " without its unit", old->key);
  const auto renamed = std::ranges::find_if(
      parameters, [&](const Parameter& parameter) { return is_old_name(name.text, parameter); });
  if (renamed != parameters.end())
    throw error_at(name, "parameter " + name.text + ", which has another name now", renamed->key);
  std::vector<std::string> keys;
  for (const Parameter& parameter : parameters) keys.push_back(parameter.key);
  throw error_at(name, "the unknown parameter " + one_line(name.text), expected_names(name.text, keys));
}

SdoWrite resolve(const ParameterSetting& setting) {
  const Parameter& parameter = find(setting.name);
  const double raw_per_unit = parameter.raw_per_unit();
  const auto low = static_cast<double>(parameter.low());
  const auto high = static_cast<double>(parameter.high());
  const double raw = std::round(setting.value * raw_per_unit);
  if (!(raw >= low && raw <= high)) {
    throw InputError(setting.name.source, setting.name.line,
                     fmt::format("{} = {}", setting.name.text, setting.value),
                     fmt::format("{:.6g} to {:.6g} {}", low / raw_per_unit, high / raw_per_unit,
                                 parameter.object->text.unit.name),
                     "the range of " + setting.name.text);
  }
  return {.parameter = setting.name,
          .address = parameter.address(),
          .size_bytes = canopen::size_bytes(parameter.object->entry.type),
          .value = static_cast<std::uint32_t>(static_cast<std::int64_t>(raw))};
}

void set(std::span<const SdoWrite> writes, app::ControllerValues& values) {
  canopen::Dictionary dictionary(app::kControllerNode.rows, std::as_writable_bytes(std::span(&values, 1)));
  for (const SdoWrite& write : writes) {
    canopen::Location location;
    std::uint32_t value = write.value;
    const auto checked = dictionary.check_write(write.address, value, write.size_bytes, location);
    if (checked != canopen::AbortCode::kNone)
      throw std::logic_error("the dictionary refuses " + write.parameter.text);
    dictionary.store(location, value);
  }
}

}  // namespace

std::vector<SdoWrite> resolve_parameters(std::span<const ParameterSetting> settings) {
  std::vector<SdoWrite> writes;
  for (const ParameterSetting& setting : settings) writes.push_back(resolve(setting));
  return writes;
}

app::ControllerValues controller_values(const RobotParameters& parameters) {
  app::ControllerValues values;
  set(resolve_parameters(parameters.settings), values);
  return values;
}

app::ControllerValues controller_values(const Scenario& scenario) {
  app::ControllerValues values = controller_values(scenario.robot_parameters);
  set(resolve_parameters(scenario.parameters), values);
  return values;
}

}  // namespace koboshi::simulation
