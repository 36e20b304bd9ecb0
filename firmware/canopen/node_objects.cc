// The node's dictionary as SDO clients see it: the owner's rows, and the communication profile area (CiA
// 301, 7.5.2) that the stack serves from its own state.

#include "firmware/canopen/cob_id.h"
#include "firmware/canopen/node.h"

namespace koboshi::canopen {
namespace {

constexpr std::uint16_t kRpdoCommunication = 0x1400;
constexpr std::uint16_t kRpdoMapping = 0x1600;
constexpr std::uint16_t kTpdoCommunication = 0x1800;
constexpr std::uint16_t kTpdoMapping = 0x1A00;

bool is_communication_area(std::uint16_t index) { return index >= 0x1000 && index <= 0x1FFF; }

// Whether the index is that of one of `count` records from `first` on.
bool is_record(std::uint16_t index, std::uint16_t first, std::size_t count) {
  return index >= first && index - first < static_cast<int>(count);
}

bool is_writable_variable(std::uint16_t index) {
  return index == 0x1005 || index == 0x1006 || index == 0x1017;
}

AbortCode number(ObjectValue& value, std::uint32_t number, std::uint8_t size) {
  value.set_number(number, size);
  return AbortCode::kNone;
}

AbortCode text(ObjectValue& value, std::string_view text) {
  value.set_text(text);
  return AbortCode::kNone;
}

}  // namespace

AbortCode Node::read_object(ObjectAddress address, ObjectValue& value) {
  return is_communication_area(address.index) ? read_communication(address, value)
                                              : dictionary_.read(address, value);
}

AbortCode Node::write_object(ObjectAddress address, std::uint32_t value, std::size_t size) {
  if (is_communication_area(address.index)) return write_communication(address, value, size);
  Location location;
  const AbortCode checked = dictionary_.check_write(address, value, size, location);
  if (checked != AbortCode::kNone) return checked;
  const AbortCode accepted = application_.on_write(address, value);
  if (accepted == AbortCode::kNone) dictionary_.store(location, value);
  return accepted;
}

AbortCode Node::read_communication(ObjectAddress address, ObjectValue& value) const {
  const std::uint16_t index = address.index;
  const std::uint8_t subindex = address.subindex;
  if (is_record(index, kRpdoCommunication, rpdos_.size())) {
    return rpdos_[index - kRpdoCommunication].record.read_communication(subindex, value);
  }
  if (is_record(index, kRpdoMapping, rpdos_.size())) {
    return rpdos_[index - kRpdoMapping].record.read_mapping(subindex, value);
  }
  if (is_record(index, kTpdoCommunication, tpdos_.size())) {
    return tpdos_[index - kTpdoCommunication].record.read_communication(subindex, value);
  }
  if (is_record(index, kTpdoMapping, tpdos_.size())) {
    return tpdos_[index - kTpdoMapping].record.read_mapping(subindex, value);
  }
  switch (index) {
    case 0x1003:
      return errors_.read_history(subindex, value);
    case 0x1016:
      return heartbeats_.read(subindex, value);
    case 0x1018:
      return read_identity(subindex, value);
    case 0x1200:
      return read_sdo_server(subindex, value);
    default:
      break;
  }
  const AbortCode read = read_variable(index, value);
  return read == AbortCode::kNone && subindex != 0 ? AbortCode::kSubindexDoesNotExist : read;
}

AbortCode Node::read_variable(std::uint16_t index, ObjectValue& value) const {
  switch (index) {
    case 0x1000:
      return number(value, description_.device_type, 4);
    case 0x1001:
      return number(value, errors_.error_register(), 1);
    case 0x1005:
      return number(value, sync_cob_id_, 4);
    case 0x1006:
      return number(value, sync_period_us_, 4);
    case 0x1008:
      return text(value, description_.device_name);
    case 0x1009:
      return text(value, description_.hardware_version);
    case 0x100A:
      return text(value, description_.software_version);
    case 0x1014:
      return number(value, static_cast<std::uint32_t>(kEmergencyBase + node_id_), 4);
    case 0x1017:
      return number(value, heartbeat_ms_, 2);
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

AbortCode Node::read_sdo_server(std::uint8_t subindex, ObjectValue& value) const {
  switch (subindex) {
    case 0:
      return number(value, 2, 1);
    case 1:
      return number(value, static_cast<std::uint32_t>(kSdoRequestBase + node_id_), 4);
    case 2:
      return number(value, static_cast<std::uint32_t>(kSdoResponseBase + node_id_), 4);
    default:
      return AbortCode::kSubindexDoesNotExist;
  }
}

AbortCode Node::write_communication(ObjectAddress address, std::uint32_t value, std::size_t size) {
  const std::uint16_t index = address.index;
  const std::uint8_t subindex = address.subindex;
  if (is_record(index, kRpdoCommunication, rpdos_.size())) {
    Rpdo& pdo = rpdos_[index - kRpdoCommunication];
    const AbortCode written = pdo.record.write_communication(subindex, value, size);
    if (!pdo.record.valid()) pdo.pending = false;
    rpdos_.update_identifiers();
    return written;
  }
  if (is_record(index, kRpdoMapping, rpdos_.size())) {
    return rpdos_[index - kRpdoMapping].record.write_mapping(subindex, value, size, dictionary_);
  }
  if (is_record(index, kTpdoCommunication, tpdos_.size())) {
    return tpdos_[index - kTpdoCommunication].record.write_communication(subindex, value, size);
  }
  if (is_record(index, kTpdoMapping, tpdos_.size())) {
    return tpdos_[index - kTpdoMapping].record.write_mapping(subindex, value, size, dictionary_);
  }
  if (index == 0x1003) return errors_.write_history(subindex, value);
  return write_parameter(address, value, size);
}

AbortCode Node::write_parameter(ObjectAddress address, std::uint32_t value, std::size_t size) {
  ObjectValue present;
  const AbortCode read = read_communication(address, present);
  if (read != AbortCode::kNone) return read;
  const bool writable_array = address.index == 0x1016 && address.subindex != 0;
  if (!writable_array && !is_writable_variable(address.index)) return AbortCode::kWriteOfReadOnly;
  if (size > present.size()) return AbortCode::kLengthTooHigh;
  if (size != 0 && size < present.size()) return AbortCode::kLengthTooLow;
  switch (address.index) {
    case 0x1005:
      return write_sync_cob_id(value);
    case 0x1006:
      sync_period_us_ = value;
      sync_due_us_ = 0;  // the new beat starts with the next `process`
      return AbortCode::kNone;
    case 0x1016:
      return heartbeats_.write(address.subindex, value);
    default:
      heartbeat_ms_ = static_cast<std::uint16_t>(value);
      heartbeat_due_us_ = 0;
      return AbortCode::kNone;
  }
}

AbortCode Node::write_sync_cob_id(std::uint32_t value) {
  const auto identifier = static_cast<std::uint16_t>(value & kCobIdMask);
  const bool producing = (sync_cob_id_ & kSyncProducer) != 0;
  if ((value & kCobIdExtended) != 0 || is_restricted(identifier)) return AbortCode::kInvalidValue;
  if (producing && identifier != (sync_cob_id_ & kCobIdMask)) return AbortCode::kInvalidValue;
  sync_cob_id_ = identifier | (value & kSyncProducer);
  return AbortCode::kNone;
}

}  // namespace koboshi::canopen
