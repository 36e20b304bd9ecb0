#pragma once

#include <cstdint>
#include <vector>

#include "bus/dictionary/object_dictionary.h"

namespace koboshi::bus {

// The objects 0x1000..0x1FFF of a node (CiA 301, 7.5.2) with their defaults, ascending. The CANopen stack
// serves them from its state, without a table; tests/unit/bus/dictionary compares this list with the stack.
std::vector<Object> communication_area(const canopen::NodeDescription& description,
                                       const NodeCapacity& capacity, const InstanceDefaults& instance);

// Sub-index 0 of an array or record.
ObjectItem highest_subindex(std::uint16_t index, std::uint8_t highest);

}  // namespace koboshi::bus
