#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/pdo.h"
#include "firmware/canopen/slot_map.h"

namespace koboshi::canopen {

// How the last frame of an RPDO compares with its mapping.
enum class Length : std::uint8_t { kRight, kTooShort, kTooLong };

// A PDO that a node receives.
struct Rpdo {
  PdoRecord record{PdoDirection::kReceive};
  bool pending = false;  // data wait for the next SYNC
  Length length = Length::kRight;
  std::array<std::uint8_t, 8> data{};
};

// The PDOs that a node receives. Data of a synchronous one take effect at the SYNC that follows, of the
// others at once.
class RpdoSet {
 public:
  RpdoSet(std::span<Rpdo> pdos, std::span<SlotMap::Item> slots) : pdos_(pdos), slots_(slots) {}

  std::size_t size() const { return pdos_.size(); }
  Rpdo& operator[](std::size_t number) { return pdos_[number]; }
  const Rpdo& operator[](std::size_t number) const { return pdos_[number]; }
  // To be called when a record has changed.
  void update_identifiers();
  // Drops data that wait for a SYNC.
  void clear_pending();

  // Slot of the PDO with this identifier, or SlotMap::kNone. O(log n).
  std::size_t find(std::uint16_t identifier) const { return slots_.find(identifier); }
  // True when the last frame of some PDO had this length.
  bool any(Length length) const;

 private:
  std::span<Rpdo> pdos_;
  SlotMap slots_;
};

}  // namespace koboshi::canopen
