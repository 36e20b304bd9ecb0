#include "firmware/canopen/pdo.h"

#include <algorithm>
#include <limits>
#include <utility>

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

// --- Records

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
  const AbortCode counted = write_mapped_count(count, dictionary);
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

// Bit 30 is stored as written and has no effect, since no remote frame is ever answered. By CiA 301
// (7.5.2.37) a TPDO with the bit clear is to be refused; but common masters (lely-core's dcfgen) write it
// clear and send no remote frames.
// A PDO without objects exists only while it is invalid: empty frames would cost bus time and say nothing.
AbortCode PdoRecord::write_cob_id(std::uint32_t cob_id) {
  const AbortCode checked = check_cob_id(cob_id_, cob_id, kCobIdNoRemote);
  if (checked != AbortCode::kNone) return checked;
  if (mapped_count_ == 0 && (cob_id & kCobIdInvalid) == 0) return AbortCode::kParameterIncompatibility;
  cob_id_ = cob_id;
  return AbortCode::kNone;
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
  if (subindex == 0) return write_mapped_count(value & 0xFF, dictionary);
  if (mapped_count_ != 0) return AbortCode::kUnsupportedAccess;
  MappedObject object;
  const AbortCode resolved = resolve(value, dictionary, object);
  if (resolved == AbortCode::kNone) objects_[subindex - 1u] = object;
  return resolved;
}

AbortCode PdoRecord::write_mapped_count(std::uint32_t count, const Dictionary& dictionary) {
  if (count > kMaxMappedObjects) return AbortCode::kPdoLengthExceeded;
  unsigned total_bytes = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (objects_[i].size_bytes == 0) return AbortCode::kObjectDoesNotExist;
    total_bytes += objects_[i].size_bytes;
  }
  if (total_bytes > kMaxPdoBytes) return AbortCode::kPdoLengthExceeded;
  mapped_count_ = static_cast<std::uint8_t>(count);
  size_bytes_ = static_cast<std::uint8_t>(total_bytes);
  restricted_ = std::ranges::any_of(mapped(), [&dictionary](const MappedObject& object) {
    Location location;
    return dictionary.find({object.index, object.subindex}, location) == AbortCode::kNone &&
           location.entry->restricts();
  });
  return AbortCode::kNone;
}

std::uint8_t PdoRecord::unpack_checked(Dictionary& dictionary, const std::uint8_t* data) const {
  unsigned refused = 0;
  unsigned bit = 1;
  for (const MappedObject& object : mapped()) {
    const unsigned own = std::exchange(bit, bit << 1);
    const ObjectAddress address{object.index, object.subindex};
    std::uint32_t value = 0;
    std::memcpy(&value, data, object.size_bytes);
    data += object.size_bytes;
    Location location;
    if (dictionary.find(address, location) != AbortCode::kNone) continue;  // a gap
    if (Dictionary::check_value(*location.entry, value) == AbortCode::kNone) {
      dictionary.store(location, value);
    } else {
      refused |= own;
    }
  }
  return static_cast<std::uint8_t>(refused);
}

AbortCode PdoRecord::resolve(std::uint32_t entry, const Dictionary& dictionary, MappedObject& object) const {
  const ObjectAddress address{static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8)};
  const std::uint32_t size_bits = entry & 0xFF;
  object = {};
  if (entry == 0) return AbortCode::kNone;  // removes the entry
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
  // Sub-index 0 of an array exists without a row.
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

// --- Reception

void RpdoSet::on_changed(std::size_t number) {
  pdos_[number].pending = false;
  pdos_[number].deadline_us = Rpdo::kNever;
  slots_.clear();
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    if (pdos_[i].record.valid()) slots_.insert(pdos_[i].record.identifier(), static_cast<std::uint8_t>(i));
  }
}

void RpdoSet::stop() {
  for (Rpdo& pdo : pdos_) {
    pdo.pending = false;
    pdo.deadline_us = Rpdo::kNever;
  }
}

bool RpdoSet::any(Reception reception) const {
  return std::ranges::any_of(pdos_, [reception](const Rpdo& pdo) { return pdo.reception == reception; });
}

bool RpdoSet::any_refused() const {
  return std::ranges::any_of(pdos_, [](const Rpdo& pdo) { return pdo.refused != 0; });
}

void RpdoSet::set_deadline(Rpdo& pdo, std::uint64_t deadline_us) {
  pdo.deadline_us = deadline_us;
  earliest_us_ = std::min(earliest_us_, deadline_us);
}

