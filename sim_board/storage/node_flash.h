#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "hal/port/storage.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim {

// The flash of a drive's or sensor's microcontroller, three sectors of it. An operation ends after a fixed
// number of `state` calls, one a millisecond; the range that it works on reads as scrambled bytes until then,
// and for good where the power fails in the middle.
class NodeFlash final : public hal::StoragePort {
 public:
  static constexpr std::size_t kSectorSize_bytes = 2048;
  static constexpr std::size_t kSectors = 3;
  // An STM32G431 (DS12589) takes 22 ms to erase a page of 2 KiB and 82 us to program 8 bytes, which is 2.6 ms
  // for kMaxWriteSize.
  static constexpr int kErasePolls = 22;
  static constexpr int kWritePolls = 3;

  NodeFlash() { memory_.fill(kErased); }

  // The operation that runs is never finished.
  void lose_power() { polls_left_ = -1; }

  [[nodiscard]] std::span<const std::byte> contents() const override { return memory_; }
  [[nodiscard]] std::size_t sector_size_bytes() const override { return kSectorSize_bytes; }
  [[nodiscard]] bool begin_erase(std::size_t offset) override;
  [[nodiscard]] bool begin_write(std::size_t offset, std::span<const std::byte> bytes) override;
  [[nodiscard]] hal::StorageState state() const override;

  void archive(StateArchive& archive) {
    archive.flash(memory_);
    archive.flash(result_);
    archive(offset_, size_, polls_left_);
  }

 private:
  static constexpr std::byte kErased{0xFF};

  void begin(std::size_t offset, std::size_t size, int polls);
  void complete() const;

  // Time passes for the memory where `state`, a const verb, is polled.
  mutable std::array<std::byte, kSectors * kSectorSize_bytes> memory_;
  std::array<std::byte, kSectorSize_bytes> result_{};  // what the range of the operation is to hold
  std::size_t offset_ = 0;
  std::size_t size_ = 0;
  mutable int polls_left_ = -1;  // of the running operation; negative when there is none
};

}  // namespace koboshi::sim
