#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace koboshi::hal {

enum class StorageState : std::uint8_t { kIdle = 0, kBusy = 1, kFailed = 2 };

// Non-volatile memory as flash offers it: mapped for reading, erased by sectors to 0xFF, written by clearing
// bits. Erasing and writing are asynchronous: they are begun here and end when `state` leaves kBusy.
class StoragePort {
 public:
  // The whole memory. The bytes of a sector under erasure, and of a range being written, are undefined until
  // idle.
  [[nodiscard]] virtual std::span<const std::byte> contents() const = 0;
  [[nodiscard]] virtual std::size_t sector_size_bytes() const = 0;
  // Begins to erase the sector that starts at `offset`. False when busy, misaligned or out of range.
  [[nodiscard]] virtual bool begin_erase(std::size_t offset) = 0;
  // Begins to write; `bytes` are copied before it returns, at most kMaxWriteSize of them.
  // False when busy, out of range, too long, or where a bit would have to be set.
  [[nodiscard]] virtual bool begin_write(std::size_t offset, std::span<const std::byte> bytes) = 0;
  [[nodiscard]] virtual StorageState state() const = 0;

  static constexpr std::size_t kMaxWriteSize = 256;

 protected:
  ~StoragePort() = default;
};

}  // namespace koboshi::hal
