#include "tools/run/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "firmware/app/controller_objects.h"
#include "sim_board/input/error.h"
#include "sim_board/input/text.h"
#include "tools/dictionary/parameters.h"

namespace koboshi::tools {
namespace {

sim::InputError error_at(const sim::SourcedName& name, const std::string& found,
                         const std::string& expected) {
  return {name.source, name.line, found, expected};
}

const Parameter& find(const sim::SourcedName& name) {
  const std::span<const Parameter> parameters = controller_parameters();
  const auto found = std::ranges::find(parameters, name.text, &Parameter::key);
  if (found != parameters.end()) return *found;
  const auto old = std::ranges::find(parameters, name.text, &Parameter::name_without_unit);
  if (old != parameters.end()) throw error_at(name, "parameter " + name.text + " without its unit", old->key);
  std::vector<std::string> keys;
  for (const Parameter& parameter : parameters) keys.push_back(parameter.key);
  throw error_at(name, "the unknown parameter " + sim::one_line(name.text),
                 sim::expected_names(name.text, keys));
}

sim::SdoWrite resolve(const sim::ParameterSetting& setting) {
  const Parameter& parameter = find(setting.name);
  const double raw_per_unit = parameter.raw_per_unit();
  const auto low = static_cast<double>(parameter.low());
  const auto high = static_cast<double>(parameter.high());
  const double raw = std::round(setting.value * raw_per_unit);
  if (!(raw >= low && raw <= high)) {
    throw sim::InputError(setting.name.source, setting.name.line,
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

}  // namespace

std::vector<sim::SdoWrite> resolve_parameters(std::span<const sim::ParameterSetting> settings) {
  std::vector<sim::SdoWrite> writes;
  for (const sim::ParameterSetting& setting : settings) writes.push_back(resolve(setting));
  return writes;
}

walk::VelocityLimits velocity_limits(const sim::Scenario& scenario) {
  walk::VelocityLimits limits;
  const std::array fields{&limits.forward_mm_per_s, &limits.backward_mm_per_s, &limits.sideways_mm_per_s,
                          &limits.turn_mrad_per_s};
  for (const sim::SdoWrite& write : resolve_parameters(scenario.parameters)) {
    if (write.address.index != app::kVelocityLimitsObject) continue;
    *fields.at(write.address.subindex - 1u) = static_cast<std::int16_t>(write.value);
  }
  return limits;
}

}  // namespace koboshi::tools
