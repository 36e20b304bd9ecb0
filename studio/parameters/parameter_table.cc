#include "studio/parameters/parameter_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/text/text.h"
#include "firmware/app/controller_objects.h"
#include "simulation/gait/gait_keys.h"

namespace koboshi::studio {
namespace {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return lower;
}

ParameterInfo info_of(const simulation::Parameter& parameter) {
  const canopen::ObjectText& text = parameter.object->text;
  return {.key = parameter.key,
          .path = YamlPath(std::vector<std::string>{"parameters", parameter.key}),
          .group = std::string(parameter.heading != nullptr ? parameter.heading->text.name : text.name),
          .unit = std::string(text.unit.name),
          .meaning = std::string(text.comment),
          .effect = std::string(parameter.effect()),
          .low = parameter.value(parameter.low()),
          .high = parameter.value(parameter.high()),
          .steps_per_unit = parameter.raw_per_unit(),
          .fallback = simulation::value_in(app::ControllerValues(), parameter),
          .object = &parameter};
}

std::vector<ParameterInfo> make_controller_table() {
  std::vector<ParameterInfo> table;
  // The start-up of the network belongs to the network, not to the robot's file.
  for (const simulation::Parameter& parameter : simulation::controller_parameters())
    if (parameter.address().index != app::kNmtStartupObject) table.push_back(info_of(parameter));
  std::ranges::sort(table, {}, [](const ParameterInfo& info) {
    const canopen::ObjectAddress address = info.object->address();
    return std::pair(address.index, address.subindex);
  });
  return table;
}

constexpr std::string_view kFeedback = "feedback.";

// The gains of a gait's feedback are objects of the controller: ankle_pitch_s is ankle_pitch_gain_s.
const simulation::Parameter* object_of(const simulation::GaitKey& key) {
  if (!key.key.starts_with(kFeedback)) return nullptr;
  std::string name(key.key.substr(kFeedback.size()));
  name.insert(name.rfind("_s"), "_gain");
  const auto parameters = simulation::controller_parameters();
  const auto found = std::ranges::find(parameters, name, &simulation::Parameter::key);
  return found == parameters.end() ? nullptr : &*found;
}

double gait_steps_per_unit(const simulation::GaitKey& key) {
  if (const simulation::Parameter* object = object_of(key)) return object->raw_per_unit();
  if (key.is_integer) return 1.0;
  if (key.unit == "m") return 1e4;
  return key.unit == "s" ? 1e3 : 1e2;
}

std::vector<ParameterInfo> make_gait_table() {
  std::vector<ParameterInfo> table;
  for (const simulation::GaitKey& key : simulation::gait_keys()) {
    const simulation::Parameter* object = object_of(key);
    table.push_back({.key = std::string(key.key),
                     .path = YamlPath(key.key),
                     .group = object != nullptr ? "Gyro feedback of the gait" : "Gait",
                     .unit = std::string(key.unit),
                     .meaning = std::string(key.meaning),
                     .effect = std::string(object != nullptr ? object->effect() : kAtNextStart),
                     .low = key.min,
                     .high = key.max,
                     .steps_per_unit = gait_steps_per_unit(key),
                     .fallback = key.fallback,
                     .object = object});
  }
  return table;
}

}  // namespace

std::int64_t ParameterInfo::steps(double value) const { return std::llround(value * steps_per_unit); }

std::string ParameterInfo::text(double value) const {
  const std::int64_t wanted = steps(value);
  constexpr int kMaxDecimals = 9;
  for (int decimals = 0; decimals < kMaxDecimals; ++decimals) {
    // Through the number, because 0.50 is written 0.5.
    const std::string rounded = fmt::format("{:.{}f}", value, decimals);
    const double number = *parse_number(rounded);
    if (steps(number) == wanted && number >= low && number <= high) return koboshi::number_text(number + 0.0);
  }
  return koboshi::number_text(value);
}

bool ParameterInfo::matches(std::string_view words) const {
  const std::string text = lower_case(key + ' ' + group + ' ' + unit + ' ' + meaning);
  std::istringstream search(lower_case(words));
  for (std::string word; search >> word;)
    if (text.find(word) == std::string::npos) return false;
  return true;
}

ParameterTable controller_table() {
  static const std::vector<ParameterInfo> kTable = make_controller_table();
  return kTable;
}

ParameterTable gait_table() {
  static const std::vector<ParameterInfo> kTable = make_gait_table();
  return kTable;
}

std::optional<std::size_t> index_of(ParameterTable table, std::string_view key) {
  const auto found = std::ranges::find(table, key, &ParameterInfo::key);
  if (found == table.end()) return std::nullopt;
  return static_cast<std::size_t>(found - table.begin());
}

}  // namespace koboshi::studio
