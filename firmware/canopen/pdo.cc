#include "firmware/canopen/pdo.h"

namespace koboshi::canopen {
namespace {

constexpr unsigned kMaxPdoBytes = 8;

// Sub-indices of the communication record (CiA 301, 7.5.2.35 and 7.5.2.37).
constexpr std::uint8_t kCobIdSubindex = 1;
constexpr std::uint8_t kTypeSubindex = 2;
constexpr std::uint8_t kInhibitSubindex = 3;
constexpr std::uint8_t kEventSubindex = 5;
constexpr std::uint8_t kSyncStartSubindex = 6;

// 241..251 are reserved; 252 and 253 wait for remote frames, which this stack does not serve.
bool is_supported_type(std::uint32_t type) {
  return type <= kMaxSynchronous || type == kEventManufacturer || type == kEventProfile;
}

}  // namespace

AbortCode PdoRecord::configure(const PdoConfiguration& configuration, std::uint8_t node_id,
                               const Dictionary& dictionary) {
  *this = PdoRecord(direction_);
  if (!is_supported_type(configuration.transmission_type)) return AbortCode::kInvalidValue;
  transmission_type_ = configuration.transmission_type;
  inhibit_time_100us_ = configuration.inhibit_time_100us;
  event_timer_ms_ = configuration.event_timer_ms;
  sync_start_ = configuration.sync_start;
  std::uint32_t count = 0;
  for (; count < kMaxMappedObjects && configuration.mapping[count] != 0; ++count) {
    const AbortCode mapped = resolve(configuration.mapping[count], dictionary, objects_[count]);
    if (mapped != AbortCode::kNone) return mapped;
  }
  const AbortCode counted = write_mapped_count(count);
  if (counted != AbortCode::kNone) return counted;
  const std::uint32_t flags = direction_ == PdoDirection::kTransmit ? kCobIdNoRemote : 0;
  return write_cob_id((configuration.cob_id + (configuration.plus_node_id ? node_id : 0u)) | flags);
}

AbortCode PdoRecord::read_communication(std::uint8_t subindex, ObjectValue& value) const {
  const bool transmit = direction_ == PdoDirection::kTransmit;
  switch (subindex) {
    case 0:
      value.set_number(transmit ? kSyncStartSubindex : kEventSubindex, 1);
      return AbortCode::kNone;
    case kCobIdSubindex:
      value.set_number(cob_id_, 4);
      return AbortCode::kNone;
    case kTypeSubindex:
      value.set_number(transmission_type_, 1);
      return AbortCode::kNone;
    case kEventSubindex:
      value.set_number(event_timer_ms_, 2);
      return AbortCode::kNone;
    default:
      break;
  }
  if (!transmit) return AbortCode::kSubindexDoesNotExist;
  switch (subindex) {
    case kInhibitSubindex:
      value.set_number(inhibit_time_100us_, 2);
      return AbortCode::kNone;
    case kSyncStartSubindex:
      value.set_number(sync_start_, 1);
      return AbortCode::kNone;
    default:
      return AbortCode::kSubindexDoesNotExist;
  }
}

AbortCode PdoRecord::write_communication(std::uint8_t subindex, std::uint32_t value) {
  ObjectValue present;
  const AbortCode exists = read_communication(subindex, present);
  if (exists != AbortCode::kNone) return exists;
  if (subindex == 0) return AbortCode::kWriteOfReadOnly;
  switch (subindex) {
    case kCobIdSubindex:
      return write_cob_id(value);
    case kTypeSubindex:
      if (!is_supported_type(value & 0xFF)) return AbortCode::kInvalidValue;
      transmission_type_ = static_cast<std::uint8_t>(value);
      return AbortCode::kNone;
    case kInhibitSubindex:
      if (valid()) return AbortCode::kInvalidValue;
      inhibit_time_100us_ = static_cast<std::uint16_t>(value);
      return AbortCode::kNone;
    case kSyncStartSubindex:
      if (valid() || value > kMaxSynchronous) return AbortCode::kInvalidValue;
      sync_start_ = static_cast<std::uint8_t>(value);
      return AbortCode::kNone;
    default:
      event_timer_ms_ = static_cast<std::uint16_t>(value);
      return AbortCode::kNone;
  }
}

// Bit 30 is kept as it is written but has no effect: no remote frame is ever answered, whatever it allows.
// CiA 301 would have a TPDO that leaves it clear refused (7.5.2.37), but common masters (lely-core's dcfgen)
// write it clear without meaning to send remote frames.
AbortCode PdoRecord::write_cob_id(std::uint32_t cob_id) {
  const AbortCode checked = check_cob_id(cob_id_, cob_id, kCobIdNoRemote);
  if (checked == AbortCode::kNone) cob_id_ = cob_id;
  return checked;
}

AbortCode PdoRecord::read_mapping(std::uint8_t subindex, ObjectValue& value) const {
  if (subindex > kMaxMappedObjects) return AbortCode::kSubindexDoesNotExist;
  if (subindex == 0) {
    value.set_number(mapped_count_, 1);
    return AbortCode::kNone;
  }
  const MappedObject& object = objects_[subindex - 1u];
  value.set_number(mapping(object.index, object.subindex, static_cast<std::uint8_t>(8 * object.size_bytes)),
                   4);
  return AbortCode::kNone;
}

AbortCode PdoRecord::write_mapping(std::uint8_t subindex, std::uint32_t value, const Dictionary& dictionary) {
  if (subindex > kMaxMappedObjects) return AbortCode::kSubindexDoesNotExist;
  if (valid()) return AbortCode::kUnsupportedAccess;
  if (subindex == 0) return write_mapped_count(value & 0xFF);
  if (mapped_count_ != 0) return AbortCode::kUnsupportedAccess;
  MappedObject object;
  const AbortCode resolved = resolve(value, dictionary, object);
  if (resolved == AbortCode::kNone) objects_[subindex - 1u] = object;
  return resolved;
}

AbortCode PdoRecord::write_mapped_count(std::uint32_t count) {
  if (count > kMaxMappedObjects) return AbortCode::kPdoLengthExceeded;
  unsigned total_bytes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (objects_[i].size_bytes == 0) return AbortCode::kObjectDoesNotExist;
    total_bytes += objects_[i].size_bytes;
  }
  if (total_bytes > kMaxPdoBytes) return AbortCode::kPdoLengthExceeded;
  mapped_count_ = static_cast<std::uint8_t>(count);
  size_bytes_ = static_cast<std::uint8_t>(total_bytes);
  return AbortCode::kNone;
}

