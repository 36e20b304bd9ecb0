#include "bus/dictionary/formats.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "firmware/drive/configuration.h"
#include "sim_board/sensor/sensor_node.h"

namespace koboshi::bus {
namespace {

using Text = std::back_insert_iterator<std::string>;

constexpr std::string_view kIntroduction =
    R"(# Object dictionary

This page lists every object that can be read or written over SDO or in PDOs: of the controller (node 1),
the servo drives (16 to 35, CiA 402) and the sensors (36 to 38). `koboshi dictionary write` generates it from
the tables from which the nodes themselves are built: `firmware/app/controller_objects.h`,
`sim_board/drive/drive_objects.h` and `sim_board/sensor/sensor_objects.h`.

The same objects in formats for other programs: [controller.eds](controller.eds), [drive.eds](drive.eds),
[inertial.eds](inertial.eds), [ankle.eds](ankle.eds), [cells.eds](cells.eds) and [switch.eds](switch.eds)
(CiA 306), and [koboshi.dbc](koboshi.dbc) with every
message on the bus. Another CANopen master reads the drives and sensors from these and from
[bus.yml](bus.yml) ([how](../guide/another-master.md)).

Indices, sub-indices and identifiers are hexadecimal: index 2130 is 0x2130. A value on the bus is a count of
its *unit*: with 0.1 %, 123 means 12.3 %. The column *PDO* states where the object may be mapped. Sub-index 0
of an index with several sub-indices contains the highest of them, in a mapping the number of mapped objects.
`const` and `ro` are read only; `rww` may be written by SDO and by an RPDO.
)";

constexpr std::uint16_t kFirstOwnIndex = canopen::kFirstOwnersIndex;

// Named values; the page shows each table once.
using ValueTable = std::span<const canopen::ValueName>;

std::string bounds(const ObjectItem& item) {
  return item.limits ? fmt::format("{} to {}", item.limits->low, item.limits->high) : std::string();
}

constexpr const char* kPdoNames[] = {"", "TPDO", "RPDO", "both"};  // by canopen::Mappable

void add_item(std::string& page, const ObjectItem& item, std::string_view index, std::string_view subindex,
              std::string_view name, std::string_view default_value) {
  fmt::format_to(Text(page), "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", index, subindex, name,
                 data_type_name(item.data_type), item.access,
                 kPdoNames[static_cast<std::size_t>(item.mappable)], default_value, bounds(item),
                 unit_text(item.unit), item.comment);
}

// Sub-index 0 is shown only if it can be written.
bool is_plain_count(const ObjectItem& item) { return item.address.subindex == 0 && item.access == "const"; }

void add_items(std::string& page, const Object& object) {
  for (auto first = object.items.begin(); first != object.items.end();) {
    const auto end = first->family.empty()
                         ? first + 1
                         : std::find_if(first, object.items.end(),
                                        [&](const ObjectItem& item) { return item.family != first->family; });
    const ObjectItem& last = *(end - 1);
    if (first + 1 == end) {
      if (!is_plain_count(*first)) {
        add_item(page, *first, "", fmt::format("{:X}", first->address.subindex), first->name,
                 first->default_value);
      }
    } else {
      const bool alike = std::all_of(
          first, end, [&](const ObjectItem& item) { return item.default_value == first->default_value; });
      add_item(page, *first, "", fmt::format("{:X} to {:X}", first->address.subindex, last.address.subindex),
               first->family, alike ? first->default_value : std::string());
    }
    first = end;
  }
}

void add_object_row(std::string& page, const Object& object) {
  const std::string index = fmt::format("{:04X}", object.index);
  if (object.type == ObjectType::kVariable) {
    ObjectItem item = object.items.front();
    if (item.comment.empty()) item.comment = object.comment;
    return add_item(page, item, index, "", item.name, item.default_value);
  }
  fmt::format_to(Text(page), "| {} | | **{}** | | | | | | | {} |\n", index, object.name, object.comment);
  add_items(page, object);
}

// Records of PDOs, as one family: the node's chapter says how many there are.
void add_family(std::string& page, const Object& first) {
  fmt::format_to(Text(page), "| {:04X} ... | | **{}** | | | | | | | One record for each PDO. |\n",
                 first.index, first.family);
  Object shown = first;
  for (ObjectItem& item : shown.items) item.default_value.clear();
  add_items(page, shown);
}

// All objects with from <= index < end.
void add_objects(std::string& page, std::span<const Object> objects, std::uint16_t from, std::uint16_t end) {
  page +=
      "| index | sub | name | type | access | PDO | default | range | unit | |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  std::string family;
  for (const Object& object : objects) {
    if (object.index < from || object.index >= end) continue;
    if (object.family.empty()) {
      add_object_row(page, object);
    } else if (object.family != family) {
      add_family(page, object);
    }
    family = object.family;
  }
}

// The objects of all kinds in the communication profile area, by index.
std::vector<Object> common_objects(std::span<const NodeKind> kinds) {
  std::map<std::uint16_t, Object> found;
  for (const NodeKind& kind : kinds) {
    for (const Object& object : kind.objects) {
      if (object.index < kFirstOwnIndex) found.try_emplace(object.index, object);
    }
  }
  std::vector<Object> objects;
  for (auto& [index, object] : found) objects.push_back(std::move(object));
  return objects;
}

// Adds the communication profile area once for all kinds, with the defaults that all share.
void add_common_objects(std::string& page, std::span<const NodeKind> kinds) {
  std::vector<Object> objects = common_objects(kinds);
  for (Object& object : objects) {
    for (ObjectItem& item : object.items) {
      const bool shared = std::all_of(kinds.begin(), kinds.end(), [&](const NodeKind& kind) {
        const ObjectItem* same = kind.find(item.address);
        return same == nullptr || same->default_value == item.default_value;
      });
      if (!shared) item.default_value.clear();
    }
  }
  page += "\n## Every node\n\n";
  add_objects(page, objects, 0x1000, kFirstOwnIndex);
}

void add_identity(std::string& page, const NodeKind& kind) {
  const canopen::NodeDescription& node = kind.description;
  const NodeCapacity& capacity = kind.capacity;
  fmt::format_to(Text(page),
                 "\"{}\": device type 0x{:08X}, vendor 0x{:08X}, product 0x{:08X}, revision 0x{:08X}, ",
                 node.device_name, node.device_type, node.vendor_id, node.product_code, node.revision_number);
  fmt::format_to(Text(page), "heartbeat after a reset {} ms.\n", node.heartbeat_ms);
  fmt::format_to(Text(page), "It has {} RPDOs, {} TPDOs and {} heartbeat consumers{}.\n\n", capacity.rpdos,
                 capacity.tpdos, capacity.heartbeat_consumers,
                 node.sync_producer ? ", and produces SYNC" : "");
}

void add_value_names(std::string& page, const NodeKind& kind) {
  std::vector<ValueTable> shown;
  page += "\n### Names of values\n\n";
  for (const Object& object : kind.objects) {
    if (object.index < kFirstOwnIndex) continue;
    for (const ObjectItem& item : object.items) {
      const auto same = [&](ValueTable table) { return table.data() == item.values.data(); };
      if (item.values.empty() || std::any_of(shown.begin(), shown.end(), same)) continue;
      shown.push_back(item.values);
      fmt::format_to(Text(page), "- {}:", item.family.empty() ? item.name : item.family);
      for (const canopen::ValueName& value : item.values) {
        const bool word = item.values.back().value > 99;
        page += word ? fmt::format(" {:04X} {};", value.value, value.name)
                     : fmt::format(" {} {};", value.value, value.name);
      }
      page.back() = '\n';
    }
  }
}

void add_message(std::string& page, const Message& message) {
  fmt::format_to(Text(page), "| {:03X} | {} | {} | {} |", message.identifier, message.name,
                 message.cycle_time_ms > 0 ? fmt::format("{} ms", message.cycle_time_ms) : "event",
                 message.size_bytes);
  for (const Signal& signal : message.signals) {
    const bool has_unit = !signal.unit.empty();
    fmt::format_to(Text(page), " {} {}{}{},", signal.name, signal.is_signed ? 'i' : 'u', signal.size_bits,
                   has_unit ? fmt::format(" ({:.6g} {})", signal.factor, signal.unit) : std::string());
  }
  page.back() = ' ';
  page += "|\n";
}

// Adds the PDOs of nodes with these ids.
void add_pdos(std::string& page, const Network& network, std::span<const std::uint8_t> node_ids) {
  page += "\n| identifier | PDO | sent each | bytes | signals |\n| --- | --- | --- | --- | --- |\n";
  for (const NetworkNode& node : network.nodes) {
    if (std::find(node_ids.begin(), node_ids.end(), node.node_id) == node_ids.end()) continue;
    for (const Message& message : network.messages) {
      if (message.name.starts_with(node.name + "_RPDO") || message.name.starts_with(node.name + "_TPDO")) {
        add_message(page, message);
      }
    }
  }
}

// The network's nodes are in the order of controller, drives, sensors, and an operator's PC.
void add_network(std::string& page, const NodeKind& kind, const Network& network) {
  page += "\n### PDOs in operation\n";
  if (kind.name == "controller") {
    page += "\nBesides these the controller sends each drive its RPDO and receives its TPDO.\n";
    add_pdos(page, network, std::array{drive::kControllerNodeId});
  } else if (kind.name == "drive") {
    const std::array first_drive{network.nodes.at(1).node_id};
    fmt::format_to(
        Text(page),
        "\nOf node {}; those of the other drives have identifiers that differ as the node ids do. The "
        "controller\nconfigures them at each start (`firmware/drive/configuration.cc`).\n",
        first_drive[0]);
    add_pdos(page, network, first_drive);
  } else {
    page += "\nAs after a reset. What a count means is the default robot's.\n";
    if (kind.name == "inertial") {
      add_pdos(page, network, std::array{sim_board::kInertialNode});
    } else if (kind.name == "ankle") {
      add_pdos(page, network, std::array{sim_board::kLeftAnkleNode, sim_board::kRightAnkleNode});
    } else {
      page += "The default robot has none. TPDO 1 (1A00) carries all inputs at each SYNC.\n";
    }
  }
}

// "Koboshi ankle sensor": Ankle sensor.
std::string title_of(const NodeKind& kind) {
  const std::string_view name = kind.description.device_name;
  std::string title(name.substr(name.find(' ') + 1));
  title.front() = static_cast<char>(title.front() - 'a' + 'A');
  return title;
}

constexpr std::string_view kMotionLimits = R"(
### Limits of motion

A drive that is enabled demands the position of its shaft (6062, 60FC). The first target of a cyclic stream after that,
or after a change of the mode, is approached over one cycle if 6081 covers the way; else it is a jump, as is any target
that is further from the one before than 2001. A jump is approached on the profile of 6081, 6083 and 6084. 6080 and 60C5
bound speed, acceleration and, on a profile, deceleration in every mode; quick stop and fault reaction have their own
ramps. A cyclic target beyond them is approached on a profile, and the demand stays behind a stream that moves on by
what it takes to brake. A stream may slow down and end as it likes: the demand does not run past its last target.

A stop (605A to 605E) follows 6084 or 6085. Whatever they hold, it ends within 1 s and within 607D: a ramp that is too
flat for that is steepened. So is the ramp on which a drive in motion turns back. A stop begins at the shaft where the
demand is far ahead of it.

Enabling, a change of the mode, homing and a reset set the target position (607A) to the present position: the drive then
holds it until a target is written, by SDO or by an RPDO that carries 607A. A set-point before that moves nothing. The
target in the RPDO that brings the enabling controlword counts.

The same check judges a value whichever service brings it: SDO, an RPDO, or stored parameters. A value in an RPDO that its
object does not take is ignored, with error 6320 and, in the manufacturer field of the emergency message, the object's
index (2 bytes), its sub-index and the number of the RPDO from 1. Each object has a message, and an entry of the error
history 1003, when its refusal begins. The rest of the RPDO is processed.

Bit 11 of the statusword is set while any of these limits or 607D holds the drive back and while a ramp is steepened, and
2002 adds up that time. Bit 4 is set, in every state, while the drive's supply is above half its nominal voltage.

| object | default | highest of the scenarios | margin |
| --- | --- | --- | --- |
| 2001 | 30.0 deg | 17.1 deg in a cycle of 10 ms | 1.75 |
| 6080 | 500 r/min, 3000 deg/s | 1710 deg/s | 1.75 |
| 60C5 | 436000 deg/s^2 | 249000 deg/s^2, a change of 24.9 deg from one cycle to the next | 1.75 |

The highest are the targets of the knees in the falls of `scenarios/get_up.yaml`, from its `can.log`. The defaults are
beyond what the servo can do (428 deg/s without load), as a demand may run ahead of the shaft: they keep the drive from
nonsense, and the robot's motions as they are. A master that spares motor and gears lowers them.

New limits in 607D may be written in either order. While the minimum is above the maximum, no transition leads to
operation enabled: the state stays what it is, with error 6320 until the controlword asks for something else or the
limits agree. A drive in operation holds its position for so long.
)";

}  // namespace

std::string page_text(std::span<const NodeKind> kinds, const Network& network) {
  std::string page(kIntroduction);
  add_common_objects(page, kinds);
  for (const NodeKind& kind : kinds) {
    fmt::format_to(Text(page), "\n## {}\n\n", title_of(kind));
    add_identity(page, kind);
    add_objects(page, kind.objects, kFirstOwnIndex, 0xA000);
    add_value_names(page, kind);
    add_network(page, kind, network);
    if (kind.name == "drive") page += kMotionLimits;
  }
  return page;
}

}  // namespace koboshi::bus
