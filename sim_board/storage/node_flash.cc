#include "sim_board/storage/node_flash.h"

#include <algorithm>

namespace koboshi::sim_board {
namespace {

constexpr std::byte kScramble{0xA5};

bool only_clears(std::span<const std::byte> wanted, std::span<const std::byte> present) {
  return std::ranges::equal(wanted, present,
                            [](std::byte to, std::byte from) { return (to & ~from) == std::byte{0}; });
}

}  // namespace

bool NodeFlash::begin_erase(std::size_t offset) {
  if (polls_left_ >= 0 || offset >= memory_.size() || offset % kSectorSize_bytes != 0) return false;
  erases_ = true;
  written_.fill(kErased);  // takes no room in an archive
  begin(offset, kSectorSize_bytes, kErasePolls);
  return true;
}

bool NodeFlash::begin_write(std::size_t offset, std::span<const std::byte> bytes) {
  if (polls_left_ >= 0 || bytes.empty() || bytes.size() > kMaxWriteSize) return false;
  if (offset > memory_.size() || bytes.size() > memory_.size() - offset) return false;
  if (!only_clears(bytes, contents().subspan(offset, bytes.size()))) return false;
  erases_ = false;
  std::ranges::copy(bytes, written_.begin());
  begin(offset, bytes.size(), kWritePolls);
  return true;
}

void NodeFlash::begin(std::size_t offset, std::size_t size, int polls) {
  offset_ = offset;
  size_ = size;
  polls_left_ = polls;
  for (std::byte& byte : std::span(memory_).subspan(offset, size)) byte ^= kScramble;
}

hal::StorageState NodeFlash::state() const {
  if (polls_left_ < 0) return hal::StorageState::kIdle;
  if (polls_left_-- > 0) return hal::StorageState::kBusy;
  complete();
  return hal::StorageState::kIdle;
}

void NodeFlash::complete() const {
  const auto range = std::span(memory_).subspan(offset_, size_);
  if (erases_) {
    std::ranges::fill(range, kErased);
  } else {
    std::copy_n(written_.begin(), size_, range.begin());
  }
}

void NodeFlash::archive(StateArchive& archive) {
  archive.flash(memory_);
  archive.flash(written_);
  archive(offset_, size_, erases_, polls_left_);
}

}  // namespace koboshi::sim_board
