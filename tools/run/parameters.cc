#include "tools/run/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "firmware/app/dictionary.h"
#include "sim_board/input/error.h"

namespace koboshi::tools {
namespace {

// By what name and in what unit people know an object of the controller. Type and range stand in its
// dictionary.
struct Parameter {
  const char* name;
  canopen::ObjectAddress address;
  double raw_per_unit;
};

constexpr double kRatePerRadPerS = 4096.0 / (2.0 * std::numbers::pi);  // 2^-12 turn/s

constexpr Parameter kParameters[] = {
    {"feedback_ankle_pitch_s", {0x2101, 1}, 4096.0},
    {"feedback_ankle_roll_s", {0x2101, 2}, 4096.0},
    {"feedback_hip_roll_s", {0x2101, 3}, 4096.0},
    {"feedback_knee_s", {0x2101, 4}, 4096.0},
    {"supply_min_V", {0x2100, 1}, 1000.0},
    {"supply_max_V", {0x2100, 2}, 1000.0},
    {"ramp_rate_rad_per_s", {0x2100, 3}, kRatePerRadPerS},
};

const canopen::Entry& object_of(const Parameter& parameter) {
  const auto rows = app::kControllerNode.rows;
  return *std::ranges::find_if(rows, [&](const canopen::Entry& row) {
    return row.index == parameter.address.index && row.subindex == parameter.address.subindex;
  });
}

sim::InputError error_at(const sim::SourcedName& name, const std::string& found,
                         const std::string& expected) {
  return {name.source, name.line, found, expected};
}

const Parameter& find(const sim::SourcedName& name) {
  const auto found =
      std::ranges::find_if(kParameters, [&](const Parameter& known) { return name.text == known.name; });
  if (found != std::end(kParameters)) return *found;
  std::string names;
  for (const Parameter& known : kParameters) names += (names.empty() ? "" : ", ") + std::string(known.name);
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
  const Parameter& parameter = find(setting.name);
  const canopen::Entry& object = object_of(parameter);
  const auto [low, high] = range_of(object);
  const double raw = std::round(setting.value * parameter.raw_per_unit);
  if (!(raw >= static_cast<double>(low) && raw <= static_cast<double>(high))) {
    throw error_at(setting.name, fmt::format("{} = {}", parameter.name, setting.value),
                   fmt::format("{:.6g} to {:.6g}", static_cast<double>(low) / parameter.raw_per_unit,
                               static_cast<double>(high) / parameter.raw_per_unit));
  }
  return {.parameter = setting.name,
          .address = parameter.address,
          .size_bytes = canopen::size_bytes(object.type),
          .value = static_cast<std::uint32_t>(static_cast<std::int64_t>(raw))};
}

}  // namespace

std::vector<sim::SdoWrite> resolve_parameters(std::span<const sim::ParameterSetting> settings) {
  std::vector<sim::SdoWrite> writes;
  for (const sim::ParameterSetting& setting : settings) writes.push_back(resolve(setting));
  return writes;
}

}  // namespace koboshi::tools
