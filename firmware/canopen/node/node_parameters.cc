// The parameters of a node as a sequence of writes that brings it from its state after a reset to its present
// state: what "save" to 0x1010 stores and a reset restores (CiA 301, 7.5.2.13).

#include <iterator>
#include <span>

#include "firmware/canopen/frame.h"
#include "firmware/canopen/node/node.h"

namespace koboshi::canopen {
namespace {

// One write of an object of the communication profile area: its present value, with these bits kept and set.
struct CommunicationWrite {
  ObjectAddress address;
  std::uint32_t kept = 0xFFFF'FFFF;
  std::uint32_t set = 0;
};

// An identifier changes only while the object is not in use, 0x1019 only while no SYNC is produced. So the
// first write of such an object makes that possible.
constexpr CommunicationWrite kWrites[] = {
    {{0x1005, 0}, 0, kSyncCobId},
    {{0x1005, 0}},
    {{0x1006, 0}, 0},
    {{0x1007, 0}},
    {{0x1019, 0}},
    {{0x1006, 0}},
    {{0x1012, 0}, kCobIdMask},
    {{0x1012, 0}},
    {{0x1015, 0}},
    {{0x1017, 0}},
    {{0x1029, 1}},
    {{0x1201, 3}},
};
// Their defaults depend on the node id: they are left out while they have them.
constexpr CommunicationWrite kIdentifiers[] = {
    {{0x1014, 0}, 0xFFFF'FFFF, kCobIdInvalid}, {{0x1014, 0}},
    {{0x1201, 1}, 0xFFFF'FFFF, kCobIdInvalid}, {{0x1201, 1}},
    {{0x1201, 2}, 0xFFFF'FFFF, kCobIdInvalid}, {{0x1201, 2}},
};
// Each write of another object resets them, so they come last.
constexpr CommunicationWrite kVerification[] = {{{0x1020, 1}}, {{0x1020, 2}}};

// The records of a PDO, relative to its communication record.
constexpr CommunicationWrite kPdoWrites[] = {
    {{0, 2}},
    {{0, 3}},
    {{0, 5}},
    {{0, 6}},
    {{kMappingRecord, 0}, 0},
    {{kMappingRecord, 1}},
    {{kMappingRecord, 2}},
    {{kMappingRecord, 3}},
    {{kMappingRecord, 4}},
    {{kMappingRecord, 5}},
    {{kMappingRecord, 6}},
    {{kMappingRecord, 7}},
    {{kMappingRecord, 8}},
    {{kMappingRecord, 0}},
    {{0, 1}},
};

// Moves `step` on to the next of these writes whose object the node has. False past the last.
bool find_write(Node& node, std::span<const CommunicationWrite> writes, std::uint16_t base, std::size_t& step,
                ParameterValue& parameter) {
  for (; step < writes.size(); ++step) {
    const CommunicationWrite& write = writes[step];
    const ObjectAddress address{static_cast<std::uint16_t>(base + write.address.index),
                                write.address.subindex};
    ObjectValue value;
    if (node.read_object(address, value) != AbortCode::kNone) continue;
    parameter = {address, static_cast<std::uint8_t>(value.size()), (value.number() & write.kept) | write.set};
    return true;
  }
  return false;
}

}  // namespace

bool Node::next_parameter(std::size_t& place, ParameterValue& parameter) {
  // A part of the parameters, and a step in it.
  constexpr std::size_t kStepBits = 8;
  const std::size_t parts = description_.rows.size() + communication_parts();
  std::size_t part = place >> kStepBits;
  std::size_t step = place & ((1u << kStepBits) - 1);
  for (; part < parts; ++part, step = 0) {
    const bool found = part < description_.rows.size()
                           ? row_parameter(description_.rows[part], step, parameter)
                           : communication_parameter(part - description_.rows.size(), step, parameter);
    if (!found) continue;
    place = (part << kStepBits) + step + 1;
    return true;
  }
  place = part << kStepBits;
  return false;
}

bool Node::row_parameter(const Entry& row, std::size_t step, ParameterValue& parameter) const {
  if (!is_parameter(row) || step >= row.count) return false;
  const ObjectAddress address{row.index, static_cast<std::uint8_t>(row.subindex + step)};
  ObjectValue value;
  if (dictionary_.read(address, value) != AbortCode::kNone) return false;
  parameter = {address, static_cast<std::uint8_t>(value.size()), value.number()};
  return true;
}

// The parts are the variables, the identifiers, the heartbeat consumers, each PDO twice, and 0x1020. All PDOs
// that are to change are invalid before the first of them becomes valid again: they may have exchanged their
// identifiers.
std::size_t Node::communication_parts() const { return 3 + 2 * (rpdos_.size() + tpdos_.size()) + 1; }

bool Node::communication_parameter(std::size_t part, std::size_t& step, ParameterValue& parameter) {
  if (part == 0) return find_write(*this, kWrites, 0, step, parameter);
  if (part == 1) return identifier_parameter(step, parameter);
  if (part == 2) return consumer_parameter(step, parameter);
  const std::size_t pdos = rpdos_.size() + tpdos_.size();
  const std::size_t pdo = part - 3;
  if (pdo >= 2 * pdos) return find_write(*this, kVerification, 0, step, parameter);
  return pdo_parameter(pdo % pdos, pdo >= pdos, step, parameter);
}

bool Node::identifier_parameter(std::size_t& step, ParameterValue& parameter) {
  const SdoChannel second = second_sdo();
  const std::uint32_t defaults[] = {static_cast<std::uint32_t>(kEmergencyBase + node_id_),
                                    second.request_cob_id, second.response_cob_id};
  const std::uint32_t present[] = {emergencies_.cob_id(), servers_[1].channel().request_cob_id,
                                   servers_[1].channel().response_cob_id};
  for (; step < std::size(kIdentifiers); ++step) {
    if (present[step / 2] != defaults[step / 2]) return find_write(*this, kIdentifiers, 0, step, parameter);
  }
  return false;
}

// First 0 for all that are to change, then their values: no two of them may monitor the same node.
bool Node::consumer_parameter(std::size_t& step, ParameterValue& parameter) {
  const std::size_t count = heartbeats_.size();
  for (; step < 2 * count; ++step) {
    const std::size_t number = step % count;
    const ObjectAddress address{0x1016, static_cast<std::uint8_t>(number + 1)};
    ObjectValue value;
    if (heartbeats_.read(address.subindex, value) != AbortCode::kNone) return false;
    if (value.number() == application_.default_consumer(number)) continue;
    parameter = {address, 4, step < count ? 0 : value.number()};
    return true;
  }
  return false;
}

// First `again` false: makes the PDO invalid; then true: its other objects.
bool Node::pdo_parameter(std::size_t pdo, bool again, std::size_t& step, ParameterValue& parameter) {
  const bool receive = pdo < rpdos_.size();
  const std::size_t number = receive ? pdo : pdo - rpdos_.size();
  const PdoRecord& record = receive ? rpdos_[number].record : tpdos_[number].record;
  const auto base = static_cast<std::uint16_t>((receive ? kFirstRpdoRecord : kFirstTpdoRecord) + number);
  if (step == 0) {
    PdoRecord as_after_reset(receive ? PdoDirection::kReceive : PdoDirection::kTransmit);
    static_cast<void>(
        as_after_reset.configure(default_pdo(as_after_reset.direction(), number), node_id_, dictionary_));
    if (record == as_after_reset) return false;
  }
  constexpr CommunicationWrite kInvalid[] = {{{0, 1}, 0xFFFF'FFFF, kCobIdInvalid}};
  return again ? find_write(*this, kPdoWrites, base, step, parameter)
               : find_write(*this, kInvalid, base, step, parameter);
}

void Node::restore(const ParameterValue& parameter) {
  if (parameter.address.index < kFirstOwnersIndex) {
    static_cast<void>(write_object(parameter.address, parameter.value, parameter.size_bytes));
    return;
  }
  std::uint32_t value = parameter.value;
  Location location;
  const AbortCode checked = dictionary_.check_write(parameter.address, value, parameter.size_bytes, location);
  if (checked == AbortCode::kNone && is_parameter(*location.entry)) dictionary_.store(location, value);
}

}  // namespace koboshi::canopen
