#include "firmware/storage/item_store.h"
#include "firmware/storage/item_store_record.h"

namespace koboshi::storage {

std::size_t ItemStore::key_of(std::uint16_t kind, std::uint16_t number) {
  switch (static_cast<ItemKind>(kind)) {
    case ItemKind::kMotion:
      return number < kMaxMotions ? number : kNoKey;
    case ItemKind::kParameters:
      return number == 0 ? kMaxMotions : kNoKey;
    case ItemKind::kNodeId:
      return number == 0 ? kMaxMotions + 1 : kNoKey;
    case ItemKind::kPolicy:
      return number == 0 ? kMaxMotions + 2 : kNoKey;
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
  return crc32(bytes.first(Header::kCheckOffset)) == reader.u32();
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

void ItemStore::mark(ItemKind kind, std::uint16_t number) {
  const std::size_t key = key_of(static_cast<std::uint16_t>(kind), number);
  if (key != kNoKey && index_[key] != kNone) marks_[key / 32] |= 1u << key % 32;
}

bool ItemStore::marked(ItemKind kind, std::uint16_t number) const {
  const std::size_t key = key_of(static_cast<std::uint16_t>(kind), number);
  return key != kNoKey && (marks_[key / 32] >> key % 32 & 1u) != 0;
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

}  // namespace koboshi::storage
