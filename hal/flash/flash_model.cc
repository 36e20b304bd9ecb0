#include "hal/flash/flash_model.h"

#include <algorithm>

namespace koboshi::hal {
namespace {

constexpr std::byte kErased{0xFF};
constexpr std::byte kScramble{0xA5};

}  // namespace

bool FlashModel::program(std::size_t offset, std::span<const std::byte> bytes) {
  if (offset > kSize_bytes || bytes.size() > kSize_bytes - offset) return false;
  std::ranges::copy(bytes, memory_.subspan(offset).begin());
  return true;
}

bool FlashModel::begin_erase(std::size_t offset) {
  if (polls_left_ >= 0 || offset >= kSize_bytes || offset % kSectorSize_bytes != 0) return false;
  offset_ = offset;
  size_ = 0;
  polls_left_ = kErasePolls;
  scramble(offset, kSectorSize_bytes);
  return true;
}

bool FlashModel::begin_write(std::size_t offset, std::span<const std::byte> bytes) {
  if (polls_left_ >= 0 || bytes.empty() || bytes.size() > kMaxWriteSize) return false;
  if (offset > kSize_bytes || bytes.size() > kSize_bytes - offset) return false;
  const auto old = contents().subspan(offset, bytes.size());
  const bool only_clears = std::ranges::equal(
      bytes, old, [](std::byte wanted, std::byte present) { return (wanted & ~present) == std::byte{0}; });
  if (!only_clears) return false;
  std::ranges::copy(bytes, page_.begin());
  offset_ = offset;
  size_ = bytes.size();
  polls_left_ = kWritePolls;
  scramble(offset, size_);
  return true;
}

StorageState FlashModel::state() const {
  if (polls_left_ < 0) return StorageState::kIdle;
  if (polls_left_-- > 0) return StorageState::kBusy;
  complete();
  return StorageState::kIdle;
}

void FlashModel::scramble(std::size_t offset, std::size_t size) const {
  for (std::byte& byte : memory_.subspan(offset, size)) byte ^= kScramble;
}

void FlashModel::complete() const {
  if (size_ == 0) {
    std::ranges::fill(memory_.subspan(offset_, kSectorSize_bytes), kErased);
  } else {
    std::copy_n(page_.begin(), size_, memory_.subspan(offset_).begin());
  }
}

}  // namespace koboshi::hal
