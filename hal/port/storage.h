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
  // Returns the whole memory: the catalogue of the robot from the start, the log of its own items at the end
  // (storage::kRobotLogSize_bytes, 128 KiB). While an erasure or a write runs, the bytes of its range are
  // undefined, and all others can be read: the firmware stores items also while it plays a motion in place.
  [[nodiscard]] virtual std::span<const std::byte> contents() const = 0;
  // Returns the size of a sector: 128 bytes to 4 KiB, a power of two. It divides the size of `contents`. With
  // sectors of up to 2 KiB the log holds 200 motions of 592 bytes and the parameters, with 4 KiB 194.
  [[nodiscard]] virtual std::size_t sector_size_bytes() const = 0;
  // Begins to erase the sector at `offset`. Returns false and does nothing if busy, or if the offset is out
  // of range or not the start of a sector.
  [[nodiscard]] virtual bool begin_erase(std::size_t offset) = 0;
  // Begins to write `bytes`, 1 to kMaxWriteSize, and copies them before it returns. Returns false and does
  // nothing if busy, empty, out of range or too long, or if a cleared bit would have to be set. The firmware
  // writes whole units: offset and size are multiples of kWriteUnit_bytes, and no unit is written twice
  // between two erasures.
  [[nodiscard]] virtual bool begin_write(std::size_t offset, std::span<const std::byte> bytes) = 0;
  // Returns the state of the last operation. The firmware polls it each millisecond during an operation.
  // After kFailed the contents of the operation's range are undefined, and the next operation may begin; the
  // state stays kFailed until then. A driver that continues the operation here keeps its progress in mutable
  // members.
  [[nodiscard]] virtual StorageState state() const = 0;

  static constexpr std::size_t kMaxWriteSize = 256;
  // Flash with error correction is written by double words, each with its check bits: once only.
  static constexpr std::size_t kWriteUnit_bytes = 8;

 protected:
  ~StoragePort() = default;
};

}  // namespace koboshi::hal
