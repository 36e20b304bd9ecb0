#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "firmware/canopen/abort_code.h"
#include "firmware/canopen/cob_id.h"
#include "firmware/canopen/dictionary.h"
#include "hal/port/can.h"

namespace koboshi::canopen {

inline constexpr std::size_t kMaxMappedObjects = 8;  // one byte each

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

// Communication and mapping record of a PDO as it is after a reset.
struct PdoConfiguration {
  std::uint32_t cob_id = kCobIdInvalid;  // identifier, or kCobIdInvalid
  bool plus_node_id = false;             // add the node's id to it, as the predefined connection set does
  std::uint8_t transmission_type = kEventProfile;
  std::uint16_t inhibit_time_100us = 0;  // TPDO: shortest time between two
  // TPDO, event-driven: longest time between two. RPDO: longest silence, then EMCY 0x8250. 0: none.
  std::uint16_t event_timer_ms = 0;
  std::uint8_t sync_start = 0;  // TPDO, every n-th SYNC: counter of the SYNC to count from; 0: the next
  std::array<std::uint32_t, kMaxMappedObjects> mapping{};  // ends at the first 0
};

// An object in a PDO, resolved to its value's bytes.
struct MappedObject {
  static constexpr std::uint16_t kDummy = Entry::kConstant;  // an RPDO skips these bytes

  std::uint16_t index = 0;  // 0: no object
  std::uint8_t subindex = 0;
  std::uint8_t size_bytes = 0;
  std::uint16_t offset = 0;

  friend bool operator==(const MappedObject&, const MappedObject&) = default;
};

enum class PdoDirection : std::uint8_t { kReceive, kTransmit };

// Communication and mapping record of one PDO: the objects 0x1400 + n and 0x1600 + n, or 0x1800 + n and
// 0x1A00 + n. The size of what is written has been checked before. Writes obey CiA 301: identifier and timing
// change only while the PDO is invalid, the mapping only while it is invalid and its number of objects is 0.
class PdoRecord {
 public:
  explicit PdoRecord(PdoDirection direction) : direction_(direction) {}

  // Everything at once, as after a reset. An error leaves the PDO invalid.
  AbortCode configure(const PdoConfiguration& configuration, std::uint8_t node_id,
                      const Dictionary& dictionary);

  AbortCode read_communication(std::uint8_t subindex, ObjectValue& value) const;
  AbortCode write_communication(std::uint8_t subindex, std::uint32_t value);
  AbortCode read_mapping(std::uint8_t subindex, ObjectValue& value) const;
  AbortCode write_mapping(std::uint8_t subindex, std::uint32_t value, const Dictionary& dictionary);

  bool valid() const { return (cob_id_ & kCobIdInvalid) == 0; }
  std::uint16_t identifier() const { return static_cast<std::uint16_t>(cob_id_ & kCobIdMask); }
  bool synchronous() const { return transmission_type_ <= kMaxSynchronous; }
  std::uint8_t transmission_type() const { return transmission_type_; }
  std::uint32_t inhibit_time_us() const { return inhibit_time_100us_ * 100u; }
  std::uint32_t event_timer_us() const { return event_timer_ms_ * 1000u; }
  // Whether a change of a value is an event of this TPDO's type. That of type 254 is the manufacturer's: the
  // event timer where one is set.
  bool tells_changes() const {
    return transmission_type_ == kSynchronousAcyclic || transmission_type_ == kEventProfile ||
           (transmission_type_ == kEventManufacturer && event_timer_ms_ == 0);
  }
  std::uint8_t sync_start() const { return sync_start_; }
  // Neither inhibit time nor event timer: it goes whenever it is asked for.
  bool untimed() const { return (inhibit_time_100us_ | event_timer_ms_) == 0; }
  std::uint8_t size_bytes() const { return size_bytes_; }

  // Copies the mapped values to or from `size_bytes()` bytes of data.
  void pack(const Dictionary& dictionary, std::uint8_t* data) const {
    const std::byte* const values = dictionary.value_at(0);
    for (const MappedObject& object : mapped()) {
      const std::size_t size = object.size_bytes;
      copy_value(data, values + object.offset, size);
      data += size;
    }
  }
  void unpack(Dictionary& dictionary, const std::uint8_t* data) const {
    std::byte* const values = dictionary.value_at(0);
    for (const MappedObject& object : mapped()) {
      const std::size_t size = object.size_bytes;
      if (object.offset != MappedObject::kDummy) copy_value(values + object.offset, data, size);
      data += size;
    }
  }

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
  AbortCode write_cob_id(std::uint32_t cob_id);
  AbortCode write_mapped_count(std::uint32_t count);
  AbortCode resolve(std::uint32_t entry, const Dictionary& dictionary, MappedObject& object) const;

  std::uint32_t cob_id_ = kCobIdInvalid;
  std::uint16_t inhibit_time_100us_ = 0;
  std::uint16_t event_timer_ms_ = 0;
  std::uint8_t transmission_type_ = kEventProfile;
  std::uint8_t sync_start_ = 0;
  std::uint8_t mapped_count_ = 0;
  std::uint8_t size_bytes_ = 0;
  PdoDirection direction_;
  std::array<MappedObject, kMaxMappedObjects> objects_{};
};

}  // namespace koboshi::canopen
