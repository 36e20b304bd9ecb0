#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/slot_map.h"
#include "firmware/canopen/transmit_queue.h"
#include "hal/port/can.h"

// Process data objects (CiA 301, 7.2.2): their communication and mapping records (7.5.2.35 to 7.5.2.38), and
// when data are taken over and sent.
namespace koboshi::canopen {

inline constexpr std::size_t kMaxMappedObjects = 8;  // one byte each; a bit each in Rpdo::refused

// Indices of the records, one for each PDO of a node: the communication records of RPDOs and TPDOs, and
// behind each its mapping.
inline constexpr std::uint16_t kFirstRpdoRecord = 0x1400;
inline constexpr std::uint16_t kFirstTpdoRecord = 0x1800;
inline constexpr std::uint16_t kMappingRecord = 0x200;
inline constexpr std::uint16_t kEndOfPdoRecords = 0x1C00;

// Transmission types (CiA 301, 7.5.2.35 and 7.5.2.37). 1..240 mean every n-th SYNC.
inline constexpr std::uint8_t kSynchronousAcyclic = 0;
inline constexpr std::uint8_t kSynchronousEverySync = 1;
inline constexpr std::uint8_t kMaxSynchronous = 240;
inline constexpr std::uint8_t kEventManufacturer = 254;
inline constexpr std::uint8_t kEventProfile = 255;

// An entry of a PDO mapping record: index, sub-index, length in bits.
constexpr std::uint32_t mapping(std::uint16_t index, std::uint8_t subindex, std::uint8_t size_bits) {
  return (static_cast<std::uint32_t>(index) << 16) | (static_cast<std::uint32_t>(subindex) << 8) | size_bits;
}

// Communication and mapping record of a PDO after a reset.
struct PdoConfiguration {
  std::uint32_t cob_id = kCobIdInvalid;  // identifier, or kCobIdInvalid
  bool plus_node_id = false;             // adds the node id to it, as the predefined connection set does
  std::uint8_t transmission_type = kEventProfile;
  std::uint16_t inhibit_time_100us = 0;  // TPDO: shortest time between two transmissions
  // TPDO, event-driven: longest time between two transmissions. RPDO: longest silence before EMCY 0x8250. 0:
  // no limit.
  std::uint16_t event_timer_ms = 0;
  std::uint8_t sync_start = 0;  // TPDO, every n-th SYNC: counter of the SYNC to count from; 0: the next
  std::array<std::uint32_t, kMaxMappedObjects> mapping{};  // ends at the first 0
};

// An object in a PDO, resolved to its value's bytes.
struct MappedObject {
  static constexpr std::uint16_t kDummy = Entry::kConstant;  // an offset: an RPDO skips these bytes

  std::uint16_t index = 0;  // 0: no object
  std::uint8_t subindex = 0;
  std::uint8_t size_bytes = 0;
  std::uint16_t offset = 0;

  friend bool operator==(const MappedObject&, const MappedObject&) = default;
};

enum class PdoDirection : std::uint8_t { kReceive, kTransmit };

// Communication and mapping record of one PDO: the objects 0x1400 + n and 0x1600 + n, or 0x1800 + n and
// 0x1A00 + n. Callers have checked the sizes of values. By CiA 301 identifier and timing change only while
// the PDO is invalid, the mapping only while it is invalid and its number of objects is 0.
class PdoRecord {
 public:
  explicit PdoRecord(PdoDirection direction) : direction_(direction) {}

  // Sets both records, as a reset does. An error leaves the PDO invalid: kInvalidValue for a transmission
  // type or a COB-ID that is not supported; kParameterIncompatibility for a valid COB-ID of a PDO without
  // objects; kObjectDoesNotExist, kSubindexDoesNotExist or kNotMappable for a
  // mapped object; kPdoLengthExceeded for more than 8 bytes.
  AbortCode configure(const PdoConfiguration& configuration, std::uint8_t node_id,
                      const Dictionary& dictionary);

  // kSubindexDoesNotExist if the record has no such sub-index, here and below. Writing sub-index 0:
  // kWriteOfReadOnly; a value that is not supported, or that may not change while the PDO is valid:
  // kInvalidValue; a valid COB-ID while no object is mapped: kParameterIncompatibility.
  AbortCode read_communication(std::uint8_t subindex, ObjectValue& value) const;
  AbortCode write_communication(std::uint8_t subindex, std::uint32_t value);
  // Writing while the PDO is valid, or an entry while the number of objects is not 0: kUnsupportedAccess;
  // else the errors of a mapping as of `configure`.
  AbortCode read_mapping(std::uint8_t subindex, ObjectValue& value) const;
  AbortCode write_mapping(std::uint8_t subindex, std::uint32_t value, const Dictionary& dictionary);

