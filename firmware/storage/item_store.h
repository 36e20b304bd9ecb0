#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/item_store.h"
#include "firmware/storage/catalogue.h"

namespace koboshi::storage {

// What the robot stores itself: parameters, and motions that take the place of the factory's in the catalogue
// (docs/decision/0010-parameters-in-flash.md).
class ItemStore : public canopen::ItemStore {
 public:
  static constexpr std::size_t kSlotSize = 6 * 1024;      // a motion of seventy poses of twenty joints
  static constexpr std::size_t kSlots = kMaxMotions + 2;  // the parameters, and the spare one
  static constexpr std::size_t kSize = kSlots * kSlotSize;
  static constexpr std::size_t kMaxItemSize = kSlotSize - kTrailerSize;
  static_assert(kSlots <= kMaxSlots);

  explicit ItemStore(hal::StoragePort& storage) : canopen::ItemStore(storage, {kSlotSize, kSlots}) {}

  std::span<const std::byte> find(ItemKind kind, std::uint16_t number) const {
    return canopen::ItemStore::find(static_cast<std::uint16_t>(kind), number);
  }
  canopen::AbortCode begin(ItemKind kind, std::uint16_t number) {
    return canopen::ItemStore::begin(static_cast<std::uint16_t>(kind), number);
  }
};

}  // namespace koboshi::storage
