#include "firmware/app/item_store.h"

#include <algorithm>

#include "firmware/canopen/frame.h"

namespace koboshi::app {

using canopen::AbortCode;

namespace {

constexpr std::uint32_t kTrailerMagic = 0x4D54494Bu;  // "KITM"
constexpr std::size_t kCrcOffset = ItemStore::kTrailerSize - 4;

}  // namespace

struct ItemStore::Trailer {
  ItemKind kind{};
  std::uint16_t number = 0;
  std::uint32_t sequence = 0;
  std::size_t size = 0;
};

ItemStore::ItemStore(hal::StoragePort& storage)
    : storage_(storage), first_(storage.contents().size() - std::min(storage.contents().size(), kSize)) {
  if (storage_.contents().size() < kSize) return;
  for (std::size_t i = 0; i < kSlots; ++i) {
    Trailer trailer;
    if (read(i, trailer)) take(i, trailer);
  }
}

// The newest of two versions stays; the other's slot is free.
void ItemStore::take(std::size_t number, const Trailer& trailer) {
  for (std::size_t i = 0; i < kSlots; ++i) {
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
  return storage_.contents().subspan(slot_offset(number), kSlotSize);
}

bool ItemStore::read(std::size_t number, Trailer& trailer) const {
  const auto bytes = slot(number);
  robot::ImageReader reader(bytes.last(kTrailerSize));
  if (reader.u32() != kTrailerMagic) return false;
  trailer.kind = static_cast<ItemKind>(reader.u16());
  trailer.number = reader.u16();
  trailer.sequence = reader.u32();
  trailer.size = reader.u32();
  static_cast<void>(reader.u32());
  if (trailer.size > kMaxItemSize) return false;
  if (occupied(number)) return true;  // checked before, and not written since
  const std::uint32_t crc = robot::crc32(bytes.first(trailer.size));
  return robot::crc32(bytes.last(kTrailerSize).first(kCrcOffset), crc) == reader.u32();
}

std::span<const std::byte> ItemStore::find(ItemKind kind, std::uint16_t number) const {
  for (std::size_t i = 0; i < kSlots; ++i) {
    Trailer trailer;
    if (!occupied(i) || !read(i, trailer)) continue;
    if (trailer.kind == kind && trailer.number == number) return slot(i).first(trailer.size);
  }
  return {};
}

AbortCode ItemStore::begin(ItemKind kind, std::uint16_t number) {
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
  if (storage_.contents().size() < kSize) return false;
  for (std::size_t i = 0; i < kSlots; ++i) {
    slot_ = (slot_ + 1) % kSlots;
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
  if (size_ + bytes.size() > kMaxItemSize) return AbortCode::kLengthTooHigh;
  if (fill_ + bytes.size() > page_.size()) return AbortCode::kBusy;
  std::ranges::copy(bytes, page_.begin() + static_cast<std::ptrdiff_t>(fill_));
  fill_ += bytes.size();
  size_ += bytes.size();
  crc_ = robot::crc32(bytes, crc_);
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
    if (done_ < kSlotSize) {
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
  canopen::store_u32(&trailer[0], kTrailerMagic);
  canopen::store_u16(&trailer[4], static_cast<std::uint16_t>(kind_));
  canopen::store_u16(&trailer[6], number_);
  canopen::store_u32(&trailer[8], sequence_ + 1);
  canopen::store_u32(&trailer[12], static_cast<std::uint32_t>(size_));
  canopen::store_u32(&trailer[16], ~std::uint32_t{0});
  const auto bytes = std::as_bytes(std::span(trailer));
  canopen::store_u32(&trailer[kCrcOffset], robot::crc32(bytes.first(kCrcOffset), crc_));
  state_ = State::kSealing;
  write(kSlotSize - kTrailerSize, bytes);
}

}  // namespace koboshi::app
