#include "firmware/storage/item_store.h"

#include <algorithm>

#include "firmware/fixed/contract.h"
#include "firmware/storage/image.h"

namespace koboshi::storage {
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

ItemStore::ItemStore(hal::StoragePort& storage, const Layout& layout)
    : storage_(storage),
      layout_(layout),
      first_(storage.contents().size() - std::min(storage.contents().size(), layout.size_bytes())) {
  KOBOSHI_ASSERT(layout.slots <= kMaxSlots && layout.slot_size_bytes > kTrailerSize);
  const std::size_t sector_size_bytes = storage.sector_size_bytes();
  KOBOSHI_ASSERT(layout.slot_size_bytes % sector_size_bytes == 0 && first_ % sector_size_bytes == 0);
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
  const auto stored = bytes.last(kTrailerSize);
  ImageReader reader(stored);
  if (reader.u32() != kTrailerMagic) return false;
  trailer.kind = static_cast<ItemKind>(reader.u16());
  trailer.number = reader.u16();
  trailer.sequence = reader.u32();
  trailer.size = reader.u32();
  static_cast<void>(reader.u32());  // reserved
  if (trailer.size > layout_.max_item_size_bytes()) return false;
  if (occupied(number)) return true;  // checked before, and not written since
  const std::uint32_t crc = crc32(bytes.first(trailer.size));
  return crc32(stored.first(kCrcOffset), crc) == reader.u32();
}

std::span<const std::byte> ItemStore::find(ItemKind kind, std::uint16_t number) const {
  for (std::size_t i = 0; i < layout_.slots; ++i) {
    Trailer trailer;
    if (!occupied(i) || !read(i, trailer)) continue;
    if (trailer.kind == kind && trailer.number == number) return slot(i).first(trailer.size);
  }
  return {};
}

Status ItemStore::begin(ItemKind kind, std::uint16_t number) {
  if (begun_) return Status::kInUse;  // only its writer ends an item that is complete or has failed
  switch (state_) {
    case State::kFailed:
      state_ = State::kIdle;
      return Status::kFailed;
    case State::kErased:
      break;
    case State::kIdle:
    case State::kSealed:
      if (operating_) return Status::kBusy;  // the last operation of an item that was released
      if (!choose_slot()) return Status::kFull;
      state_ = State::kErasing;
      done_ = 0;
      erase_next();
      return Status::kBusy;
    case State::kErasing:
    case State::kOpen:
    case State::kSealing:
      return Status::kBusy;
  }
  begun_ = true;
  state_ = State::kOpen;
  kind_ = kind;
  number_ = number;
  crc_ = 0;
  done_ = 0;
  size_ = 0;
  page_fill_ = 0;
  return Status::kOk;
}

// Takes the free slots in turn, so that all wear alike and one that failed is not taken again at once.
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

Status ItemStore::append(std::span<const std::byte> bytes) {
  KOBOSHI_ASSERT(begun_ && bytes.size() <= kMaxAppendSize);
  if (state_ != State::kOpen) return Status::kFailed;
  if (size_ + bytes.size() > layout_.max_item_size_bytes()) return Status::kTooLong;
  if (page_fill_ + bytes.size() > page_.size()) return Status::kBusy;
  std::ranges::copy(bytes, page_.begin() + static_cast<std::ptrdiff_t>(page_fill_));
  page_fill_ += bytes.size();
  size_ += bytes.size();
  crc_ = crc32(bytes, crc_);
  return Status::kOk;
}

Status ItemStore::flush() {
  KOBOSHI_ASSERT(begun_);
  if (state_ == State::kFailed) return Status::kFailed;
  if (operating_) return Status::kBusy;
  if (page_fill_ == 0) return Status::kOk;
  while (page_fill_ % kWriteUnit != 0) page_[page_fill_++] = std::byte{0xFF};
  write_page(page_fill_);
  return Status::kBusy;
}

Status ItemStore::commit() {
  KOBOSHI_ASSERT(begun_);
  if (state_ == State::kSealed) return Status::kOk;
  const Status flushed = flush();
  if (flushed != Status::kOk) return flushed;
  write_trailer();
  return Status::kBusy;
}

void ItemStore::release() {
  if (!begun_) return;
  begun_ = false;
  if (state_ == State::kSealing) return;  // all bytes have come: the item is completed
  state_ = State::kIdle;
}

void ItemStore::advance() {
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
  if (state_ == State::kOpen && !operating_ && page_fill_ >= kWriteUnit)
    write_page(page_fill_ - page_fill_ % kWriteUnit);
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
            page_.begin() + static_cast<std::ptrdiff_t>(page_fill_), page_.begin());
  page_fill_ -= size;
}

void ItemStore::write_trailer() {
  std::array<std::byte, kTrailerSize> trailer;
  FieldWriter writer(trailer);
  writer.u32(kTrailerMagic);
  writer.u16(static_cast<std::uint16_t>(kind_));
  writer.u16(number_);
  writer.u32(sequence_ + 1);
  writer.u32(static_cast<std::uint32_t>(size_));
  writer.u32(~std::uint32_t{0});
  writer.u32(crc32(std::span(trailer).first(kCrcOffset), crc_));
  state_ = State::kSealing;
  write(layout_.slot_size_bytes - kTrailerSize, trailer);
}

}  // namespace koboshi::storage
