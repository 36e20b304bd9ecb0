#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/node/node.h"

namespace koboshi::test {

// A value in an electronic data sheet (CiA 306-1).
struct EdsValue {
  unsigned data_type = 0;
  std::string access;
  std::optional<std::int64_t> low;
  std::optional<std::int64_t> high;
  std::string default_value;  // empty: none
  bool mappable = false;
};

// The values of a data sheet in docs/reference by address, without sub-indices 0 of arrays and records.
using Eds = std::map<canopen::ObjectAddress, EdsValue>;
Eds read_eds(const std::string& name);

// Expects that the node's own rows, and its PDOs after a reset, are those of its data sheet: addresses,
// types, access, limits, mappings and defaults. The data sheet is generated from the same table, so a
// difference is a change of the interface to other programs, which is made on purpose (`koboshi dictionary
// write`) or not at all. Defaults of values in RAM are compared if `values` is not empty.
void expect_described_by(const Eds& eds, const canopen::NodeDescription& node,
                         std::span<const std::byte> values = {});

// Expects that no two sub-indices share a byte of RAM, and that elements of arrays follow each other without
// gaps. `twice` has the offsets of values that two objects show.
void expect_separate_values(std::span<const canopen::Entry> rows, std::span<const std::uint16_t> twice = {});

}  // namespace koboshi::test
