#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/dictionary.h"
#include "firmware/canopen/described_object.h"

namespace koboshi::simulation {

struct NodeKind;

// A writable object of the controller, or an element of one, with its name in scenarios and studies.
struct Parameter {
  std::string key = {};                       // name with its unit (parameter_keys.h): com_height_mm
  std::string name_without_unit = {};         // name in older files: com_height
  const canopen::DescribedObject* object{};   // provides type, range and unit
  const canopen::DescribedObject* heading{};  // of its index; null for an index without sub-indices
  std::uint8_t element = 0;

  canopen::ObjectAddress address() const;
  double raw_per_unit() const;
  // Lowest value that the controller accepts, in wire units.
  std::int64_t low() const;
  std::int64_t high() const;
  // When a written value takes effect: "at once", "within two steps".
  std::string_view effect() const;
  // Converts a value from the unit of the key to the nearest one on the wire, and back. The range is not
  // checked.
  std::int64_t raw(double value) const;
  double value(std::int64_t raw) const;
};

// All parameters, sorted by key.
std::span<const Parameter> controller_parameters();

// Returns a parameter's value in a dictionary, in the unit of its key; nothing if it is not set.
std::optional<double> value_in(const app::ControllerValues& values, const Parameter& parameter);

// Returns the suffix of a key for a unit of the dictionary: "mm/s^2" becomes "mm_per_s2", "%" becomes
// "percent". Empty for a number without a unit.
std::string unit_suffix(std::string_view unit);

}  // namespace koboshi::simulation
