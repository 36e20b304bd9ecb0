#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "hal/port/storage.h"

namespace koboshi::test {

// Flash whose power fails at a chosen word. An operation ends with the next call of `state`. A word is a unit
// of a write, or a whole erasure. The word at the failure has undefined contents, and must be erased before
// it is written again even if it reads as erased; those after it keep theirs. Writing a word twice fails the
// test.
class CutFlash final : public hal::StoragePort {
 public:
  CutFlash(std::size_t size_bytes, std::size_t sector_size_bytes, std::uint32_t seed = 1)
      : sector_size_(sector_size_bytes),
        random_(seed),
        bytes_(size_bytes, kErased),
        written_(size_bytes / kWriteUnit_bytes),
        erasures(size_bytes / sector_size_bytes) {}

  // --- Functions for tests ---

  void cut_after(std::uint64_t words) { words_left_ = words; }
  bool is_off() const { return off_; }
  void power_on() {
    off_ = false;
    words_left_.reset();
    state_ = hal::StorageState::kIdle;
  }
  // The next operation ends in kFailed.
  void fail_next() { fails_ = true; }
  // The next write ends with a bit wrong, without a word about it.
  void corrupt_next() { corrupts_ = true; }
  void load(std::size_t offset, std::span<const std::byte> bytes) {
    std::ranges::copy(bytes, bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
    for (std::size_t i = 0; i < bytes.size(); ++i) written_[(offset + i) / kWriteUnit_bytes] = true;
  }

  // --- StoragePort ---

  [[nodiscard]] std::span<const std::byte> contents() const override { return bytes_; }
  [[nodiscard]] std::size_t sector_size_bytes() const override { return sector_size_; }
  [[nodiscard]] bool begin_erase(std::size_t offset) override {
    EXPECT_EQ(offset % sector_size_, 0u);
    if (!begin()) return true;
    const bool torn = cuts();
    if (torn || fails_) return damage(offset, sector_size_, torn), true;
    std::fill_n(at(offset), sector_size_, kErased);
    std::fill_n(written_.begin() + static_cast<std::ptrdiff_t>(offset / kWriteUnit_bytes),
                sector_size_ / kWriteUnit_bytes, false);
    ++erasures[offset / sector_size_];
    ++words;
    return true;
  }
  [[nodiscard]] bool begin_write(std::size_t offset, std::span<const std::byte> bytes) override {
    EXPECT_TRUE(!bytes.empty() && bytes.size() <= kMaxWriteSize);
    EXPECT_TRUE(offset % kWriteUnit_bytes == 0 && bytes.size() % kWriteUnit_bytes == 0);
    if (!begin()) return true;
    if (fails_) return damage(offset, bytes.size(), false), true;
    for (std::size_t i = 0; i < bytes.size(); i += kWriteUnit_bytes) {
      const std::size_t unit = (offset + i) / kWriteUnit_bytes;
      EXPECT_FALSE(written_[unit]) << "written twice: " << offset + i;
      if (cuts()) return damage(offset + i, kWriteUnit_bytes, true), true;
      std::ranges::copy(bytes.subspan(i, kWriteUnit_bytes), at(offset + i));
      written_[unit] = true;
      ++words;
    }
    if (std::exchange(corrupts_, false))
      *at(offset + random_() % bytes.size()) ^= static_cast<std::byte>(1u << random_() % 8);
    return true;
  }
  [[nodiscard]] hal::StorageState state() const override { return off_ ? hal::StorageState::kBusy : state_; }

 private:
  static constexpr std::byte kErased{0xFF};

  std::vector<std::byte>::iterator at(std::size_t offset) {
    return bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
  }
  bool begin() {
    state_ = hal::StorageState::kIdle;
    return !off_;
  }
  bool cuts() { return words_left_ && (*words_left_)-- == 0; }
  // Each word of the range becomes erased, random, or keeps its contents.
  void damage(std::size_t offset, std::size_t size, bool by_power) {
    for (std::size_t i = 0; i < size; ++i) {
      if (i % kWriteUnit_bytes == 0) kind_ = random_() % 3;
      if (kind_ == 0) *at(offset + i) = kErased;
      if (kind_ == 1) *at(offset + i) = static_cast<std::byte>(random_());
      written_[(offset + i) / kWriteUnit_bytes] = true;
    }
    off_ = by_power;
    if (by_power) return;
    fails_ = false;
    state_ = hal::StorageState::kFailed;
  }

  std::size_t sector_size_;
  std::mt19937 random_;
  std::vector<std::byte> bytes_;
  std::vector<bool> written_;  // by unit, since the last erasure
  std::optional<std::uint64_t> words_left_;
  std::uint_fast32_t kind_ = 0;
  bool off_ = false;
  bool fails_ = false;
  bool corrupts_ = false;
  hal::StorageState state_ = hal::StorageState::kIdle;

 public:
  std::vector<std::uint32_t> erasures;  // by sector
  std::uint64_t words = 0;              // completed
};

}  // namespace koboshi::test