  PdoDirection direction() const { return direction_; }
  bool valid() const { return (cob_id_ & kCobIdInvalid) == 0; }
  std::uint16_t identifier() const { return static_cast<std::uint16_t>(cob_id_ & kCobIdMask); }
  bool synchronous() const { return transmission_type_ <= kMaxSynchronous; }
  std::uint8_t transmission_type() const { return transmission_type_; }
  std::uint32_t inhibit_time_us() const { return inhibit_time_100us_ * 100u; }
  std::uint32_t event_timer_us() const { return event_timer_ms_ * 1000u; }
  // Whether a change of a value is an event of this TPDO's type. Events of type 254 are the manufacturer's:
  // here the event timer, if it is set, else changes.
  bool is_change_driven() const {
    return transmission_type_ == kSynchronousAcyclic || transmission_type_ == kEventProfile ||
           (transmission_type_ == kEventManufacturer && event_timer_ms_ == 0);
  }
  std::uint8_t sync_start() const { return sync_start_; }
  // Whether it has neither inhibit time nor event timer.
  bool untimed() const { return (inhibit_time_100us_ | event_timer_ms_) == 0; }
  std::uint8_t size_bytes() const { return size_bytes_; }

  // Whether an object is mapped.
  bool maps(ObjectAddress address) const {
    return std::ranges::any_of(mapped(), [address](const MappedObject& object) {
      return object.index == address.index && object.subindex == address.subindex;
    });
  }

  // Copy the mapped values to or from `size_bytes()` bytes of data. `unpack` leaves an object as it is if
  // Dictionary::check_value refuses its value, processes the others, and returns those refused: bit i, object
  // i of the mapping.
  void pack(const Dictionary& dictionary, std::uint8_t* data) const {
    const std::byte* const values = dictionary.value_at(0);
    for (const MappedObject& object : mapped()) {
      const std::size_t size = object.size_bytes;
      copy_value(data, values + object.offset, size);
      data += size;
    }
  }
  std::uint8_t unpack(Dictionary& dictionary, const std::uint8_t* data) const {
    if (restricted_) return unpack_checked(dictionary, data);
    std::byte* const values = dictionary.value_at(0);
    for (const MappedObject& object : mapped()) {
      const std::size_t size = object.size_bytes;
      if (object.offset != MappedObject::kDummy) copy_value(values + object.offset, data, size);
      data += size;
    }
    return 0;
  }
  // All objects of the mapping but its gaps: bit i, object i.
  std::uint8_t mapped_mask() const {
    unsigned mask = 0;
    for (std::size_t i = 0; i < mapped_count_; ++i)
      mask |= objects_[i].offset != MappedObject::kDummy ? 1u << i : 0u;
    return static_cast<std::uint8_t>(mask);
  }
  // Object `i` of the mapping.
  ObjectAddress mapped_address(std::size_t i) const { return {objects_[i].index, objects_[i].subindex}; }

  friend bool operator==(const PdoRecord&, const PdoRecord&) = default;

 private:
  // One load and one store: no data type has another size than 1, 2 and 4. Most values have 2 bytes.
  static void copy_value(void* to, const void* from, std::size_t size) {
    if (size == 2) {
      std::memcpy(to, from, 2);
    } else if (size == 4) {
      std::memcpy(to, from, 4);
    } else {
      std::memcpy(to, from, 1);
    }
  }
  std::span<const MappedObject> mapped() const { return {objects_.data(), mapped_count_}; }
  std::uint8_t unpack_checked(Dictionary& dictionary, const std::uint8_t* data) const;
  AbortCode write_cob_id(std::uint32_t cob_id);
  AbortCode write_mapped_count(std::uint32_t count, const Dictionary& dictionary);
  AbortCode resolve(std::uint32_t entry, const Dictionary& dictionary, MappedObject& object) const;

  std::uint32_t cob_id_ = kCobIdInvalid;
  std::uint16_t inhibit_time_100us_ = 0;
  std::uint16_t event_timer_ms_ = 0;
  std::uint8_t transmission_type_ = kEventProfile;
  std::uint8_t sync_start_ = 0;
  std::uint8_t mapped_count_ = 0;
  std::uint8_t size_bytes_ = 0;
  PdoDirection direction_;
  bool restricted_ = false;  // some mapped object does not take every value
  std::array<MappedObject, kMaxMappedObjects> objects_{};
};

// The last reception of an RPDO: a frame as long as its mapping, a shorter or longer one, or none within its
// event timer.
enum class Reception : std::uint8_t { kRight, kTooShort, kTooLong, kTimedOut };

// A PDO that a node receives.
struct Rpdo {
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  PdoRecord record{PdoDirection::kReceive};
  bool pending = false;  // data wait for the next SYNC
  Reception reception = Reception::kRight;
  std::uint8_t refused = 0;  // objects of the mapping, as of unpack(), in the last reception
  std::array<std::uint8_t, 8> data{};
  std::uint64_t deadline_us = kNever;  // of its event timer
};

// The PDOs that a node receives. Data of a synchronous PDO take effect at the next SYNC, of others at once.
// The event timer of a PDO starts with its first reception (CiA 301, 7.5.2.35).
class RpdoSet {
 public:
  RpdoSet(std::span<Rpdo> pdos, std::span<SlotMap::Item> slots) : pdos_(pdos), slots_(slots) {}

