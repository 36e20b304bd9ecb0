#include "firmware/storage/item_store.h"

#include <algorithm>
#include <utility>

#include "firmware/storage/item_store_record.h"

namespace koboshi::storage {

ItemStore::ItemStore(hal::StoragePort& storage, std::size_t size_bytes)
    : storage_(storage),
      sector_size_(storage.sector_size_bytes()),
      size_(storage.contents().size() < size_bytes ? 0 : size_bytes),
      first_(storage.contents().size() - size_) {
  KOBOSHI_ASSERT(size_bytes % sector_size_ == 0 && first_ % sector_size_ == 0);
  KOBOSHI_ASSERT(sector_size_ % kWriteUnit == 0 && size_bytes / kWriteUnit < kNone);
  index_.fill(kNone);
  pins_.fill(kNone);
  recover();
}

// Finds the two newest whole records of each item, in one pass. After a whole record the search continues
// behind it: what an item contains is never taken for a header.
void ItemStore::scan(Index& older) {
  Header header;
  std::size_t offset = 0;
  while (offset < size_) {
    const std::size_t start = offset;
    offset += kWriteUnit;
    if (!read(start, header)) continue;
    const std::size_t size = header.size == kErasedItem ? 0 : header.size;
    if (crc32(bytes_at(start + kHeaderSize, size)) != header.crc) continue;
    offset = start + record_size(header.size);
    const std::size_t key = key_of(header.kind, header.number);
    std::uint16_t place = place_of(start);
    for (std::uint16_t* const known : {&index_[key], &older[key]}) {
      if (place != kNone && (*known == kNone || sequence_at(*known) < sequence_at(place)))
        std::swap(*known, place);
    }
  }
}

std::uint16_t ItemStore::newest() const {
  std::uint16_t newest = kNone;
  for (const std::uint16_t place : index_) {
    if (place != kNone && (newest == kNone || sequence_at(place) > sequence_at(newest))) newest = place;
  }
  return newest;
}

// The words behind the last record may have been written although they read as erased, so that its sector is
// not continued after a restart: the head moves on to the next one. If the sector contains copies only, their
// sources count again instead, and the head starts with this sector again.
void ItemStore::recover() {
  Index older;
  older.fill(kNone);
  scan(older);
  const std::uint16_t last = newest();
  if (last == kNone) return;
  std::size_t end = offset_of(last) + record_size_at(offset_of(last));
  std::size_t head = sector_after(end);
  const std::size_t sector = sector_after(end) - sector_size_;
  if (contains_copies_only(sector, older)) {
    end = head = sector;
    for (std::size_t key = 0; key < kKeys; ++key) {
      if (!overlaps(index_[key], sector)) continue;
      end = std::min(end, offset_of(index_[key]));
      index_[key] = older[key];
    }
  }
  if (newest() != kNone) sequence_ = sequence_at(newest());
  for (std::uint16_t& place : index_) {
    if (place == kNone) continue;
    if (size_field_at(offset_of(place)) == kErasedItem) {
      place = kNone;
    } else {
      live_bytes_ += record_size_at(offset_of(place));
    }
  }
  set_head(head);
  erased_ = head_;
  if (end < head) resume_copy(end, head);
}

bool ItemStore::contains_copies_only(std::size_t sector, const Index& older) const {
  for (std::size_t key = 0; key < kKeys; ++key) {
    if (!overlaps(index_[key], sector)) continue;
    if (!are_equal(index_[key], older[key]) || overlaps(older[key], sector)) return false;
  }
  return true;
}

// Continues the copy whose first bytes are between `start` and `end`, where the head's sector begins.
void ItemStore::resume_copy(std::size_t start, std::size_t end) {
  const Space now = space();
  if (now.oldest_key == kNoKey) return;
  const std::size_t size = record_size_at(now.oldest);
  if (size <= end - start || size > size_ - start) return;
  key_ = now.oldest_key;
  source_ = now.oldest;
  ++sequence_;
  const auto header = copied_header();
  const std::size_t in_header = std::min(end - start, kHeaderSize);
  const bool is_same = std::ranges::equal(bytes_at(start, in_header), std::span(header).first(in_header)) &&
                       std::ranges::equal(bytes_at(start + in_header, end - start - in_header),
                                          bytes_at(source_ + in_header, end - start - in_header));
  if (!is_same) {
    --sequence_;
    return;
  }
  head_ = record_ = start;
  done_ = end - start;
  announced_ = size;
  state_ = State::kCopying;
}

}  // namespace koboshi::storage
