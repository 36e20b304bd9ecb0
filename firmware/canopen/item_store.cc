#include "firmware/canopen/item_store.h"

#include <algorithm>

#include "firmware/canopen/crc32.h"
#include "firmware/canopen/frame.h"
#include "firmware/fixed/contract.h"

namespace koboshi::canopen {
namespace {

constexpr std::uint32_t kTrailerMagic = 0x4D54494Bu;  // "KITM"
constexpr std::size_t kCrcOffset = ItemStore::kTrailerSize - 4;

}  // namespace

struct ItemStore::Trailer {
  std::uint16_t kind = 0;
  std::uint16_t number = 0;
  std::uint32_t sequence = 0;
  std::size_t size = 0;
};

ItemStore::ItemStore(hal::StoragePort& storage, const Layout& layout)
    : storage_(storage),
      layout_(layout),
      first_(storage.contents().size() - std::min(storage.contents().size(), layout.size_bytes())) {
  KOBOSHI_ASSERT(layout.slots <= kMaxSlots && layout.slot_size_bytes > kTrailerSize);
  if (storage_.contents().size() < layout_.size_bytes()) return;
  for (std::size_t i = 0; i < layout_.slots; ++i) {
    Trailer trailer;
    if (read(i, trailer)) take(i, trailer);
  }
}

// The newest of two versions stays; the other's slot is free.
void ItemStore::take(std::size_t number, const Trailer& trailer) {
  for (std::size_t i = 0; i < layout_.slots; ++i) {
    Trailer other;
    if (i == number || !occupied(i) || !read(i, other)) continue;
    if (other.kind != trailer.kind || other.number != trailer.number) continue;
    if (other.sequence > trailer.sequence) return;
    occupied_ &= ~(std::uint64_t{1} << i);
  }
  occupied_ |= std::uint64_t{1} << number;
  if (trailer.sequence < sequence_) return;
  sequence_ = trailer.sequence;
  slot_ = number;
}

std::span<const std::byte> ItemStore::slot(std::size_t number) const {
  return storage_.contents().subspan(slot_offset(number), layout_.slot_size_bytes);
}

bool ItemStore::read(std::size_t number, Trailer& trailer) const {
  const auto bytes = slot(number);
  std::array<std::uint8_t, kTrailerSize> stored;
  std::ranges::transform(bytes.last(kTrailerSize), stored.begin(), std::to_integer<std::uint8_t>);
  if (load_u32(&stored[0]) != kTrailerMagic) return false;
  trailer.kind = load_u16(&stored[4]);
  trailer.number = load_u16(&stored[6]);
  trailer.sequence = load_u32(&stored[8]);
  trailer.size = load_u32(&stored[12]);
  if (trailer.size > max_item_size()) return false;
  if (occupied(number)) return true;  // checked before, and not written since
  const std::uint32_t crc = crc32(bytes.first(trailer.size));
  return crc32(bytes.last(kTrailerSize).first(kCrcOffset), crc) == load_u32(&stored[kCrcOffset]);
}

std::span<const std::byte> ItemStore::find(std::uint16_t kind, std::uint16_t number) const {
  for (std::size_t i = 0; i < layout_.slots; ++i) {
    Trailer trailer;
    if (!occupied(i) || !read(i, trailer)) continue;
    if (trailer.kind == kind && trailer.number == number) return slot(i).first(trailer.size);
  }
  return {};
}

AbortCode ItemStore::begin(std::uint16_t kind, std::uint16_t number) {
  switch (state_) {
    case State::kOpen:
      return AbortCode::kDeviceState;
    case State::kFailed:
      state_ = State::kIdle;
      return AbortCode::kHardwareError;
    case State::kErased:
      break;
    case State::kIdle:
    case State::kSealed:
      if (operating_) return AbortCode::kBusy;  // the end of what was released
      if (!choose_slot()) return AbortCode::kOutOfMemory;
      state_ = State::kErasing;
      done_ = 0;
      erase_next();
      return AbortCode::kBusy;
    case State::kErasing:
    case State::kSealing:
      return AbortCode::kBusy;
  }
  state_ = State::kOpen;
  kind_ = kind;
  number_ = number;
  crc_ = 0;
  done_ = 0;
  size_ = 0;
  fill_ = 0;
  return AbortCode::kNone;
}

// Round and round, so that all slots wear alike, also those of flash that has failed.
bool ItemStore::choose_slot() {
  if (storage_.contents().size() < layout_.size_bytes()) return false;
  for (std::size_t i = 0; i < layout_.slots; ++i) {
    slot_ = (slot_ + 1) % layout_.slots;
    if (!occupied(slot_)) return true;
  }
  return false;
}

void ItemStore::erase_next() {
  operating_ = storage_.begin_erase(slot_offset(slot_) + done_);
  if (!operating_) state_ = State::kFailed;
  done_ += storage_.sector_size_bytes();
}

AbortCode ItemStore::append(std::span<const std::byte> bytes) {
  if (state_ != State::kOpen) return AbortCode::kHardwareError;
  if (size_ + bytes.size() > max_item_size()) return AbortCode::kLengthTooHigh;
  if (fill_ + bytes.size() > page_.size()) return AbortCode::kBusy;
  std::ranges::copy(bytes, page_.begin() + static_cast<std::ptrdiff_t>(fill_));
  fill_ += bytes.size();
  size_ += bytes.size();
  crc_ = crc32(bytes, crc_);
  return AbortCode::kNone;
}

AbortCode ItemStore::flush() {
  if (state_ == State::kFailed) return AbortCode::kHardwareError;
  if (operating_) return AbortCode::kBusy;
  if (fill_ == 0) return AbortCode::kNone;
  while (fill_ % kWriteUnit != 0) page_[fill_++] = std::byte{0xFF};
  write_page(fill_);
  return AbortCode::kBusy;
}

AbortCode ItemStore::commit() {
  if (state_ == State::kSealed) return AbortCode::kNone;
  const AbortCode flushed = flush();
  if (flushed != AbortCode::kNone) return flushed;
  write_trailer();
  return AbortCode::kBusy;
}

void ItemStore::release() {
  if (state_ == State::kSealing) return;  // what has come so far is seen through
  state_ = State::kIdle;
}

void ItemStore::go_on() {
  if (operating_) {
    const hal::StorageState now = storage_.state();
    if (now == hal::StorageState::kBusy) return;
    operating_ = false;
    if (now == hal::StorageState::kFailed) {
      state_ = State::kFailed;
      return;
    }
    on_done();
  }
  if (state_ == State::kOpen && !operating_ && fill_ >= kWriteUnit) write_page(fill_ - fill_ % kWriteUnit);
}

void ItemStore::on_done() {
  if (state_ == State::kErasing) {
    if (done_ < layout_.slot_size_bytes) {
      erase_next();
    } else {
      state_ = State::kErased;
    }
  }
  if (state_ != State::kSealing) return;
  Trailer trailer;
  const bool valid = read(slot_, trailer);
  if (valid) take(slot_, trailer);
  state_ = valid ? State::kSealed : State::kFailed;
}

void ItemStore::write(std::size_t offset, std::span<const std::byte> bytes) {
  operating_ = storage_.begin_write(slot_offset(slot_) + offset, bytes);
  if (!operating_) state_ = State::kFailed;
}

void ItemStore::write_page(std::size_t size) {
  write(done_, std::span(page_).first(size));
  done_ += size;
  std::copy(page_.begin() + static_cast<std::ptrdiff_t>(size),
            page_.begin() + static_cast<std::ptrdiff_t>(fill_), page_.begin());
  fill_ -= size;
}

void ItemStore::write_trailer() {
  std::array<std::uint8_t, kTrailerSize> trailer;
  store_u32(&trailer[0], kTrailerMagic);
  store_u16(&trailer[4], kind_);
  store_u16(&trailer[6], number_);
  store_u32(&trailer[8], sequence_ + 1);
  store_u32(&trailer[12], static_cast<std::uint32_t>(size_));
  store_u32(&trailer[16], ~std::uint32_t{0});
  const auto bytes = std::as_bytes(std::span(trailer));
  store_u32(&trailer[kCrcOffset], crc32(bytes.first(kCrcOffset), crc_));
  state_ = State::kSealing;
  write(layout_.slot_size_bytes - kTrailerSize, bytes);
}

}  // namespace koboshi::canopen
