#include "bus/dictionary/communication_area.h"

#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "firmware/canopen/described_object.h"
#include "firmware/canopen/emergency.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/node/device_services.h"
#include "firmware/canopen/pdo.h"
#include "sim_board/drive/pc_sdo.h"

namespace koboshi::bus {
namespace {

using canopen::DataType;
using canopen::PdoConfiguration;

// CiA 301, objects 0x1010 and 0x1011.
constexpr std::string_view kSaveComment = "Write 0x65766173 (\"save\") to keep the values over a reset.";
constexpr std::string_view kLoadComment =
    "Write 0x64616F6C (\"load\"): the values of the program are back after the next reset.";
constexpr canopen::ValueName kErrorBehaviourNames[] = {
    {0, "pre-operational"}, {1, "no change"}, {2, "stopped"}};

std::string hex(std::uint32_t value) { return fmt::format("0x{:08X}", value); }
std::string with_node_id(std::uint32_t value) { return fmt::format("$NODEID+0x{:X}", value); }
std::string decimal(std::size_t value) { return fmt::format("{}", value); }

ObjectItem item(std::uint16_t index, std::uint8_t subindex, std::string_view name, DataType type,
                std::string_view access, std::string default_value = {}) {
  ObjectItem made;
  made.address = {index, subindex};
  made.name = name;
  made.data_type = static_cast<std::uint8_t>(type);
  made.access = access;
  made.default_value = std::move(default_value);
  return made;
}

Object variable(ObjectItem value, std::string_view comment = {}, std::string_view unit = {}) {
  value.comment = comment;
  value.unit.name = unit;
  const std::uint16_t index = value.address.index;
  std::string name = value.name;
  return {index, ObjectType::kVariable, std::move(name), {std::move(value)}, std::string(comment), {}};
}

Object text(std::uint16_t index, std::string_view name, std::string_view value) {
  ObjectItem made = item(index, 0, name, DataType::kUnsigned32, "const", std::string(value));
  made.data_type = kVisibleString;
  return variable(std::move(made));
}

Object record(std::uint16_t index, std::string_view name, std::vector<ObjectItem> items,
              std::string_view comment = {}) {
  items.insert(items.begin(), highest_subindex(index, items.back().address.subindex));
  return {index, ObjectType::kRecord, std::string(name), std::move(items), std::string(comment), {}};
}

// `count` equal values from sub-index 1.
Object array(std::uint16_t index, std::string_view name, std::size_t count, const ObjectItem& element,
             std::string_view comment = {}) {
  Object made{index, ObjectType::kArray, std::string(name), {}, std::string(comment), {}};
  made.items.push_back(highest_subindex(index, static_cast<std::uint8_t>(count)));
  for (std::size_t i = 1; i <= count; ++i) {
    ObjectItem value = element;
    value.address = {index, static_cast<std::uint8_t>(i)};
    value.name = fmt::format("{} {}", element.name, i);
    value.family = element.name;
    made.items.push_back(std::move(value));
  }
  return made;
}

Object error_history() {
  Object made = array(0x1003, "Pre-defined error field", canopen::ErrorLog::kHistory,
                      item(0x1003, 1, "Standard error field", DataType::kUnsigned32, "ro"),
                      "The newest first: error code in bits 0 to 15.");
  made.items.front() = item(0x1003, 0, "Number of errors", DataType::kUnsigned8, "rw", "0");
  made.items.front().comment = "Writing 0 erases the list.";
  return made;
}

Object stored_parameters(std::uint16_t index, std::string_view name, std::string_view verb,
                         std::string_view comment) {
  std::vector<ObjectItem> items;
  std::uint8_t subindex = 1;
  for (const std::string_view part : {"all", "communication", "application", "manufacturer"}) {
    const std::string item_name = fmt::format("{} {} parameters", verb, part);
    items.push_back(item(index, subindex++, item_name, DataType::kUnsigned32, "rw"));
  }
  Object made = record(index, name, std::move(items), comment);
  made.type = ObjectType::kArray;
  return made;
}

Object identity(const canopen::NodeDescription& node) {
  return record(0x1018, "Identity object",
                {item(0x1018, 1, "Vendor-ID", DataType::kUnsigned32, "ro", hex(node.vendor_id)),
                 item(0x1018, 2, "Product code", DataType::kUnsigned32, "ro", hex(node.product_code)),
                 item(0x1018, 3, "Revision number", DataType::kUnsigned32, "ro", hex(node.revision_number)),
                 item(0x1018, 4, "Serial number", DataType::kUnsigned32, "ro")});
}

Object sync_counter() {
  ObjectItem value = item(0x1019, 0, "Synchronous counter overflow value", DataType::kUnsigned8, "rw", "0");
  value.limits = {0, 240};
  return variable(std::move(value), "0: SYNC carries no counter; else 2 to 240.");
}

// Only drives and sensors have these two objects.
Object time_stamp() {
  return variable(item(0x1012, 0, "COB-ID time stamp object", DataType::kUnsigned32, "rw",
                       hex(canopen::kTimeConsumer | canopen::kTimeCobId)),
                  "Of drives and sensors. Bit 31: the node takes the time of day from it.");
}

Object verify_configuration() {
  Object made =
      record(0x1020, "Verify configuration",
             {item(0x1020, 1, "Configuration date", DataType::kUnsigned32, "rw", "0"),
              item(0x1020, 2, "Configuration time", DataType::kUnsigned32, "rw", "0")},
             "Of drives and sensors. Written by a configuration tool; 0 when a parameter has changed since.");
  made.items[1].unit.name = "d";
  made.items[1].comment = "Days since 1984-01-01.";
  made.items[2].unit.name = "ms";
  made.items[2].comment = "After midnight.";
  made.type = ObjectType::kArray;
  return made;
}

Object error_behaviour(canopen::CommunicationError behaviour) {
  ObjectItem value = item(0x1029, 1, "Communication error", DataType::kUnsigned8, "rw",
                          decimal(static_cast<std::uint8_t>(behaviour)));
  value.limits = {0, 2};
  value.comment = "0: pre-operational; 1: no change; 2: stopped.";
  value.values = kErrorBehaviourNames;
  Object made =
      record(0x1029, "Error behaviour", {value},
             "The state that a node in operational goes to when a heartbeat is lost or the bus is off.");
  made.type = ObjectType::kArray;
  return made;
}

Object sdo_server() {
  return record(0x1200, "SDO server parameter",
                {item(0x1200, 1, "COB-ID client to server", DataType::kUnsigned32, "ro",
                      with_node_id(canopen::kSdoRequestBase)),
                 item(0x1200, 2, "COB-ID server to client", DataType::kUnsigned32, "ro",
                      with_node_id(canopen::kSdoResponseBase))});
}

std::string second_sdo_comment() {
  std::string comment =
      "A channel for a second client, beside the first and independent of it; bit 31: it is not in use. "
      "After a "
      "reset only drives have it in use:";
  for (const sim_board::PcSdoRange& range : sim_board::kPcSdoRanges) {
    comment += fmt::format(" nodes {} to {} $NODEID+0x{:X} and $NODEID+0x{:X}{}", range.first_node,
                           range.first_node + sim_board::kPcSdoNodes - 1, range.request_base,
                           range.response_base, &range == &sim_board::kPcSdoRanges.back() ? "." : ",");
  }
  return comment;
}

// Without a default value where it depends on the node id by more than a sum ($NODEID and an offset, CiA
// 306-1): a drive's channel by the range of its node id.
Object second_sdo_server(const canopen::SdoChannel& channel) {
  const auto cob_id = [&](std::uint32_t value) { return channel.plus_node_id ? std::string() : hex(value); };
  return record(0x1201, "SDO server parameter",
                {item(0x1201, 1, "COB-ID client to server", DataType::kUnsigned32, "rw",
                      cob_id(channel.request_cob_id)),
                 item(0x1201, 2, "COB-ID server to client", DataType::kUnsigned32, "rw",
                      cob_id(channel.response_cob_id)),
                 item(0x1201, 3, "Node-ID of the SDO client", DataType::kUnsigned8, "rw")},
                second_sdo_comment());
}

// The stack answers no remote frames; bit 30 of every TPDO says so after a reset.
std::string cob_id(const PdoConfiguration& pdo, bool transmit) {
  const std::uint32_t value = pdo.cob_id | (transmit ? canopen::kCobIdNoRemote : 0u);
  return pdo.plus_node_id ? with_node_id(value) : hex(value);
}

Object pdo_communication(std::uint16_t index, std::string_view family, std::size_t number,
                         const PdoConfiguration& pdo, bool transmit) {
  std::vector<ObjectItem> items{
      item(index, 1, "COB-ID", DataType::kUnsigned32, "rw", cob_id(pdo, transmit)),
      item(index, 2, "Transmission type", DataType::kUnsigned8, "rw", decimal(pdo.transmission_type))};
  items[0].comment =
      transmit ? "Bit 31: the PDO is not in use. Bit 30 is kept but has no effect: remote frames are "
                 "never answered."
               : "Bit 31: the PDO is not in use.";
  items[1].comment = transmit ? "0: the SYNC after a change of a value; 1 to 240: every n-th SYNC; 254, 255: "
                                "the change, or of 254 the event timer where it is set."
                              : "0 to 240: at the next SYNC; 254, 255: at once.";
  if (transmit) {
    items.push_back(
        item(index, 3, "Inhibit time", DataType::kUnsigned16, "rw", decimal(pdo.inhibit_time_100us)));
    items.back().unit = {"ms", 1, 10};
  }
  items.push_back(item(index, 5, "Event timer", DataType::kUnsigned16, "rw", decimal(pdo.event_timer_ms)));
  items.back().unit = {"ms"};
  if (transmit) {
    items.push_back(item(index, 6, "SYNC start value", DataType::kUnsigned8, "rw", decimal(pdo.sync_start)));
    items.back().comment = "0: the counter of SYNC does not matter.";
  } else {
    items.back().comment =
        "0: none. Longer silence after a reception is error 8250. That of the controller's velocity, 1401, "
        "is "
        "the deadline of a walk, which ends when no velocity has come for so long, by PDO or SDO.";
  }
  Object made = record(index, fmt::format("{} {}", family, number + 1), std::move(items));
  made.family = family;
  return made;
}

Object pdo_mapping(std::uint16_t index, std::string_view family, std::size_t number,
                   const PdoConfiguration& pdo) {
  Object made = array(index, fmt::format("{} {}", family, number + 1), canopen::kMaxMappedObjects,
                      item(index, 1, "Mapped object", DataType::kUnsigned32, "rw"));
  made.type = ObjectType::kRecord;  // PDO_MAPPING, CiA 301 7.5.2.36
  made.family = family;
  std::size_t count = 0;
  for (std::size_t i = 0; i < canopen::kMaxMappedObjects; ++i) {
    if (pdo.mapping[i] != 0) count = i + 1;
    made.items[i + 1].default_value = hex(pdo.mapping[i]);
    made.items[i + 1].comment = "Index, sub-index and length in bits.";
  }
  made.items.front() = item(index, 0, "Number of mapped objects", DataType::kUnsigned8, "rw", decimal(count));
  return made;
}

struct PdoIndices {
  std::uint16_t communication;
  std::uint16_t mapping;
  bool transmit;
};

// PDOs beyond the configured ones are invalid after a reset.
void add_pdos(std::vector<Object>& objects, std::string_view name, const PdoIndices& first,
              std::span<const PdoConfiguration> configured, std::size_t count) {
  const auto configuration = [&](std::size_t i) {
    return i < configured.size() ? configured[i] : PdoConfiguration{};
  };
  for (std::size_t i = 0; i < count; ++i) {
    objects.push_back(pdo_communication(static_cast<std::uint16_t>(first.communication + i),
                                        fmt::format("{} communication parameter", name), i, configuration(i),
                                        first.transmit));
  }
  for (std::size_t i = 0; i < count; ++i) {
    objects.push_back(pdo_mapping(static_cast<std::uint16_t>(first.mapping + i),
                                  fmt::format("{} mapping parameter", name), i, configuration(i)));
  }
}

std::vector<PdoConfiguration> joined(std::span<const PdoConfiguration> first,
                                     std::span<const PdoConfiguration> second) {
  std::vector<PdoConfiguration> all(first.begin(), first.end());
  all.insert(all.end(), second.begin(), second.end());
  return all;
}

// Entries beyond `configured` are not in use.
Object heartbeat_consumers(std::size_t count, std::span<const std::uint32_t> configured) {
  Object made = array(0x1016, "Consumer heartbeat time", count,
                      item(0x1016, 1, "Consumer heartbeat time", DataType::kUnsigned32, "rw", hex(0)),
                      "Bits 16 to 23: the node; 0 to 15: ms.");
  for (std::size_t i = 0; i < configured.size(); ++i) made.items[i + 1].default_value = hex(configured[i]);
  return made;
}

void add_services(std::vector<Object>& objects, const canopen::NodeDescription& node) {
  const std::uint32_t sync = canopen::kSyncCobId | (node.sync_producer ? canopen::kSyncProducer : 0u);
  objects.push_back(
      variable(item(0x1000, 0, "Device type", DataType::kUnsigned32, "ro", hex(node.device_type))));
  objects.push_back(variable(item(0x1001, 0, "Error register", DataType::kUnsigned8, "ro"),
                             "Bit 0: any error; 1: current; 2: voltage; 3: temperature; 4: communication; "
                             "5: of the profile; 7: of the manufacturer."));
  objects.push_back(error_history());
  objects.push_back(variable(item(0x1005, 0, "COB-ID SYNC message", DataType::kUnsigned32, "rw", hex(sync)),
                             "Bit 30: the node produces SYNC."));
  objects.push_back(variable(item(0x1006, 0, "Communication cycle period", DataType::kUnsigned32, "rw",
                                  decimal(node.sync_period_us)),
                             "SYNC period; 0: no SYNC. The controller accepts only 0 and its own cycle.",
                             "us"));
  objects.push_back(variable(item(0x1007, 0, "Synchronous window length", DataType::kUnsigned32, "rw", "0"),
                             "0: as long as the cycle.", "us"));
  objects.push_back(text(0x1008, "Manufacturer device name", node.device_name));
  objects.push_back(text(0x1009, "Manufacturer hardware version", node.hardware_version));
  objects.push_back(text(0x100A, "Manufacturer software version", node.software_version));
  objects.push_back(stored_parameters(0x1010, "Store parameters", "Save", kSaveComment));
  objects.push_back(stored_parameters(0x1011, "Restore default parameters", "Restore", kLoadComment));
  if (node.field_device) objects.push_back(time_stamp());
  objects.push_back(variable(
      item(0x1014, 0, "COB-ID EMCY", DataType::kUnsigned32, "rw", with_node_id(canopen::kEmergencyBase))));
  objects.push_back(variable(item(0x1015, 0, "Inhibit time EMCY", DataType::kUnsigned16, "rw", "0"),
                             "Minimum time between two messages.", "100 us"));
}

}  // namespace

ObjectItem highest_subindex(std::uint16_t index, std::uint8_t highest) {
  return item(index, 0, "Highest sub-index supported", DataType::kUnsigned8, "const", decimal(highest));
}

std::vector<Object> communication_area(const canopen::NodeDescription& node, const NodeCapacity& capacity,
                                       const InstanceDefaults& instance) {
  std::vector<Object> objects;
  add_services(objects, node);
  objects.push_back(heartbeat_consumers(capacity.heartbeat_consumers, instance.heartbeat_consumers));
  objects.push_back(variable(
      item(0x1017, 0, "Producer heartbeat time", DataType::kUnsigned16, "rw", decimal(node.heartbeat_ms)),
      "0: none.", "ms"));
  objects.push_back(identity(node));
  objects.push_back(sync_counter());
  if (node.field_device) objects.push_back(verify_configuration());
  objects.push_back(error_behaviour(node.communication_error));
  objects.push_back(sdo_server());
  objects.push_back(second_sdo_server(node.second_sdo));
  add_pdos(objects, "RPDO", {0x1400, 0x1600, false}, joined(node.rpdos, instance.rpdos), capacity.rpdos);
  add_pdos(objects, "TPDO", {0x1800, 0x1A00, true}, joined(node.tpdos, instance.tpdos), capacity.tpdos);
  return objects;
}

}  // namespace koboshi::bus
