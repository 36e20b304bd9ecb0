#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/storage/item.h"

namespace koboshi::storage {

// The catalogue of the items that the factory has put into storage: an image (image.h) at the start of the
// storage, whose body is count u16, reserved u16 and, for each item, kind u16, number u16, offset u32 from
// the start of the storage, and size u32 in bytes.
inline constexpr std::uint32_t kCatalogueMagic = 0x5441434Bu;  // "KCAT"
inline constexpr std::uint16_t kCatalogueVersion = 1;
inline constexpr std::size_t kCatalogueItemSize = 12;

class Catalogue {
 public:
  // Empty when the storage holds no valid catalogue. `storage` must outlive the catalogue.
  explicit Catalogue(std::span<const std::byte> storage);

  // The bytes of an item, in place; empty when there is none.
  std::span<const std::byte> find(ItemKind kind, std::uint16_t number) const;

 private:
  std::span<const std::byte> storage_;
  std::span<const std::byte> items_;
};

}  // namespace koboshi::storage
