#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "hal/port/storage.h"

namespace koboshi::hal {

// A microcontroller's flash, modelled in ordinary memory. The simulated board in process and the Cortex-M4
// image both store in it, so that both see the same contents and wait equally long: an operation ends after a
// fixed number of `state` calls, which the firmware makes once a millisecond, and not after a time. Until
// then the range that it works on reads as scrambled bytes.
class FlashModel final : public StoragePort {
 public:
  static constexpr std::size_t kSectorSize_bytes = 2048;
  static constexpr std::size_t kSize_bytes = 128 * kSectorSize_bytes;
  // Calls of `state` that find an operation busy. The STM32G431 (DS12589) takes 22 ms to erase a page of 2
  // KiB and 82 us to program 8 bytes, which is 2.6 ms for kMaxWriteSize.
  static constexpr int kErasePolls = 22;
  static constexpr int kWritePolls = 3;

  // The memory is the flash: it is taken as it is, and must outlive the model.
  explicit FlashModel(std::span<std::byte, kSize_bytes> memory) : memory_(memory) {}

  // Puts bytes in place at once, as in the factory. False, and nothing done, when they do not fit.
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
  std::array<std::byte, kMaxWriteSize> page_;  // what is being written
  std::size_t offset_ = 0;
  std::size_t size_ = 0;         // of the write; 0 for an erasure
  mutable int polls_left_ = -1;  // of the running operation; negative when there is none
};

}  // namespace koboshi::hal
