#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/storage/image.h"
#include "firmware/storage/item_store.h"

// The records of the log; for the files of ItemStore only.
namespace koboshi::storage {

inline constexpr std::uint16_t kErasedItem = 0xFFFF;  // a header's size
static_assert(ItemStore::kMaxItemSize_bytes < kErasedItem);

// Returns the bytes that a record takes, with its header and the padding.
constexpr std::size_t record_size(std::size_t item_size) {
  constexpr std::size_t kUnit = hal::StoragePort::kWriteUnit_bytes;
  const std::size_t padded = (item_size + kUnit - 1) / kUnit * kUnit;
  return ItemStore::kHeaderSize + (item_size == kErasedItem ? 0 : padded);
}

struct ItemStore::Header {
  static constexpr std::size_t kCheckOffset = kHeaderSize - 4;  // of the CRC-32 of the bytes before it

  std::uint8_t kind = 0;
  std::uint8_t number = 0;
  std::uint16_t size = 0;
  std::uint32_t sequence = 0;
  std::uint32_t crc = 0;

  std::array<std::byte, kHeaderSize> encode() const {
    std::array<std::byte, kHeaderSize> bytes;
    FieldWriter writer(bytes);
    writer.u8(kind);
    writer.u8(number);
    writer.u16(size);
    writer.u32(sequence);
    writer.u32(crc);
    writer.u32(crc32(std::span(bytes).first(kCheckOffset)));
    return bytes;
  }
};

}  // namespace koboshi::storage
