#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/canopen/described_object.h"
#include "firmware/canopen/node/node.h"

namespace koboshi::bus {

// The object dictionary of a kind of node, as in CiA 306: the objects of its own table and those of the
// communication profile area, which the CANopen stack serves.

inline constexpr std::uint8_t kVisibleString = 0x09;  // data type, CiA 301 table 44

enum class ObjectType : std::uint8_t { kVariable = 7, kArray = 8, kRecord = 9 };

struct ValueLimits {
  std::int64_t low = 0;
  std::int64_t high = 0;
};

// A value: an index without sub-indices, or one of its sub-indices.
struct ObjectItem {
  canopen::ObjectAddress address;
  std::string name;
  std::uint8_t data_type = 0;  // a canopen::DataType, or kVisibleString
  std::string access;          // in the terms of an EDS: const, ro, rw, or rww if an RPDO may write it
  canopen::Mappable mappable = canopen::Mappable::kNo;
  // In the notation of an EDS, `$NODEID+0x180`; empty if nodes differ or the value is measured.
  std::string default_value;
  std::optional<ValueLimits> limits;
  canopen::Unit unit;
  std::span<const canopen::ValueName> values;
  std::string comment;
  std::string family;  // common name of consecutive items that differ only in their number; else empty
};

struct Object {
  std::uint16_t index = 0;
  ObjectType type = ObjectType::kVariable;
  std::string name;
  std::vector<ObjectItem> items;  // including sub-index 0, if there are sub-indices
  std::string comment;
  std::string family;  // common name of consecutive objects that differ only in their number; else empty
};

// Numbers of services that the node's stack has room for.
struct NodeCapacity {
  std::size_t rpdos = 0;
  std::size_t tpdos = 0;
  std::size_t heartbeat_consumers = 0;
};

// Settings that a node makes in each reset, in addition to its description.
struct InstanceDefaults {
  std::vector<canopen::PdoConfiguration> rpdos;  // after the description's
  std::vector<canopen::PdoConfiguration> tpdos;
  std::vector<std::uint32_t> heartbeat_consumers;  // 0x1016, from sub-index 1
};

struct NodeKind {
  std::string name;
  canopen::NodeDescription description;
  NodeCapacity capacity;
  std::vector<Object> objects;  // ascending

  // Null if there is none.
  const ObjectItem* find(canopen::ObjectAddress address) const;
};

// All objects of a kind of node. `values` are those that the table's rows have after a reset.
NodeKind make_node_kind(std::string name, const canopen::NodeDescription& description,
                        const NodeCapacity& capacity, std::span<const canopen::DescribedObject> table,
                        std::span<const std::byte> values, const InstanceDefaults& instance = {});

// 8, 16, 32; 0 for a text.
unsigned size_bits(std::uint8_t data_type);
bool is_signed(std::uint8_t data_type);
// Formats a unit: 360/65536 deg, or for a sensor's counts its unit alone.
std::string unit_text(const canopen::Unit& unit);
// INTEGER16, as CiA 301 writes it.
std::string data_type_name(std::uint8_t data_type);

}  // namespace koboshi::bus
