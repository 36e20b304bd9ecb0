#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "hal/port/storage.h"

namespace koboshi::hal {

// Models a microcontroller's flash in ordinary memory. The simulated board and the Cortex-M4 image share this
// model, so that both have the same contents and wait equally long: an operation ends after a fixed number of
// `state` calls, one per millisecond, instead of after a time. Until then its range reads as scrambled bytes.
class FlashModel final : public StoragePort {
 public:
  static constexpr std::size_t kSectorSize_bytes = 2048;
  static constexpr std::size_t kSize_bytes = 128 * kSectorSize_bytes;
  // Number of `state` calls that return kBusy. From the data sheet of the STM32G431 (DS12589): 22 ms to erase
  // a page of 2 KiB and 82 us to program 8 bytes, which is 2.6 ms for kMaxWriteSize.
  static constexpr int kErasePolls = 22;
  static constexpr int kWritePolls = 3;

  // `memory` is the flash, with its present contents. It must outlive the model.
  explicit FlashModel(std::span<std::byte, kSize_bytes> memory) : memory_(memory) {}

  // Programs bytes at once, as in the factory. Returns false and changes nothing if they do not fit.
  [[nodiscard]] bool program(std::size_t offset, std::span<const std::byte> bytes);

  [[nodiscard]] std::span<const std::byte> contents() const override { return memory_; }
  [[nodiscard]] std::size_t sector_size_bytes() const override { return kSectorSize_bytes; }
  [[nodiscard]] bool begin_erase(std::size_t offset) override;
  [[nodiscard]] bool begin_write(std::size_t offset, std::span<const std::byte> bytes) override;
  [[nodiscard]] StorageState state() const override;

 private:
  void scramble(std::size_t offset, std::size_t size) const;
  void complete() const;

  std::span<std::byte, kSize_bytes> memory_;
  std::array<std::byte, kMaxWriteSize> page_;  // contents of the write in progress
  std::size_t offset_ = 0;
  std::size_t size_ = 0;         // of the write; 0 for an erasure
  mutable int polls_left_ = -1;  // of the operation in progress; negative: none
};

}  // namespace koboshi::hal
