#include "firmware/canopen/dictionary.h"

#include <algorithm>
#include <cstring>

namespace koboshi::canopen {
namespace {

// The first row that does not lie wholly below the address.
std::span<const Entry>::iterator first_candidate(std::span<const Entry> rows, ObjectAddress address) {
  return std::partition_point(rows.begin(), rows.end(), [address](const Entry& row) {
    return row.index < address.index ||
           (row.index == address.index && row.subindex + row.count <= address.subindex);
  });
}

// The value in 32 bits: sign-extended if the type is signed, else without the bytes beyond the type's size.
std::uint32_t widened(std::uint32_t value, DataType type) {
  const unsigned spare_bits = 32u - 8u * size_bytes(type);
  if (!is_signed(type)) return (value << spare_bits) >> spare_bits;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(value << spare_bits) >> spare_bits);
}

AbortCode check_limits(const Entry& row, std::uint32_t value) {
  if (row.type == DataType::kBoolean && value > 1) return AbortCode::kValueTooHigh;
  if (row.listed) {
    const std::uint32_t bit = value - row.low;
    return bit < 32 && (row.high >> bit & 1u) != 0 ? AbortCode::kNone : AbortCode::kInvalidValue;
  }
  if (!row.limited) return AbortCode::kNone;
  // With the sign bit flipped, signed numbers compare as unsigned ones.
  const std::uint32_t bias = is_signed(row.type) ? 0x8000'0000u : 0;
  if ((value ^ bias) > (row.high ^ bias)) return AbortCode::kValueTooHigh;
  if ((value ^ bias) < (row.low ^ bias)) return AbortCode::kValueTooLow;
  return AbortCode::kNone;
}

}  // namespace

AbortCode Dictionary::check_value(const Entry& row, std::uint32_t& value) {
  value = widened(value, row.type);
  return check_limits(row, value);
}

AbortCode Dictionary::find(ObjectAddress address, Location& location) const {
  const auto row = first_candidate(rows_, address);
  if (row != rows_.end() && row->index == address.index && row->subindex <= address.subindex) {
    const unsigned element = address.subindex - static_cast<unsigned>(row->subindex);
    location.entry = &*row;
    location.offset = row->is_in_ram() ? static_cast<std::uint16_t>(row->offset + element * row->stride_bytes)
                                       : row->offset;
    return AbortCode::kNone;
  }
  const bool index_exists = (row != rows_.end() && row->index == address.index) ||
                            (row != rows_.begin() && std::prev(row)->index == address.index);
  return index_exists ? AbortCode::kSubindexDoesNotExist : AbortCode::kObjectDoesNotExist;
}

AbortCode Dictionary::highest_subindex(std::uint16_t index, ObjectValue& value) const {
  const auto next = first_candidate(rows_, {static_cast<std::uint16_t>(index + 1), 0});
  const Entry& last = *std::prev(next);
  value.set_number(static_cast<std::uint32_t>(last.subindex + last.count - 1), 1);
  return AbortCode::kNone;
}

AbortCode Dictionary::read(ObjectAddress address, ObjectValue& value) const {
  Location location;
  const AbortCode found = find(address, location);
  if (found == AbortCode::kSubindexDoesNotExist && address.subindex == 0) {
    return highest_subindex(address.index, value);
  }
  if (found != AbortCode::kNone) return found;
  const Entry& row = *location.entry;
  if (row.access == Access::kWriteOnly) return AbortCode::kReadOfWriteOnly;
  if (row.type == DataType::kDomain || row.offset == Entry::kComputed) return AbortCode::kUnsupportedAccess;
  std::uint32_t number = row.low;
  if (location.offset != Entry::kConstant) {
    number = 0;
    std::memcpy(&number, value_at(location.offset), size_bytes(row.type));
  }
  value.set_number(number, size_bytes(row.type));
  return AbortCode::kNone;
}

AbortCode Dictionary::check_write(ObjectAddress address, std::uint32_t& value, std::size_t size,
                                  Location& location) const {
  const AbortCode found = find(address, location);
  if (found == AbortCode::kSubindexDoesNotExist && address.subindex == 0) return AbortCode::kWriteOfReadOnly;
  if (found != AbortCode::kNone) return found;
  const Entry& row = *location.entry;
  if (row.access == Access::kReadOnly) return AbortCode::kWriteOfReadOnly;
  if (row.type == DataType::kDomain) return AbortCode::kUnsupportedAccess;
  const AbortCode sized = check_size(size, size_bytes(row.type));
  if (sized != AbortCode::kNone) return sized;
  return check_value(row, value);
}

void Dictionary::store(const Location& location, std::uint32_t value) {
  if (!location.entry->is_in_ram()) return;
  std::memcpy(value_at(location.offset), &value, size_bytes(location.entry->type));
}

}  // namespace koboshi::canopen
