#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "hal/port/storage.h"
#include "sim_board/state/archive.h"

namespace koboshi::sim_board {

// Flash of a drive's or sensor's microcontroller with four sectors: room for some
// hundred parameters beside what ItemStore needs for its compaction. An operation ends after a fixed number
// of `state` calls, one per millisecond. Until then its range reads as scrambled bytes, and permanently so if
// power fails meanwhile.
class NodeFlash final : public hal::StoragePort {
 public:
  static constexpr std::size_t kSectorSize_bytes = 2048;
  static constexpr std::size_t kSectors = 4;
  static constexpr std::size_t kSize_bytes = kSectors * kSectorSize_bytes;
  // From the data sheet of the STM32G431 (DS12589): 22 ms to erase a page of 2 KiB and 82 us to program 8
  // bytes, which is 2.6 ms for kMaxWriteSize.
  static constexpr int kErasePolls = 22;
  static constexpr int kWritePolls = 3;

  NodeFlash() {
    memory_.fill(kErased);
    written_.fill(kErased);
  }

  // Aborts the operation in progress; its range stays scrambled.
  void lose_power() { polls_left_ = -1; }

  [[nodiscard]] std::span<const std::byte> contents() const override { return memory_; }
  [[nodiscard]] std::size_t sector_size_bytes() const override { return kSectorSize_bytes; }
  [[nodiscard]] bool begin_erase(std::size_t offset) override;
  [[nodiscard]] bool begin_write(std::size_t offset, std::span<const std::byte> bytes) override;
  [[nodiscard]] hal::StorageState state() const override;

  void archive(StateArchive& archive);

 private:
  static constexpr std::byte kErased{0xFF};

  void begin(std::size_t offset, std::size_t size, int polls);
  void complete() const;

  // Mutable, because polling the const function `state` advances the operation.
  mutable std::array<std::byte, kSize_bytes> memory_;
  std::array<std::byte, kMaxWriteSize> written_{};  // final contents of the range of a write
  std::size_t offset_ = 0;
  std::size_t size_ = 0;
  bool erases_ = false;
  mutable int polls_left_ = -1;  // of the operation in progress; negative: none
};

}  // namespace koboshi::sim_board