  std::size_t size() const { return pdos_.size(); }
  Rpdo& operator[](std::size_t number) { return pdos_[number]; }
  const Rpdo& operator[](std::size_t number) const { return pdos_[number]; }
  // To be called when record `number` has changed: drops data that wait for SYNC, and stops the event timer.
  void on_changed(std::size_t number);
  // Does the same for all PDOs.
  void stop();

  // Slot of the PDO with this identifier, or SlotMap::kNone. O(log n).
  std::size_t find(std::uint16_t identifier) const { return slots_.find(identifier); }
  // Whether this was the last reception of any PDO.
  bool any(Reception reception) const;
  // Whether the last reception of any PDO had a value that was refused.
  bool any_refused() const;

  // To be called when a frame for this PDO of the set has arrived.
  void restart_timer(Rpdo& pdo, std::uint64_t now_us) {
    if (pdo.record.event_timer_us() != 0) set_deadline(pdo, now_us + pdo.record.event_timer_us());
  }
  // True, and `number` set, when a PDO has exceeded its event timer; to be called again until false.
  bool check(std::uint64_t now_us, std::size_t& number) { return due(now_us) && find_silent(now_us, number); }
  // Whether `check` has anything to look at.
  bool due(std::uint64_t now_us) const { return now_us >= earliest_us_; }

 private:
  void set_deadline(Rpdo& pdo, std::uint64_t deadline_us);
  bool find_silent(std::uint64_t now_us, std::size_t& number);

  std::span<Rpdo> pdos_;
  SlotMap slots_;
  std::uint64_t earliest_us_ = Rpdo::kNever;  // no deadline lies before
};

// A PDO that a node sends.
struct Tpdo {
  PdoRecord record{PdoDirection::kTransmit};
  // An event waits for the end of the inhibit time, for room in the queue, or for the SYNC.
  bool requested = false;
  bool watched = false;         // a change of a value is an event
  bool counting = false;        // the SYNC with the start value has come, or there is none to wait for
  std::uint8_t sync_count = 0;  // SYNCs since the last transmission
  std::uint64_t inhibited_until_us = 0;
  std::uint64_t event_due_us = 0;
  std::array<std::uint8_t, 8> seen{};  // if watched: the data when last compared
};

// The PDOs that a node sends, each when its transmission type has it due (CiA 301, 7.2.2.3): at every n-th
// SYNC, counted from the one with the start value; at the SYNC after an event; or at the event itself and
// when the event timer runs out, but never sooner than the inhibit time allows.
//
// For the first `watched` PDOs every change of a mapped value is an event, and so is entering operational,
// since no node knows the values then. For the others the owner reports the events (request).
class TpdoSet {
 public:
  // Sends values of `dictionary` to `queue`. All must outlive the set.
  TpdoSet(std::span<Tpdo> pdos, std::size_t watched, const Dictionary& dictionary, TransmitQueue& queue)
      : pdos_(pdos), watched_(watched), dictionary_(dictionary), queue_(queue) {}

  std::size_t size() const { return pdos_.size(); }
  Tpdo& operator[](std::size_t number) { return pdos_[number]; }
  const Tpdo& operator[](std::size_t number) const { return pdos_[number]; }

  // Whether a valid PDO has this identifier. O(n).
  bool sends(std::uint16_t identifier) const;
  // To be called when record `number` has changed: drops events that wait, counts SYNCs anew, and ends the
  // event timer: the next `process` sends the PDO, and the new time counts from there. The inhibit time of a
  // PDO ends when the PDO becomes invalid.
  void on_changed(std::size_t number);
  // To be called when record `number` was configured as a whole: the same, and the inhibit time ends.
  void on_configured(std::size_t number);
  // To be called when the node enters operational: restarts counters and event timers, ends inhibit times.
  void start(std::uint64_t now_us);
  // Reports an event of PDO `number`.
  void request(std::size_t number, std::uint64_t now_us);
  // `counter` of the SYNC, 1..240; 0 when it carries none.
  void on_sync(std::uint8_t counter, std::uint64_t now_us);
  void process(std::uint64_t now_us) {
    if (watched_end_ != 0) watch();
    if (now_us >= due_us_) send_due(now_us);
  }

 private:
  static void forget(Tpdo& pdo);
  void watch();
  static bool is_due(Tpdo& pdo, std::uint8_t counter);
  void send_due(std::uint64_t now_us);
  void send(Tpdo& pdo, std::uint64_t now_us);

  std::span<Tpdo> pdos_;
  std::size_t watched_;
  const Dictionary& dictionary_;
  TransmitQueue& queue_;
  std::uint64_t due_us_ = 0;         // nothing is due before
  std::size_t synchronous_end_ = 0;  // behind the last synchronous one
  std::size_t watched_end_ = 0;      // behind the last whose values are watched
};

}  // namespace koboshi::canopen
