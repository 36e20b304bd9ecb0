// The communication parameters that a device stores (0x1010), as a sequence of writes.

#include <array>
#include <cstdint>

#include "firmware/canopen/cob_id.h"
#include "firmware/canopen/device_services.h"
#include "firmware/canopen/node.h"

namespace koboshi::canopen {
namespace {

// SYNC's counter is written while its period is still 0.
constexpr ObjectAddress kVariables[] = {{0x1005, 0}, {0x1007, 0}, {0x1019, 0}, {0x1006, 0}, {0x1012, 0},
                                        {0x1015, 0}, {0x1017, 0}, {0x1029, 1}, {0x1201, 3}};
constexpr ObjectAddress kVerification[] = {{0x1020, 1}, {0x1020, 2}};
constexpr std::uint8_t kMaxConsumers = 127;
constexpr auto kTimings = std::to_array<std::uint8_t>({2, 3, 5, 6});  // of a PDO's communication record

}  // namespace

// Counts the writes up to the one that is asked for.
class DeviceServices::ParameterList {
 public:
  ParameterList(Node& node, std::size_t number, ParameterValue& wanted)
      : node_(node), left_(number), wanted_(wanted) {}

  bool found() const { return found_; }
  void add(ObjectAddress address, std::uint32_t value, std::uint8_t size_bytes) {
    if (found_ || left_-- > 0) return;
    wanted_ = {address, size_bytes, value};
    found_ = true;
  }
  // An object as it is. False where there is none.
  bool add(ObjectAddress address) {
    ObjectValue value;
    if (found_ || node_.read_object(address, value) != AbortCode::kNone) return found_;
    add(address, value.number(), static_cast<std::uint8_t>(value.size()));
    return true;
  }
  // An identifier that is another one than after a reset. It changes only while bit 31 is set.
  void add_cob_id_unless(std::uint32_t default_value, ObjectAddress address) {
    const std::uint32_t value = read(address);
    if (value == default_value) return;
    add(address, value | kCobIdInvalid, 4);
    add(address, value, 4);
  }
  std::uint32_t read(ObjectAddress address) {
    ObjectValue value;
    static_cast<void>(node_.read_object(address, value));
    return value.number();
  }

 private:
  Node& node_;
  std::size_t left_;
  ParameterValue& wanted_;
  bool found_ = false;
};

bool DeviceServices::parameter(Node& node, std::size_t number, ParameterValue& parameter) const {
  ParameterList list(node, number, parameter);
  for (const ObjectAddress address : kVariables) list.add(address);
  list.add_cob_id_unless(static_cast<std::uint32_t>(kEmergencyBase + node.node_id()), {0x1014, 0});
  const SdoChannel& second = node.description().second_sdo;
  const std::uint32_t offset = second.plus_node_id ? node.node_id() : 0u;
  list.add_cob_id_unless(second.request_cob_id + offset, {0x1201, 1});
  list.add_cob_id_unless(second.response_cob_id + offset, {0x1201, 2});
  for (std::uint8_t i = 1; i <= kMaxConsumers && list.add({0x1016, i}); ++i) {
  }
  for (const PdoDirection direction : {PdoDirection::kReceive, PdoDirection::kTransmit}) {
    for (std::uint16_t i = 0; list_pdo(list, node, direction, i); ++i) {
    }
  }
  // The last: each write before it ends the verification.
  for (const ObjectAddress address : kVerification) list.add(address);
  return list.found();
}

// False past the last PDO, and when the write that is asked for was found.
bool DeviceServices::list_pdo(ParameterList& list, Node& node, PdoDirection direction, std::uint16_t number) {
  const bool receive = direction == PdoDirection::kReceive;
  const auto communication = static_cast<std::uint16_t>((receive ? 0x1400 : 0x1800) + number);
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  ObjectValue value;
  if (list.found() || node.read_object({communication, 1}, value) != AbortCode::kNone) return false;
  const std::uint32_t cob_id = value.number();
  if (is_as_after_reset(node, direction, number)) return true;
  list.add({communication, 1}, cob_id | kCobIdInvalid, 4);
  for (const std::uint8_t subindex : kTimings) list.add({communication, subindex});
  list.add({mapping, 0}, 0, 1);
  for (std::uint8_t i = 1; i <= kMaxMappedObjects; ++i) list.add({mapping, i});
  list.add({mapping, 0});
  list.add({communication, 1}, cob_id, 4);
  return true;
}

bool DeviceServices::is_as_after_reset(Node& node, PdoDirection direction, std::uint16_t number) {
  const bool receive = direction == PdoDirection::kReceive;
  const auto described = receive ? node.description().rpdos : node.description().tpdos;
  const auto communication = static_cast<std::uint16_t>((receive ? 0x1400 : 0x1800) + number);
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  PdoRecord record(direction);
  static_cast<void>(record.configure(number < described.size() ? described[number] : PdoConfiguration{},
                                     node.node_id(), Dictionary(node.description().rows, {})));
  ObjectValue here;
  ObjectValue there;
  for (const std::uint8_t subindex : std::to_array<std::uint8_t>({1, 2, 3, 5, 6})) {
    if (record.read_communication(subindex, there) != AbortCode::kNone) continue;
    static_cast<void>(node.read_object({communication, subindex}, here));
    if (here.number() != there.number()) return false;
  }
  for (std::uint8_t subindex = 0; subindex <= kMaxMappedObjects; ++subindex) {
    static_cast<void>(record.read_mapping(subindex, there));
    static_cast<void>(node.read_object({mapping, subindex}, here));
    if (here.number() != there.number()) return false;
  }
  return true;
}

}  // namespace koboshi::canopen
