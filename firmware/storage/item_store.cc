#include "firmware/storage/item_store.h"

#include <algorithm>
#include <utility>

#include "firmware/storage/image.h"

namespace koboshi::storage {
namespace {

constexpr std::size_t kCheckOffset = ItemStore::kHeaderSize - 4;
constexpr std::uint16_t kErasedItem = 0xFFFF;  // a header's size
static_assert(ItemStore::kMaxItemSize_bytes < kErasedItem);

constexpr std::size_t padded(std::size_t size) {
  constexpr std::size_t kUnit = hal::StoragePort::kWriteUnit_bytes;
  return (size + kUnit - 1) / kUnit * kUnit;
}

constexpr std::size_t record_size(std::size_t item_size) {
  return ItemStore::kHeaderSize + (item_size == kErasedItem ? 0 : padded(item_size));
}

}  // namespace

// --- Records

struct ItemStore::Header {
  std::uint8_t kind = 0;
  std::uint8_t number = 0;
  std::uint16_t size = 0;
  std::uint32_t sequence = 0;
  std::uint32_t crc = 0;

  std::array<std::byte, kHeaderSize> encode() const {
    std::array<std::byte, kHeaderSize> bytes;
    FieldWriter writer(bytes);
    writer.u8(kind);
    writer.u8(number);
    writer.u16(size);
    writer.u32(sequence);
    writer.u32(crc);
    writer.u32(crc32(std::span(bytes).first(kCheckOffset)));
    return bytes;
  }
};

std::size_t ItemStore::key_of(std::uint16_t kind, std::uint16_t number) {
  switch (static_cast<ItemKind>(kind)) {
    case ItemKind::kMotion:
      return number < kMaxMotions ? number : kNoKey;
    case ItemKind::kParameters:
      return number == 0 ? kMaxMotions : kNoKey;
    case ItemKind::kNodeId:
      return number == 0 ? kMaxMotions + 1 : kNoKey;
    case ItemKind::kRobotModel:
    case ItemKind::kFactoryParameters:
      break;
  }
  return kNoKey;
}

// Reads the header at `offset`. False if there is none, or if its record would extend beyond the log.
bool ItemStore::read(std::size_t offset, Header& header) const {
  if (offset + kHeaderSize > size_) return false;
  const auto bytes = bytes_at(offset, kHeaderSize);
  ImageReader reader(bytes);
  header.kind = reader.u8();
  header.number = reader.u8();
  if (key_of(header.kind, header.number) == kNoKey) return false;
  header.size = reader.u16();
  header.sequence = reader.u32();
  header.crc = reader.u32();
  if (header.size > kMaxItemSize_bytes && header.size != kErasedItem) return false;
  if (record_size(header.size) > size_ - offset) return false;
  return crc32(bytes.first(kCheckOffset)) == reader.u32();
}

std::uint16_t ItemStore::size_field_at(std::size_t offset) const {
  ImageReader reader(bytes_at(offset + 2, 2));
  return reader.u16();
}

std::uint32_t ItemStore::sequence_at(std::uint16_t place) const {
  ImageReader reader(bytes_at(offset_of(place) + 4, 4));
  return reader.u32();
}

std::size_t ItemStore::record_size_at(std::size_t offset) const { return record_size(size_field_at(offset)); }

bool ItemStore::overlaps(std::uint16_t place, std::size_t sector) const {
  if (place == kNone) return false;
  const std::size_t start = offset_of(place);
  return start < sector + sector_size_ && sector < start + record_size_at(start);
}

// Whether two records of an item are equal, so that one may be a copy of the other.
bool ItemStore::are_equal(std::uint16_t place, std::uint16_t other) const {
  Header header;
  Header others;
  return place != kNone && other != kNone && read(offset_of(place), header) &&
         read(offset_of(other), others) && header.size == others.size && header.crc == others.crc &&
         header.size != kErasedItem;
}

std::span<const std::byte> ItemStore::find(ItemKind kind, std::uint16_t number) const {
  const std::size_t key = key_of(static_cast<std::uint16_t>(kind), number);
  if (key == kNoKey || index_[key] == kNone) return {};
  const std::size_t start = offset_of(index_[key]);
  return bytes_at(start + kHeaderSize, size_field_at(start));
}

void ItemStore::pin(Holder holder, std::span<const std::byte> item) {
  unpin(holder);
  const auto log = bytes_at(0, size_);
  if (item.data() < log.data() || item.data() >= log.data() + log.size()) return;
  const auto offset = static_cast<std::size_t>(item.data() - log.data());
  pins_[static_cast<std::size_t>(holder)] = place_of(offset - kHeaderSize);
}

void ItemStore::unpin(Holder holder) {
  std::uint16_t& pinned = pins_[static_cast<std::size_t>(holder)];
  if (pinned == kNone) return;
  pinned = kNone;
  stalled_ = false;
  tidies_ = true;
}

// --- Recovery

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

// --- Space

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
  const bool is_motion = key_ < kMaxMotions;
  const ItemKind kind = is_motion             ? ItemKind::kMotion
                        : key_ == kMaxMotions ? ItemKind::kParameters
                                              : ItemKind::kNodeId;
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
