#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/dictionary.h"
#include "firmware/canopen/described_object.h"

namespace koboshi::simulation {

struct NodeKind;

// An object of the controller that a client may write, or one element of it, as scenarios and studies name
// it.
struct Parameter {
  std::string key;                           // with its unit: com_height_mm
  std::string name_without_unit;             // as older files have it: com_height
  const canopen::DescribedObject* object{};  // type, range and unit stand in its dictionary
  std::uint8_t element = 0;

  canopen::ObjectAddress address() const;
  double raw_per_unit() const;
  // What the controller accepts, in counts of the wire.
  std::int64_t low() const;
  std::int64_t high() const;
};

// All of them, by key.
std::span<const Parameter> controller_parameters();

// The part of a key that names a unit of the dictionary: "mm/s^2" becomes "mm_per_s2", "%" "percent"; empty
// for a number without unit.
std::string unit_suffix(std::string_view unit);

}  // namespace koboshi::simulation
