#include "tools/run/parameters.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <string>

#include "firmware/app/controller_objects.h"
#include "sim_board/input/error.h"

namespace koboshi::tools {
namespace {

// An object of the controller that a client may write, or one element of it; type, range and unit stand in
// its dictionary.
struct Parameter {
  const canopen::DescribedObject* object;
  std::uint8_t element;
};

// As the dictionary names it, in small letters and without blanks.
std::string parameter_name(const canopen::DescribedObject& object, std::size_t element) {
  std::string name(object.text.name);
  if (object.entry.count > 1) name.append(" ").append(object.text.elements[element]);
  for (char& c : name) {
    c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? static_cast<char>(std::tolower(c)) : '_';
  }
  return name;
}

const std::map<std::string, Parameter>& parameters() {
  static const auto kByName = [] {
    std::map<std::string, Parameter> by_name;
    for (const canopen::DescribedObject& object : app::kControllerObjects) {
      if (object.is_heading() || object.entry.access != canopen::Access::kReadWrite) continue;
      if (object.entry.count > 1 && object.text.elements.empty()) continue;
      for (std::uint8_t element = 0; element < object.entry.count; ++element) {
        by_name.emplace(parameter_name(object, element), Parameter{&object, element});
      }
    }
    return by_name;
  }();
  return kByName;
}

sim::InputError error_at(const sim::SourcedName& name, const std::string& found,
                         const std::string& expected) {
  return {name.source, name.line, found, expected};
}

Parameter find(const sim::SourcedName& name) {
  const auto found = parameters().find(name.text);
  if (found != parameters().end()) return found->second;
  std::string names;
  for (const auto& [known, parameter] : parameters()) names += (names.empty() ? "" : ", ") + known;
  throw error_at(name, "parameter " + name.text, "one of " + names);
}

struct Range {
  std::int64_t low;
  std::int64_t high;
};

Range range_of(const canopen::Entry& object) {
  const int bits = 8 * canopen::size_bytes(object.type);
  const bool is_signed = canopen::is_signed(object.type);
  if (object.limited && is_signed) {
    return {static_cast<std::int32_t>(object.low), static_cast<std::int32_t>(object.high)};
  }
  if (object.limited) return {object.low, object.high};
  const std::int64_t half = std::int64_t{1} << (bits - 1);
  return is_signed ? Range{-half, half - 1} : Range{0, 2 * half - 1};
}

sim::SdoWrite resolve(const sim::ParameterSetting& setting) {
  const auto [described, element] = find(setting.name);
  const canopen::Entry& object = described->entry;
  const canopen::Unit& unit = described->text.unit;
  const auto [low, high] = range_of(object);
  const double raw_per_unit = static_cast<double>(unit.denominator) / unit.numerator;
  const double raw = std::round(setting.value * raw_per_unit);
  if (!(raw >= static_cast<double>(low) && raw <= static_cast<double>(high))) {
    throw error_at(setting.name, fmt::format("{} = {}", setting.name.text, setting.value),
                   fmt::format("{:.6g} to {:.6g} {}", static_cast<double>(low) / raw_per_unit,
                               static_cast<double>(high) / raw_per_unit, unit.name));
  }
  return {.parameter = setting.name,
          .address = {object.index, static_cast<std::uint8_t>(object.subindex + element)},
          .size_bytes = canopen::size_bytes(object.type),
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