AbortCode PdoRecord::resolve(std::uint32_t entry, const Dictionary& dictionary, MappedObject& object) const {
  const ObjectAddress address{static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8)};
  const std::uint32_t size_bits = entry & 0xFF;
  object = {};
  if (entry == 0) return AbortCode::kNone;  // removes what was there
  // An RPDO may name a data type instead of an object: a gap of that size (CiA 301, 7.4.7.2).
  const std::uint8_t dummy_size =
      address.index <= 0xFF ? canopen::size_bytes(static_cast<DataType>(address.index)) : std::uint8_t{0};
  if (dummy_size != 0) {
    const bool fits =
        direction_ == PdoDirection::kReceive && address.subindex == 0 && size_bits == 8u * dummy_size;
    if (!fits) return AbortCode::kNotMappable;
    object = {address.index, 0, dummy_size, MappedObject::kDummy};
    return AbortCode::kNone;
  }
  Location location;
  const AbortCode found = dictionary.find(address, location);
  // The highest sub-index of an array exists, without a row.
  if (found == AbortCode::kSubindexDoesNotExist && address.subindex == 0) return AbortCode::kNotMappable;
  if (found != AbortCode::kNone) return found;
  const Entry& row = *location.entry;
  const auto wanted =
      static_cast<unsigned>(direction_ == PdoDirection::kReceive ? Mappable::kRpdo : Mappable::kTpdo);
  const std::uint8_t size = canopen::size_bytes(row.type);
  if ((static_cast<unsigned>(row.mappable) & wanted) == 0 || size == 0 || size_bits != 8u * size)
    return AbortCode::kNotMappable;
  object = {address.index, address.subindex, size, location.offset};
  return AbortCode::kNone;
}

}  // namespace koboshi::canopen
