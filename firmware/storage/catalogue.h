#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/storage/item.h"

namespace koboshi::storage {

// What the storage holds, and where: an image of its own (image.h) at the start of the storage, whose
// body is a count u16, a reserved u16 and for each item kind u16, number u16, offset u32 and size u32.
// Offsets are from the start of the storage.
inline constexpr std::uint32_t kCatalogueMagic = 0x5441434Bu;  // "KCAT"
inline constexpr std::uint16_t kCatalogueVersion = 1;
inline constexpr std::size_t kCatalogueItemSize = 12;

class Catalogue {
 public:
  // An empty catalogue where the storage holds none, or a damaged one.
  explicit Catalogue(std::span<const std::byte> storage);

  // The bytes of an item; empty where there is none.
  std::span<const std::byte> find(ItemKind kind, std::uint16_t number) const;

 private:
  std::span<const std::byte> storage_;
  std::span<const std::byte> items_;
};

}  // namespace koboshi::storage
