#include "firmware/storage/item_store.h"

#include <algorithm>
#include <array>

#include "firmware/storage/item_store_record.h"

namespace koboshi::storage {

// --- Writing an item

Status ItemStore::begin(ItemKind kind, std::uint16_t number, std::size_t size_bytes) {
  const std::size_t key = key_of(static_cast<std::uint16_t>(kind), number);
  KOBOSHI_ASSERT(key != kNoKey);
  if (begun_) return Status::kInUse;
  if (size_bytes > kMaxItemSize_bytes) return Status::kTooLong;
  const Status prepared = prepare(record_size(size_bytes), kHeaderSize);
  if (prepared != Status::kOk) return prepared;
  begun_ = true;
  state_ = State::kOpen;
  key_ = key;
  record_ = head_;
  done_ = 0;
  announced_ = size_bytes;
  appended_ = 0;
  page_fill_ = 0;
  crc_ = 0;
  read_crc_ = 0;
  return Status::kOk;
}

Status ItemStore::append(std::span<const std::byte> bytes) {
  KOBOSHI_ASSERT(begun_ && bytes.size() <= kMaxAppendSize);
  if (state_ != State::kOpen) return Status::kFailed;
  if (bytes.size() > announced_ - appended_) return Status::kTooLong;
  if (page_fill_ + bytes.size() > page_.size()) return Status::kBusy;
  std::ranges::copy(bytes, page_.begin() + static_cast<std::ptrdiff_t>(page_fill_));
  page_fill_ += bytes.size();
  appended_ += bytes.size();
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
  state_ = State::kSealing;
  write_header(static_cast<std::uint16_t>(appended_));
  return Status::kBusy;
}

void ItemStore::release() {
  if (!begun_) return;
  begun_ = false;
  if (state_ == State::kSealing) return;  // all bytes have come: the item is completed
  if (state_ == State::kOpen && done_ != 0) set_head(record_ + kHeaderSize + done_);
  state_ = State::kIdle;
  tidies_ = true;
}

Status ItemStore::erase(ItemKind kind, std::uint16_t number) {
  const std::size_t key = key_of(static_cast<std::uint16_t>(kind), number);
  KOBOSHI_ASSERT(key != kNoKey);
  if (index_[key] == kNone) return Status::kOk;
  if (begun_) return Status::kInUse;
  const Status prepared = prepare(kHeaderSize, 0);
  if (prepared != Status::kOk) return prepared;
  key_ = key;
  record_ = head_;
  done_ = 0;
  appended_ = 0;
  crc_ = 0;
  read_crc_ = 0;
  state_ = State::kErasing;
  write_header(kErasedItem);
  return Status::kBusy;
}

// --- Operations of the flash

void ItemStore::advance() {
  if (operating_) {
    const hal::StorageState now = storage_.state();
    if (now == hal::StorageState::kBusy) return;
    operating_ = false;
    if (now == hal::StorageState::kFailed) return on_failed();
    on_done();
  }
  if (state_ == State::kOpen) {
    if (page_fill_ >= kWriteUnit) write_page(page_fill_ - page_fill_ % kWriteUnit);
  } else if (state_ == State::kCopying) {
    advance_copy();
  } else if (state_ == State::kIdle && tidies_) {
    tidy();
  }
}

// Erases the next sector behind what is erased. False if something must remain there.
bool ItemStore::erase_next() {
  if (!sector_is_free(erased_)) return false;
  operation_ = erased_;
  operation_end_ = erased_ + sector_size_;
  erases_ = true;
  operating_ = storage_.begin_erase(first_ + operation_);
  if (!operating_) on_failed();
  return true;
}

void ItemStore::write(std::size_t offset, std::span<const std::byte> bytes) {
  operation_ = offset;
  operation_end_ = offset + bytes.size();
  erases_ = false;
  operating_ = storage_.begin_write(first_ + offset, bytes);
  if (!operating_) on_failed();
}

void ItemStore::write_page(std::size_t size) {
  const std::size_t offset = record_ + kHeaderSize + done_;
  done_ += size;
  write(offset, std::span(page_).first(size));
  std::copy(page_.begin() + static_cast<std::ptrdiff_t>(size),
            page_.begin() + static_cast<std::ptrdiff_t>(page_fill_), page_.begin());
  page_fill_ -= size;
}

void ItemStore::write_header(std::uint16_t size) {
  constexpr std::array kOthers{ItemKind::kParameters, ItemKind::kNodeId, ItemKind::kPolicy};  // by key
  static_assert(kMaxMotions + kOthers.size() == kKeys);
  const bool is_motion = key_ < kMaxMotions;
  const ItemKind kind = is_motion ? ItemKind::kMotion : kOthers[key_ - kMaxMotions];
  const Header header{.kind = static_cast<std::uint8_t>(kind),
                      .number = static_cast<std::uint8_t>(is_motion ? key_ : 0),
                      .size = size,
                      .sequence = ++sequence_,
                      .crc = crc_};
  write(record_, header.encode());
}

void ItemStore::on_done() {
  const auto range = bytes_at(operation_, operation_end_ - operation_);
  if (erases_) {
    erased_ = operation_end_;
  } else if (state_ == State::kCopying) {
    if (!std::ranges::equal(range, std::span(page_).first(range.size()))) on_failed();
  } else if (state_ == State::kOpen) {
    const std::size_t end = std::min(operation_end_, record_ + kHeaderSize + appended_);
    read_crc_ = crc32(range.first(end - operation_), read_crc_);
  } else if (state_ == State::kSealing || state_ == State::kErasing) {
    on_header_written();
  }
}

void ItemStore::on_header_written() {
  Header header;
  if (!read(record_, header) || header.sequence != sequence_ || header.crc != read_crc_) return on_failed();
  const bool erased = state_ == State::kErasing;
  replace(key_, erased ? kNone : place_of(record_));
  marks_[key_ / 32] &= ~(1u << key_ % 32);
  set_head(record_ + record_size_at(record_));
  state_ = begun_ ? State::kSealed : State::kIdle;
  tidies_ = true;
}

// The rest of the sector is not used in this rotation.
void ItemStore::on_failed() {
  set_head(sector_after(operation_end_));
  erased_ = head_;
  if (!begun_) failed_ = true;
  tidies_ = false;
  state_ = begun_ ? State::kFailed : State::kIdle;
}

}  // namespace koboshi::storage