bool RpdoSet::find_silent(std::uint64_t now_us, std::size_t& number) {
  earliest_us_ = Rpdo::kNever;
  for (const Rpdo& pdo : pdos_) earliest_us_ = std::min(earliest_us_, pdo.deadline_us);
  if (now_us < earliest_us_) return false;
  const auto silent =
      std::ranges::find_if(pdos_, [now_us](const Rpdo& pdo) { return now_us >= pdo.deadline_us; });
  silent->deadline_us = Rpdo::kNever;
  number = static_cast<std::size_t>(silent - pdos_.begin());
  return true;
}

// --- Transmission

bool TpdoSet::sends(std::uint16_t identifier) const {
  return std::ranges::any_of(pdos_, [identifier](const Tpdo& pdo) {
    return pdo.record.valid() && pdo.record.identifier() == identifier;
  });
}

void TpdoSet::on_changed(std::size_t number) {
  const PdoRecord& changed = pdos_[number].record;
  pdos_[number].watched = number < watched_ && changed.valid() && changed.is_change_driven();
  forget(pdos_[number]);
  pdos_[number].event_due_us = 0;
  if (!changed.valid()) pdos_[number].inhibited_until_us = 0;
  due_us_ = 0;
  synchronous_end_ = 0;
  watched_end_ = 0;
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    if (pdos_[i].record.valid() && pdos_[i].record.synchronous()) synchronous_end_ = i + 1;
    if (pdos_[i].watched) watched_end_ = i + 1;
  }
}

void TpdoSet::on_configured(std::size_t number) {
  pdos_[number].inhibited_until_us = 0;
  on_changed(number);
}

void TpdoSet::forget(Tpdo& pdo) {
  pdo.requested = pdo.watched;
  pdo.counting = false;
  pdo.sync_count = 0;
}

void TpdoSet::start(std::uint64_t now_us) {
  due_us_ = 0;
  for (Tpdo& pdo : pdos_) {
    forget(pdo);
    pdo.inhibited_until_us = 0;
    pdo.event_due_us = now_us + pdo.record.event_timer_us();
  }
}

void TpdoSet::watch() {
  for (Tpdo& pdo : pdos_.first(watched_end_)) {
    if (!pdo.watched) continue;
    std::array<std::uint8_t, 8> data{};
    pdo.record.pack(dictionary_, data.data());
    if (data == pdo.seen) continue;
    pdo.seen = data;
    pdo.requested = true;
    due_us_ = 0;
  }
}

void TpdoSet::request(std::size_t number, std::uint64_t now_us) {
  Tpdo& pdo = pdos_[number];
  if (!pdo.record.valid()) return;
  pdo.requested = true;
  if (!pdo.record.synchronous() && now_us >= pdo.inhibited_until_us) send(pdo, now_us);
  if (pdo.requested) due_us_ = 0;
}

void TpdoSet::on_sync(std::uint8_t counter, std::uint64_t now_us) {
  if (watched_end_ != 0) watch();
  for (Tpdo& pdo : pdos_.first(synchronous_end_)) {
    if (pdo.record.valid() && pdo.record.synchronous() && is_due(pdo, counter)) send(pdo, now_us);
  }
}

bool TpdoSet::is_due(Tpdo& pdo, std::uint8_t counter) {
  const std::uint8_t type = pdo.record.transmission_type();
  if (type == kSynchronousAcyclic) return pdo.requested;
  // A start value needs a counter; the SYNC that has it is the first (CiA 301, 7.5.2.37).
  const std::uint8_t start = counter != 0 ? pdo.record.sync_start() : std::uint8_t{0};
  if (!pdo.counting && start != 0 && counter != start) return false;
  pdo.counting = true;
  return ++pdo.sync_count >= type;
}

void TpdoSet::send_due(std::uint64_t now_us) {
  due_us_ = std::numeric_limits<std::uint64_t>::max();
  for (Tpdo& pdo : pdos_) {
    if (!pdo.record.valid() || pdo.record.synchronous()) continue;
    const bool timed = pdo.record.event_timer_us() != 0;
    if (timed && now_us >= pdo.event_due_us) pdo.requested = true;
    if (pdo.requested && now_us >= pdo.inhibited_until_us) send(pdo, now_us);
    if (pdo.requested) due_us_ = std::min(due_us_, pdo.inhibited_until_us);
    if (timed) due_us_ = std::min(due_us_, pdo.event_due_us);
  }
}

void TpdoSet::send(Tpdo& pdo, std::uint64_t now_us) {
  hal::CanFrame frame{.identifier = pdo.record.identifier(), .size = pdo.record.size_bytes()};
  pdo.record.pack(dictionary_, frame.data.data());
  pdo.sync_count = 0;
  pdo.requested = !queue_.send(frame);
  if (pdo.requested || pdo.record.untimed()) return;
  pdo.inhibited_until_us = now_us + pdo.record.inhibit_time_us();
  pdo.event_due_us = now_us + pdo.record.event_timer_us();
}

}  // namespace koboshi::canopen
