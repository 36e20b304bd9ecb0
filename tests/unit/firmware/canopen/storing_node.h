#pragma once

#include <cstddef>
#include <cstdint>

#include "tests/unit/firmware/canopen/test_node.h"

namespace koboshi::canopen {

// Size of the flash, and the signatures that 0x1010 and 0x1011 require.
inline constexpr std::size_t kSectors = 6;
inline constexpr std::uint32_t kSave = 0x6576'6173;
inline constexpr std::uint32_t kLoad = 0x6461'6F6C;

// The rows of TestNode, and one that an RPDO also writes.
inline constexpr Entry kStoringRows[] = {
    object(0x2000, 1, KOBOSHI_FIELD(TestValues, gains[0]), Access::kReadWrite).repeated(3, 4),
    object(0x6040, 0, KOBOSHI_FIELD(TestValues, controlword), Access::kReadWrite, Mappable::kRpdo),
    object(0x6060, 0, KOBOSHI_FIELD(TestValues, mode), Access::kReadWrite, Mappable::kRpdo)
        .within<std::int8_t>(-1, 10)
        .parameter(),
    object(0x6064, 0, KOBOSHI_FIELD(TestValues, position), Access::kReadOnly, Mappable::kTpdo),
    object(0x607A, 0, KOBOSHI_FIELD(TestValues, target), Access::kReadWrite, Mappable::kRpdo),
};

inline constexpr PdoConfiguration kStoringTpdos[] = {
    {.cob_id = kTpdo1Base, .plus_node_id = true, .mapping = {mapping(0x6064, 0, 32)}}};

// A device that stores all groups of its parameters.
inline NodeDescription storing_description() {
  NodeDescription made = kTestDescription;
  made.stored_groups = kAllGroups;
  made.field_device = true;
  made.second_sdo = {0x680, 0x694, true};
  made.rows = kStoringRows;
  made.rpdos = {};
  made.tpdos = kStoringTpdos;
  return made;
}
}  // namespace koboshi::canopen
