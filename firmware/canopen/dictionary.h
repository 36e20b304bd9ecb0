#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/canopen/abort_code.h"
#include "firmware/canopen/object.h"

namespace koboshi::canopen {

// What reading an object gives: up to 4 bytes of a number, or a text that stands in flash.
class ObjectValue {
 public:
  void set_number(std::uint32_t number, std::uint8_t size) {
    number_ = size < 4 ? number & ((1u << (8 * size)) - 1) : number;
    text_ = {};
    size_ = size;
  }
  void set_text(std::string_view text) {
    text_ = text;
    size_ = static_cast<std::uint16_t>(text.size());
  }

  // Little-endian, as SDO and PDO carry it; not sign-extended. 0 for a text.
  std::uint32_t number() const { return number_; }
  std::uint16_t size() const { return size_; }
  bool is_text() const { return text_.data() != nullptr; }
  // Valid as long as this object.
  std::span<const std::uint8_t> bytes() const {
    const void* start = is_text() ? text_.data() : static_cast<const void*>(&number_);
    return {static_cast<const std::uint8_t*>(start), size_};
  }

 private:
  std::uint32_t number_ = 0;
  std::string_view text_;
  std::uint16_t size_ = 0;
};

// Whether a client that sends `size` bytes (0: it has not told) means an object of `expected` bytes.
constexpr AbortCode check_size(std::size_t size, std::size_t expected) {
  if (size == 0 || size == expected) return AbortCode::kNone;
  return size > expected ? AbortCode::kLengthTooHigh : AbortCode::kLengthTooLow;
}

// An entry found for an address, and the offset of its value (or Entry::kConstant).
struct Location {
  const Entry* entry = nullptr;
  std::uint16_t offset = 0;
};

// Rows in flash joined to values in RAM. Copies are cheap and mean the same dictionary.
class Dictionary {
 public:
  // `rows` must satisfy is_sorted and fit `values`; both must outlive the dictionary.
  constexpr Dictionary(std::span<const Entry> rows, std::span<std::byte> values)
      : rows_(rows), values_(values) {}

  // kObjectDoesNotExist or kSubindexDoesNotExist when there is no such row. O(log n).
  AbortCode find(ObjectAddress address, Location& location) const;

  // kUnsupportedAccess for a DOMAIN, here and below: it is no value.
  AbortCode read(ObjectAddress address, ObjectValue& value) const;
  // Whether `value`, of `size` bytes (0: as many as the object has), may be written; sign-extends it if the
  // object is signed. Nothing is stored yet.
  AbortCode check_write(ObjectAddress address, std::uint32_t& value, std::size_t size,
                        Location& location) const;
  // Stores what check_write has accepted.
  void store(const Location& location, std::uint32_t value);

  // A value's bytes, for PDOs. `offset` and `size` come from a Location of this dictionary.
  std::byte* value_at(std::uint16_t offset) { return values_.data() + offset; }
  const std::byte* value_at(std::uint16_t offset) const { return values_.data() + offset; }

 private:
  // Highest sub-index of an index that has rows but none for sub-index 0.
  AbortCode highest_subindex(std::uint16_t index, ObjectValue& value) const;

  std::span<const Entry> rows_;
  std::span<std::byte> values_;
};

// Rows ascend and do not overlap, and each value lies within `values_size_bytes`: to be asserted of every
// table.
constexpr bool is_valid_table(std::span<const Entry> rows, std::size_t values_size_bytes) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Entry& row = rows[i];
    if (row.count == 0 || row.subindex + row.count > 255) return false;
    if (row.offset != Entry::kConstant &&
        row.offset + (row.count - 1u) * row.stride_bytes + size_bytes(row.type) > values_size_bytes) {
      return false;
    }
    if (i == 0) continue;
    const Entry& last = rows[i - 1];
    const bool ascends =
        last.index < row.index || (last.index == row.index && last.subindex + last.count <= row.subindex);
    if (!ascends) return false;
  }
  return true;
}

}  // namespace koboshi::canopen
