// The node's dictionary as SDO clients see it: the owner's rows, and the communication profile area (CiA 301,
// 7.5.2), which the stack serves from its own state.

#include "firmware/canopen/frame.h"
#include "firmware/canopen/node/node.h"

namespace koboshi::canopen {
namespace {

bool is_mapping_record(std::uint16_t index) { return (index & kMappingRecord) != 0; }
std::size_t pdo_number(std::uint16_t index) { return index & 0x1FFu; }

// Signatures of 0x1010 and 0x1011: "save" and "load" in the order of the bus (CiA 301, 7.5.2.13, 7.5.2.14).
constexpr std::uint32_t kSave = 0x6576'6173;
constexpr std::uint32_t kLoad = 0x6461'6F6C;

// The part of the communication profile area that the stack itself serves. The rest, the objects of CiA 302,
// is in the owner's table.
bool is_communication_area(std::uint16_t index) { return index >= 0x1000 && index < kFirstOwnersIndex; }

// Sub-index 0 of records and arrays is read-only, but for the number of objects of a PDO mapping and the size
// of the error history.
bool is_writable(ObjectAddress address) {
  switch (address.index) {
    case 0x1003:
      return address.subindex == 0;
    case 0x1005:
    case 0x1006:
    case 0x1007:
    case 0x1014:
    case 0x1015:
    case 0x1017:
    case 0x1019:
      return true;
    case 0x1010:
    case 0x1011:
    case 0x1016:
    case 0x1029:
    case 0x1201:
      return address.subindex != 0;
    default:
      break;
  }
  return address.index >= kFirstRpdoRecord && (is_mapping_record(address.index) || address.subindex != 0);
}

AbortCode number(ObjectValue& value, std::uint32_t number, std::uint8_t size) {
  value.set_number(number, size);
  return AbortCode::kNone;
}

// A device without a name has no such object.
AbortCode text(ObjectValue& value, std::string_view text) {
  if (text.empty()) return AbortCode::kObjectDoesNotExist;
  value.set_text(text);
  return AbortCode::kNone;
}

// Reads an array of `count` equal numbers.
AbortCode array(ObjectValue& value, std::uint8_t subindex, std::uint8_t count, std::uint32_t element,
                std::uint8_t size) {
  if (subindex > count) return AbortCode::kSubindexDoesNotExist;
  return subindex == 0 ? number(value, count, 1) : number(value, element, size);
}

}  // namespace

AbortCode Node::read_object(ObjectAddress address, ObjectValue& value) {
  if (is_communication_area(address.index)) return read_communication(address, value);
  Location location;
  const bool is_computed =
      dictionary_.find(address, location) == AbortCode::kNone && location.entry->offset == Entry::kComputed;
  return is_computed ? application_.on_read(address, value) : dictionary_.read(address, value);
}

AbortCode Node::write_object(ObjectAddress address, std::uint32_t value, std::size_t size) {
  if (is_communication_area(address.index)) ++configuration_;
  return services_ != nullptr ? services_->write(*this, address, value, size)
                              : write_own(address, value, size);
}

AbortCode Node::write_own(ObjectAddress address, std::uint32_t value, std::size_t size) {
  if (is_communication_area(address.index)) return write_communication(address, value, size);
  Location location;
  const AbortCode checked = dictionary_.check_write(address, value, size, location);
  if (checked != AbortCode::kNone) return checked;
  const AbortCode accepted = application_.on_write(address, value);
  if (accepted == AbortCode::kNone) dictionary_.store(location, value);
  return accepted;
}

AbortCode Node::open_domain(ObjectAddress address, Access access, Domain*& domain) {
  domain = nullptr;
  if (is_communication_area(address.index)) {
    ObjectValue value;
    const AbortCode read = read_communication(address, value);
    return read == AbortCode::kNoData ? AbortCode::kNone : read;
  }
  Location location;
  const AbortCode found = dictionary_.find(address, location);
  // Sub-index 0 of an array has no row.
  if (found == AbortCode::kSubindexDoesNotExist && address.subindex == 0) return AbortCode::kNone;
  if (found != AbortCode::kNone) return found;
  const Entry& row = *location.entry;
  if (row.type != DataType::kDomain) return AbortCode::kNone;
  if (access == Access::kReadOnly && row.access == Access::kWriteOnly) return AbortCode::kReadOfWriteOnly;
  if (access == Access::kWriteOnly && row.access == Access::kReadOnly) return AbortCode::kWriteOfReadOnly;
  Domain* const candidate = application_.domain(address);
  if (candidate == nullptr) return AbortCode::kResourceNotAvailable;
  for (const SdoServer& server : servers_) {
    if (server.uses(*candidate)) return AbortCode::kDeviceState;
  }
  domain = candidate;
  return AbortCode::kNone;
}

AbortCode Node::read_communication(ObjectAddress address, ObjectValue& value) const {
  if (address.index >= kFirstRpdoRecord) return read_record(address, value);
  const AbortCode read = read_variable(address.index, value);
  if (read == AbortCode::kObjectDoesNotExist) {
    const AbortCode array = read_array(address, value);
    const bool unknown = array == AbortCode::kObjectDoesNotExist && services_ != nullptr;
    return unknown ? services_->read(address, value) : array;
  }
  return address.subindex != 0 ? AbortCode::kSubindexDoesNotExist : read;
}

AbortCode Node::read_record(ObjectAddress address, ObjectValue& value) const {
  const std::size_t number = pdo_number(address.index);
  const bool receive = address.index < kFirstTpdoRecord;
  const std::size_t count = receive ? rpdos_.size() : tpdos_.size();
  if (address.index >= kEndOfPdoRecords || number >= count) return AbortCode::kObjectDoesNotExist;
  const PdoRecord& record = receive ? rpdos_[number].record : tpdos_[number].record;
  return is_mapping_record(address.index) ? record.read_mapping(address.subindex, value)
                                          : record.read_communication(address.subindex, value);
}

AbortCode Node::read_variable(std::uint16_t index, ObjectValue& value) const {
  switch (index) {
    case 0x1000:
      return number(value, description_.device_type, 4);
    case 0x1001:
      return number(value, errors_.error_register(), 1);
    case 0x1008:
      return text(value, description_.device_name);
    case 0x1009:
      return text(value, description_.hardware_version);
    case 0x100A:
      return text(value, description_.software_version);
    case 0x1014:
      return number(value, emergencies_.cob_id(), 4);
    case 0x1015:
      return number(value, emergencies_.inhibit_time_100us(), 2);
    case 0x1017:
      return number(value, heartbeat_ms_, 2);
    default:
      return sync_.read(index, value);
  }
}

AbortCode Node::read_array(ObjectAddress address, ObjectValue& value) const {
  constexpr auto kGroups = static_cast<std::uint8_t>(ParameterGroup::kManufacturer);
  const std::uint8_t subindex = address.subindex;
  switch (address.index) {
    case 0x1003:
      return errors_.read_history(subindex, value);
    case 0x1010:  // bit 0: stores on command
    case 0x1011:  // bit 0: restores
      if (subindex > kGroups) return AbortCode::kSubindexDoesNotExist;
      return array(value, subindex, kGroups, stores(subindex) ? 1 : 0, 4);
    case 0x1016:
      return heartbeats_.read(subindex, value);
    case 0x1018:
      return read_identity(subindex, value);
    case 0x1029:
      return array(value, subindex, 1, static_cast<std::uint8_t>(communication_error_), 1);
    case 0x1200:
      return read_sdo_server(0, subindex, value);
    case 0x1201:
      return read_sdo_server(1, subindex, value);
    default:
      return AbortCode::kObjectDoesNotExist;
  }
}

AbortCode Node::read_identity(std::uint8_t subindex, ObjectValue& value) const {
  switch (subindex) {
    case 0:
      return number(value, 4, 1);
    case 1:
      return number(value, description_.vendor_id, 4);
    case 2:
      return number(value, description_.product_code, 4);
    case 3:
      return number(value, description_.revision_number, 4);
    case 4:
      return number(value, serial_number_, 4);
    default:
      return AbortCode::kSubindexDoesNotExist;
  }
}

// 0x1200 has no sub-index 3: any node may be the client of the default channel.
AbortCode Node::read_sdo_server(std::size_t server, std::uint8_t subindex, ObjectValue& value) const {
  const std::uint8_t highest = server == 0 ? 2 : 3;
  if (subindex > highest) return AbortCode::kSubindexDoesNotExist;
  switch (subindex) {
    case 0:
      return number(value, highest, 1);
    case 1:
      return number(value, servers_[server].channel().request_cob_id, 4);
    case 2:
      return number(value, servers_[server].channel().response_cob_id, 4);
    default:
      return number(value, second_client_, 1);
  }
}

AbortCode Node::write_communication(ObjectAddress address, std::uint32_t value, std::size_t size) {
  ObjectValue present;
  const AbortCode read = read_communication(address, present);
  // An empty entry of the error history exists nevertheless.
  if (read != AbortCode::kNone && read != AbortCode::kNoData) return read;
  if (!is_writable(address)) return AbortCode::kWriteOfReadOnly;
  const AbortCode sized = check_size(size, present.size());
  if (sized != AbortCode::kNone) return sized;
  present.set_number(value, static_cast<std::uint8_t>(present.size()));  // drops bytes beyond the object's
  return address.index >= kFirstRpdoRecord ? write_record(address, present.number())
                                           : write_parameter(address, present.number());
}

AbortCode Node::write_record(ObjectAddress address, std::uint32_t value) {
  const std::size_t number = pdo_number(address.index);
  const bool receive = address.index < kFirstTpdoRecord;
  PdoRecord& record = receive ? rpdos_[number].record : tpdos_[number].record;
  // No two valid RPDOs may have the same identifier: a frame fills only one.
  if (receive && !is_mapping_record(address.index) && address.subindex == 1 && (value & kCobIdInvalid) == 0) {
    const std::size_t present = rpdos_.find(static_cast<std::uint16_t>(value & kCobIdMask));
    if (present != SlotMap::kNone && present != number) return AbortCode::kParameterIncompatibility;
  }
  const AbortCode written = is_mapping_record(address.index)
                                ? write_mapping(record, address.subindex, value)
                                : record.write_communication(address.subindex, value);
  if (written != AbortCode::kNone) return written;
  if (receive) {
    on_rpdo_changed(number);
  } else {
    tpdos_.on_changed(number);
  }
  return AbortCode::kNone;
}

// Step 3 of CiA 301, 7.5.2.36: an object that does not exist and one that cannot be mapped are different
// errors. Objects of the communication profile area exist, although the owner's dictionary lacks them.
AbortCode Node::write_mapping(PdoRecord& record, std::uint8_t subindex, std::uint32_t value) const {
  const AbortCode written = record.write_mapping(subindex, value, dictionary_);
  const ObjectAddress mapped{static_cast<std::uint16_t>(value >> 16), static_cast<std::uint8_t>(value >> 8)};
  if (written != AbortCode::kObjectDoesNotExist || !is_communication_area(mapped.index)) return written;
  ObjectValue present;
  const AbortCode read = read_communication(mapped, present);
  return read == AbortCode::kNone || read == AbortCode::kNoData ? AbortCode::kNotMappable : read;
}

AbortCode Node::write_parameter(ObjectAddress address, std::uint32_t value) {
  switch (address.index) {
    case 0x1003:
      return errors_.write_history(address.subindex, value);
    case 0x1010:
    case 0x1011:
      return store_or_restore(address, value);
    case 0x1014:
      return emergencies_.write_cob_id(value);
    case 0x1015:
      emergencies_.set_inhibit_time(static_cast<std::uint16_t>(value));
      return AbortCode::kNone;
    case 0x1016:
      return write_consumer(address.subindex, value);
    case 0x1017:
      heartbeat_ms_ = static_cast<std::uint16_t>(value);
      heartbeat_due_us_ = 0;  // the new time counts from the next `process`
      return AbortCode::kNone;
    case 0x1029:
      if (value > static_cast<std::uint8_t>(CommunicationError::kStop)) return AbortCode::kInvalidValue;
      communication_error_ = static_cast<CommunicationError>(value);
      return AbortCode::kNone;
    case 0x1201:
      return write_second_sdo(address.subindex, value);
    default:
      return sync_.write(address.index, value);
  }
}

AbortCode Node::write_consumer(std::uint8_t subindex, std::uint32_t value) {
  const AbortCode written = heartbeats_.write(subindex, value);
  if (!heartbeats_.any_lost()) report(error_code::kHeartbeat, false);
  return written;
}

AbortCode Node::write_second_sdo(std::uint8_t subindex, std::uint32_t value) {
  if (subindex == 3) {
    second_client_ = static_cast<std::uint8_t>(value);
    return AbortCode::kNone;
  }
  SdoChannel channel = servers_[1].channel();
  std::uint32_t& cob_id = subindex == 1 ? channel.request_cob_id : channel.response_cob_id;
  const AbortCode checked = check_cob_id(cob_id, value);
  if (checked != AbortCode::kNone) return checked;
  cob_id = value;
  servers_[1].configure(channel);
  return AbortCode::kNone;
}

AbortCode Node::store_or_restore(ObjectAddress address, std::uint32_t signature) {
  const auto group = static_cast<ParameterGroup>(address.subindex);
  const bool saves = address.index == 0x1010;
  if (signature != (saves ? kSave : kLoad) || !stores(address.subindex)) return AbortCode::kCannotTransfer;
  return saves ? application_.on_store(group) : application_.on_restore(group);
}

}  // namespace koboshi::canopen
