#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace koboshi::hal {

enum class StorageState : std::uint8_t { kIdle = 0, kBusy = 1, kFailed = 2 };

// Non-volatile memory with the properties of flash: memory-mapped for reading, erased by sectors to 0xFF,
// written by clearing bits. Erasures and writes are asynchronous: they begin here and end when `state` no
// longer returns kBusy.
class StoragePort {
 public:
  // Returns the whole memory. While an erasure or a write runs, the bytes of its range are undefined.
  [[nodiscard]] virtual std::span<const std::byte> contents() const = 0;
  // Returns the size of a sector, a divisor of the size of `contents`.
  [[nodiscard]] virtual std::size_t sector_size_bytes() const = 0;
  // Begins to erase the sector at `offset`. Returns false and does nothing if busy, or if the offset is out
  // of range or not the start of a sector.
  [[nodiscard]] virtual bool begin_erase(std::size_t offset) = 0;
  // Begins to write `bytes`, at most kMaxWriteSize, and copies them before it returns. Returns false and does
  // nothing if busy, out of range or too long, or if a cleared bit would have to be set.
  [[nodiscard]] virtual bool begin_write(std::size_t offset, std::span<const std::byte> bytes) = 0;
  // Returns the state of the last operation. The firmware polls it each millisecond during an operation.
  [[nodiscard]] virtual StorageState state() const = 0;

  static constexpr std::size_t kMaxWriteSize = 256;

 protected:
  ~StoragePort() = default;
};

}  // namespace koboshi::hal
