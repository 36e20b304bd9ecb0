#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/edit/yaml_document.h"
#include "simulation/assembly/controller_parameters.h"

namespace koboshi::studio {

// A number that a user tunes: a parameter of the controller, or a number of a gait file.
struct ParameterInfo {
  std::string key;      // as files name it: step_time_ms, feedback.knee_s
  YamlPath path;        // in its file: parameters.step_time_ms
  std::string group;    // heading above it
  std::string unit;     // empty: without one
  std::string meaning;  // one sentence; may be empty
  std::string effect;   // when a change takes effect: "at once", "within two steps"
  double low = 0.0;
  double high = 0.0;
  // Values are whole multiples of 1 / steps_per_unit: what the controller distinguishes, or for a gait a
  // tenth of a millimetre, a millisecond, a hundredth of a degree.
  double steps_per_unit = 1.0;
  std::optional<double> fallback;                 // of a file without the key; nothing: not set
  const simulation::Parameter* object = nullptr;  // on the bus; null: compiled into the motion of a gait

  std::int64_t steps(double value) const;
  double value(std::int64_t steps) const { return static_cast<double>(steps) / steps_per_unit; }
  // The shortest decimal number that stands for the same step as this value.
  std::string text(double value) const;
  // Whether key, group, unit or meaning contain each word of a search, in any case.
  bool matches(std::string_view words) const;
};

using ParameterTable = std::span<const ParameterInfo>;

// The effect of numbers that are compiled into the storage image.
inline constexpr std::string_view kAtNextStart = "after Start again";

// The parameters of robots/ROBOT/parameters.yaml, by their addresses in the object dictionary.
ParameterTable controller_table();
// The numbers of a gait file, in the order of its reference page.
ParameterTable gait_table();

// Index of a key; nothing if the table lacks it.
std::optional<std::size_t> index_of(ParameterTable table, std::string_view key);

}  // namespace koboshi::studio
