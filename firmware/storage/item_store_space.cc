#include "firmware/storage/item_store.h"

#include <algorithm>
#include <utility>

#include "firmware/storage/item_store_record.h"

namespace koboshi::storage {

ItemStore::Space ItemStore::space() const {
  Space space{.free = size_, .oldest = size_, .oldest_key = kNoKey};
  const auto add = [&](std::uint16_t place, std::size_t key) {
    if (place == kNone) return;
    const std::size_t start = offset_of(place);
    const std::size_t size = record_size_at(start);
    const std::size_t free = start >= head_ ? start - head_ : start + size_ - head_;
    if (key != kNoKey) space.largest = std::max(space.largest, size);
    space.last_end = std::max(space.last_end, start + size);
    if (free > space.free) return;
    space.free = free;
    space.oldest = start;
    space.oldest_key = key;
  };
  for (const std::uint16_t place : pins_) add(place, kNoKey);
  for (std::size_t key = 0; key < kKeys; ++key) add(index_[key], key);
  return space;
}

bool ItemStore::fits(std::size_t size, std::size_t largest) const {
  return live_bytes_ + size + 2 * (std::max(largest, size) + sector_size_) <= size_;
}

// Whether a record may be written at the head, so that the reserve is left. What will remain unused at the
// end of the ring is not counted twice while the log contains it.
bool ItemStore::has_room(std::size_t size, const Space& space) const {
  const std::size_t largest = std::max(space.largest, size);
  const bool wraps = space.oldest == size_ || space.oldest < head_;
  const std::size_t unused = wraps ? 0 : std::min(largest, size_ - space.last_end);
  return space.free >= size + 2 * (largest + sector_size_) - unused;
}

std::size_t ItemStore::free_bytes() const {
  const std::size_t used = live_bytes_ + kHeaderSize + 2 * (space().largest + sector_size_);
  return size_ - std::min(size_, used);
}

bool ItemStore::sector_is_free(std::size_t sector) const {
  const auto is_there = [&](std::uint16_t place) { return overlaps(place, sector); };
  return std::ranges::none_of(index_, is_there) && std::ranges::none_of(pins_, is_there);
}

std::size_t ItemStore::sector_after(std::size_t offset) const {
  return (offset + sector_size_ - 1) / sector_size_ * sector_size_;
}

void ItemStore::set_head(std::size_t offset) {
  head_ = offset;
  if (head_ == size_) head_ = erased_ = 0;
}

void ItemStore::replace(std::size_t key, std::uint16_t place) {
  if (index_[key] != kNone) live_bytes_ -= record_size_at(offset_of(index_[key]));
  index_[key] = place;
  if (place != kNone) live_bytes_ += record_size_at(offset_of(place));
}

// Prepares the place of a new record at the head: kOk once it is erased. `spare`: bytes that must remain
// besides.
Status ItemStore::prepare(std::size_t size, std::size_t spare) {
  if (operating_ || state_ == State::kSealing || state_ == State::kErasing) return Status::kBusy;
  if (std::exchange(failed_, false)) return Status::kFailed;
  if (state_ == State::kCopying) return stalled_ ? Status::kInUse : Status::kBusy;
  const Space now = space();
  if (!fits(size + spare, now.largest)) return Status::kFull;
  if (!has_room(size, now)) return start_copy(now);
  if (size > size_ - head_) set_head(size_);
  if (erased_ >= head_ + size) return Status::kOk;
  return erase_next() ? Status::kBusy : Status::kInUse;
}

// --- Compaction

// Compacts until an item as large as the largest has room.
void ItemStore::tidy() {
  const Space now = space();
  const bool is_due =
      now.largest != 0 && fits(now.largest + kHeaderSize, now.largest) && !has_room(now.largest, now);
  tidies_ = is_due && start_copy(now) == Status::kBusy;
}

Status ItemStore::start_copy(const Space& space) {
  const std::uint16_t oldest = place_of(space.oldest);
  if (space.oldest_key == kNoKey || std::ranges::find(pins_, oldest) != pins_.end()) return Status::kInUse;
  const std::size_t size = record_size_at(space.oldest);
  if (size > size_ - head_) set_head(size_);
  // Only failures of the flash use up the reserve.
  if (space.oldest >= head_ && space.oldest - head_ < size) return Status::kFailed;
  key_ = space.oldest_key;
  source_ = space.oldest;
  record_ = head_;
  done_ = 0;
  announced_ = size;
  ++sequence_;
  stalled_ = false;
  state_ = State::kCopying;
  return Status::kBusy;
}

// Erases a sector when the copy comes to it, and not before: see the reserve.
void ItemStore::advance_copy() {
  if (done_ == announced_) {
    replace(key_, place_of(record_));
    set_head(record_ + announced_);
    state_ = State::kIdle;
    tidies_ = true;
    return;
  }
  const std::size_t position = record_ + done_;
  if (position == erased_) {
    stalled_ = !erase_next();
    return;
  }
  const std::size_t size = std::min({page_.size(), announced_ - done_, erased_ - position});
  std::ranges::copy(bytes_at(source_ + done_, size), page_.begin());
  if (done_ < kHeaderSize) {
    const auto header = copied_header();
    std::copy_n(header.begin() + static_cast<std::ptrdiff_t>(done_), std::min(size, kHeaderSize - done_),
                page_.begin());
  }
  done_ += size;
  write(position, std::span(page_).first(size));
}

std::array<std::byte, ItemStore::kHeaderSize> ItemStore::copied_header() const {
  Header header;
  static_cast<void>(read(source_, header));
  header.sequence = sequence_;
  return header.encode();
}

}  // namespace koboshi::storage
