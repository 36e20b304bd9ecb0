#include "hal/fake/storage.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace koboshi::hal {
namespace {

constexpr std::byte kErased{0xFF};
constexpr std::byte kScramble{0xA5};

}  // namespace

FakeStorage::FakeStorage(std::size_t sector_count, std::size_t sector_size_bytes)
    : sector_size_bytes_(sector_size_bytes), bytes_(sector_count * sector_size_bytes, kErased) {}

void FakeStorage::finish() {
  if (operation_) complete();
}

void FakeStorage::lose_power() {
  operation_.reset();
  failed_ = false;
}

void FakeStorage::load(std::size_t offset, std::span<const std::byte> bytes) {
  assert(offset <= bytes_.size() && bytes.size() <= bytes_.size() - offset);
  std::ranges::copy(bytes, bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
}

bool FakeStorage::begin_erase(std::size_t offset) {
  if (operation_ || offset >= bytes_.size() || offset % sector_size_bytes_ != 0) return false;
  begin(offset, std::vector<std::byte>(sector_size_bytes_, kErased));
  return true;
}

bool FakeStorage::begin_write(std::size_t offset, std::span<const std::byte> bytes) {
  if (operation_ || bytes.empty() || bytes.size() > kMaxWriteSize) return false;
  if (offset > bytes_.size() || bytes.size() > bytes_.size() - offset) return false;
  const auto old = contents().subspan(offset, bytes.size());
  const bool only_clears = std::ranges::equal(
      bytes, old, [](std::byte wanted, std::byte present) { return (wanted & ~present) == std::byte{0}; });
  if (!only_clears) return false;
  begin(offset, std::vector<std::byte>(bytes.begin(), bytes.end()));
  return true;
}

StorageState FakeStorage::state() const {
  if (operation_ && operation_->polls_left && (*operation_->polls_left)-- == 0) complete();
  if (operation_) return StorageState::kBusy;
  return failed_ ? StorageState::kFailed : StorageState::kIdle;
}

void FakeStorage::begin(std::size_t offset, std::vector<std::byte> result) {
  if (std::exchange(corrupt_next_, false)) result.back() ^= std::byte{1};
  for (std::size_t i = 0; i < result.size(); ++i) bytes_[offset + i] ^= kScramble;
  operation_ = Operation{offset, std::move(result), polls_, std::exchange(fail_next_, false)};
  failed_ = false;
}

void FakeStorage::complete() const {
  failed_ = operation_->fails;
  if (!failed_)
    std::ranges::copy(operation_->result, bytes_.begin() + static_cast<std::ptrdiff_t>(operation_->offset));
  operation_.reset();
}

}  // namespace koboshi::hal
