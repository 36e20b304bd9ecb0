#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "firmware/canopen/pdo.h"
#include "firmware/canopen/slot_map.h"

namespace koboshi::canopen {

// What was heard of an RPDO last: a frame as long as its mapping, another, or nothing for its event timer.
enum class Reception : std::uint8_t { kRight, kTooShort, kTooLong, kTimedOut };

// A PDO that a node receives.
struct Rpdo {
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  PdoRecord record{PdoDirection::kReceive};
  bool pending = false;  // data wait for the next SYNC
  Reception reception = Reception::kRight;
  std::array<std::uint8_t, 8> data{};
  std::uint64_t deadline_us = kNever;  // of its event timer
};

// The PDOs that a node receives. Data of a synchronous one take effect at the SYNC that follows, of the
// others at once. The event timer of one runs from its first reception on (CiA 301, 7.5.2.35).
class RpdoSet {
 public:
  RpdoSet(std::span<Rpdo> pdos, std::span<SlotMap::Item> slots) : pdos_(pdos), slots_(slots) {}

  std::size_t size() const { return pdos_.size(); }
  Rpdo& operator[](std::size_t number) { return pdos_[number]; }
  const Rpdo& operator[](std::size_t number) const { return pdos_[number]; }
  // To be called when record `number` has changed: what waited is dropped, its event timer stops.
  void on_changed(std::size_t number);
  // The same for all of them.
  void stop();

  // Slot of the PDO with this identifier, or SlotMap::kNone. O(log n).
  std::size_t find(std::uint16_t identifier) const { return slots_.find(identifier); }
  // True when this was the last news of some PDO.
  bool any(Reception reception) const;

  // A frame for this PDO of the set has taken effect, or will at the SYNC.
  void restart_timer(Rpdo& pdo, std::uint64_t now_us) {
    if (pdo.record.event_timer_us() != 0) set_deadline(pdo, now_us + pdo.record.event_timer_us());
  }
  // True when PDO `number` has been silent for too long; to be called again until false.
  bool check(std::uint64_t now_us, std::size_t& number) {
    return now_us >= earliest_us_ && find_silent(now_us, number);
  }

 private:
  void set_deadline(Rpdo& pdo, std::uint64_t deadline_us);
  bool find_silent(std::uint64_t now_us, std::size_t& number);

  std::span<Rpdo> pdos_;
  SlotMap slots_;
  std::uint64_t earliest_us_ = Rpdo::kNever;  // no deadline lies before
};

}  // namespace koboshi::canopen
