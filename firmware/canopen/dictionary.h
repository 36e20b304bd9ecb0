#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

// The object dictionary (CiA 301, 7.4): addresses, data types (table 44) and rows, which are in flash;
// values, which are in the RAM of the node's owner; and the abort codes (table 22) with which an access is
// refused.
namespace koboshi::canopen {

// Why an SDO transfer was refused or aborted (CiA 301, table 22). Two codes never reach the bus: kNone, no
// error; and kBusy, not done yet: call again a millisecond later.
enum class [[nodiscard]] AbortCode : std::uint32_t{
    kNone = 0,
    kBusy = 1,
    kToggleBitNotAlternated = 0x05030000,
    kTimedOut = 0x05040000,
    kCommandSpecifierUnknown = 0x05040001,
    kInvalidBlockSize = 0x05040002,
    kInvalidSequenceNumber = 0x05040003,
    kCrcError = 0x05040004,
    kOutOfMemory = 0x05040005,
    kUnsupportedAccess = 0x06010000,
    kReadOfWriteOnly = 0x06010001,
    kWriteOfReadOnly = 0x06010002,
    kObjectDoesNotExist = 0x06020000,
    kNotMappable = 0x06040041,
    kPdoLengthExceeded = 0x06040042,
    kParameterIncompatibility = 0x06040043,
    kInternalIncompatibility = 0x06040047,
    kHardwareError = 0x06060000,
    kLengthMismatch = 0x06070010,
    kLengthTooHigh = 0x06070012,
    kLengthTooLow = 0x06070013,
    kSubindexDoesNotExist = 0x06090011,
    kInvalidValue = 0x06090030,
    kValueTooHigh = 0x06090031,
    kValueTooLow = 0x06090032,
    kMaximumBelowMinimum = 0x06090036,
    kResourceNotAvailable = 0x060A0023,
    kGeneralError = 0x08000000,
    kCannotTransfer = 0x08000020,
    kLocalControl = 0x08000021,
    kDeviceState = 0x08000022,
    kNoDictionary = 0x08000023,
    kNoData = 0x08000024,
};

static_assert(std::endian::native == std::endian::little,
              "values are copied to the bus as they lie in memory");

struct ObjectAddress {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;

  friend constexpr auto operator<=>(const ObjectAddress&, const ObjectAddress&) = default;
};

// Static data types, with their index in the object dictionary (CiA 301, table 44).
enum class DataType : std::uint8_t {
  kBoolean = 0x01,
  kInteger8 = 0x02,
  kInteger16 = 0x03,
  kInteger32 = 0x04,
  kUnsigned8 = 0x05,
  kUnsigned16 = 0x06,
  kUnsigned32 = 0x07,
  kVisibleString = 0x09,  // only of computed objects
  kDomain = 0x0F,         // any number of bytes, behind a Domain of the node's owner
};

// The size of a value of the type; 0 for a text, a DOMAIN and for numbers that are not among the types above.
constexpr std::uint8_t size_bytes(DataType type) {
  switch (type) {
    case DataType::kBoolean:
    case DataType::kInteger8:
    case DataType::kUnsigned8:
      return 1;
    case DataType::kInteger16:
    case DataType::kUnsigned16:
      return 2;
    case DataType::kInteger32:
    case DataType::kUnsigned32:
      return 4;
    case DataType::kVisibleString:
    case DataType::kDomain:
      break;
  }
  return 0;
}

constexpr bool is_signed(DataType type) {
  return type >= DataType::kInteger8 && type <= DataType::kInteger32;
}

// Returns the number that the lowest bytes of `value` hold for this type.
constexpr std::int64_t integer_of(std::uint32_t value, DataType type) {
  if (!is_signed(type)) return value;
  const int unused_bits = 32 - 8 * size_bytes(type);
  return static_cast<std::int32_t>(value << unused_bits) >> unused_bits;
}

template <typename T>
consteval DataType data_type_of() {
  if constexpr (std::is_enum_v<T>) {
    return data_type_of<std::underlying_type_t<T>>();
  } else {
    static_assert(std::is_integral_v<T> && sizeof(T) <= 4, "the dictionary holds integers of up to 32 bits");
    if (std::is_same_v<T, bool>) return DataType::kBoolean;
    constexpr int kRank = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : 2;
    return static_cast<DataType>((std::is_signed_v<T> ? 2 : 5) + kRank);
  }
}

enum class Access : std::uint8_t { kReadOnly = 1, kWriteOnly = 2, kReadWrite = 3 };
enum class Mappable : std::uint8_t { kNo = 0, kTpdo = 1, kRpdo = 2, kBoth = 3 };

// The place of a value in its node's struct of values.
struct Field {
  DataType type;
  std::uint16_t offset;
};

// A member of a node's (standard-layout) struct of values; `member` may go into structs and arrays:
// `legs[1].load`.
#define KOBOSHI_FIELD(Struct, member)                                                                    \
  ::koboshi::canopen::Field {                                                                            \
    ::koboshi::canopen::data_type_of<std::remove_cvref_t<decltype((std::declval<Struct&>().member))>>(), \
        static_cast<std::uint16_t>(offsetof(Struct, member))                                             \
  }

// One row of an object dictionary: `count` consecutive sub-indices with values `stride_bytes` apart. Rows
// are in flash, sorted by address; the values are in the RAM of the node's owner. Sub-index 0 of an array
// or record ("highest sub-index supported") has no row: it follows from the other rows.
struct Entry {
  // Offsets of values that are not in RAM.
  static constexpr std::uint16_t kConstant = 0xFFFF;
  static constexpr std::uint16_t kComputed = 0xFFFE;

  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t count = 1;
  std::uint16_t offset = 0;  // of the first value in bytes; kConstant: the value is `low`; kComputed
  std::uint16_t stride_bytes = 0;
  DataType type = DataType::kUnsigned32;
  Access access = Access::kReadOnly;
  Mappable mappable = Mappable::kNo;
  bool limited : 1 = false;
  bool listed : 1 = false;  // limited to the values low + i for which bit i of `high` is set
  bool kept : 1 = false;    // is_parameter although a PDO may write it
  std::uint32_t low = 0;    // limits of what may be written, sign-extended for a signed type
  std::uint32_t high = 0;

  constexpr bool is_in_ram() const { return offset < kComputed; }

  // Whether some values of the type may not be written.
  constexpr bool restricts() const { return limited || listed || type == DataType::kBoolean; }

  // The same row, which refuses values outside [minimum, maximum], whichever service writes them.
  template <typename T>
  constexpr Entry within(T minimum, T maximum) const {
    Entry row = *this;
    row.limited = true;
    row.low = static_cast<std::uint32_t>(minimum);
    row.high = static_cast<std::uint32_t>(maximum);
    return row;
  }

  // The same row, as a parameter (is_parameter) although an RPDO may write it.
  constexpr Entry parameter() const {
    Entry row = *this;
    row.kept = true;
    return row;
  }

  // The same row for `elements` consecutive sub-indices.
  constexpr Entry repeated(std::size_t elements, std::size_t stride) const {
    Entry row = *this;
    row.count = static_cast<std::uint8_t>(elements);
    row.stride_bytes = static_cast<std::uint16_t>(stride);
    return row;
  }
};

constexpr Entry object(std::uint16_t index, std::uint8_t subindex, Field field, Access access,
                       Mappable mappable = Mappable::kNo) {
  return {.index = index,
          .subindex = subindex,
          .offset = field.offset,
          .type = field.type,
          .access = access,
          .mappable = mappable};
}

// Whether a row holds parameters: values that configure the node and that it may store (0x1010). Values that
// an RPDO may write are process values.
constexpr bool is_parameter(const Entry& row) {
  const bool by_rpdo = row.mappable == Mappable::kRpdo || row.mappable == Mappable::kBoth;
  return row.access == Access::kReadWrite && row.is_in_ram() && (row.kept || !by_rpdo);
}

// A value that never changes and costs no RAM.
template <typename T>
constexpr Entry constant(std::uint16_t index, std::uint8_t subindex, T value) {
  return {.index = index,
          .subindex = subindex,
          .offset = Entry::kConstant,
          .type = data_type_of<T>(),
          .low = static_cast<std::uint32_t>(value)};
}

// An object whose value NodeApplication::on_read computes, and whose writes only on_write receives.
constexpr Entry computed(std::uint16_t index, std::uint8_t subindex, DataType type, Access access) {
  return {.index = index, .subindex = subindex, .offset = Entry::kComputed, .type = type, .access = access};
}

// A DOMAIN, whose bytes NodeApplication::domain gives access to.
constexpr Entry domain(std::uint16_t index, std::uint8_t subindex, Access access) {
  return {.index = index,
          .subindex = subindex,
          .offset = Entry::kConstant,
          .type = DataType::kDomain,
          .access = access};
}

// The value of an object as it is read: a number of up to 4 bytes, or a text in flash, or a copy of a short
// one.
class ObjectValue {
 public:
  static constexpr std::size_t kMaxCopySize = 24;

  // Sets a number of 1, 2 or 4 bytes. Drops the bytes of `number` beyond `size`.
  void set_number(std::uint32_t number, std::uint8_t size) {
    number_ = size < 4 ? number & ((1u << (8 * size)) - 1) : number;
    kind_ = Kind::kNumber;
    size_ = size;
  }
  void set_text(std::string_view text) {
    text_ = text.data();
    kind_ = Kind::kText;
    size_ = static_cast<std::uint16_t>(text.size());
  }
  // Sets a text of up to kMaxCopySize characters that may change later.
  void copy_text(std::string_view text) {
    size_ = static_cast<std::uint16_t>(text.copy(copy_.data(), copy_.size()));
    kind_ = Kind::kCopy;
  }

  // Not sign-extended; 0 for a text.
  std::uint32_t number() const { return is_text() ? 0 : number_; }
  std::uint16_t size() const { return size_; }
  bool is_text() const { return kind_ != Kind::kNumber; }
  // Little-endian, as SDO carries them. Valid as long as this object.
  std::span<const std::uint8_t> bytes() const {
    const void* const starts[] = {&number_, text_, copy_.data()};
    return {static_cast<const std::uint8_t*>(starts[static_cast<std::size_t>(kind_)]), size_};
  }

 private:
  enum class Kind : std::uint8_t { kNumber, kText, kCopy };

  std::uint32_t number_ = 0;
  const char* text_ = nullptr;
  std::array<char, kMaxCopySize> copy_{};
  std::uint16_t size_ = 0;
  Kind kind_ = Kind::kNumber;
};

// Compares the `size` in bytes that a client sends (0: not indicated) with that of the object, `expected`.
constexpr AbortCode check_size(std::size_t size, std::size_t expected) {
  if (size == 0 || size == expected) return AbortCode::kNone;
  return size > expected ? AbortCode::kLengthTooHigh : AbortCode::kLengthTooLow;
}

// The row found for an address, and the offset of the value in bytes (or Entry::kConstant).
struct Location {
  const Entry* entry = nullptr;
  std::uint16_t offset = 0;
};

// An object dictionary: rows in flash, joined to values in RAM. A copy is another view of the same values.
class Dictionary {
 public:
  // `rows` and the size of `values` must satisfy is_valid_table; both must outlive the dictionary.
  constexpr Dictionary(std::span<const Entry> rows, std::span<std::byte> values)
      : rows_(rows), values_(values) {}

  // kObjectDoesNotExist or kSubindexDoesNotExist when there is no such row. O(log n).
  AbortCode find(ObjectAddress address, Location& location) const;

  // Judges a value for an object, whichever service brings it: an SDO client, an RPDO, or storage.
  // Sign-extends it if the object is signed, and drops bytes beyond the object's size. kValueTooHigh,
  // kValueTooLow or kInvalidValue if it must not be stored.
  static AbortCode check_value(const Entry& row, std::uint32_t& value);

  // Reads a value. kUnsupportedAccess for a DOMAIN, here and below, and for a computed object, which is not
  // here.
  AbortCode read(ObjectAddress address, ObjectValue& value) const;
  // Checks whether `value`, of `size` bytes (0: that of the object), may be written, and sign-extends it if
  // the object is signed. Stores nothing.
  AbortCode check_write(ObjectAddress address, std::uint32_t& value, std::size_t size,
                        Location& location) const;
  // Stores what check_write has accepted. No effect on a computed object.
  void store(const Location& location, std::uint32_t value);

  // The bytes of a value, for PDOs. `offset` comes from a Location of this dictionary.
  std::byte* value_at(std::uint16_t offset) { return values_.data() + offset; }
  const std::byte* value_at(std::uint16_t offset) const { return values_.data() + offset; }

 private:
  // Reads the highest sub-index of an index that has rows, but none for sub-index 0.
  AbortCode highest_subindex(std::uint16_t index, ObjectValue& value) const;

  std::span<const Entry> rows_;
  std::span<std::byte> values_;
};

// Whether the rows ascend without overlap, and each value lies within `values_size_bytes`. Every table
// asserts it.
constexpr bool is_valid_table(std::span<const Entry> rows, std::size_t values_size_bytes) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Entry& row = rows[i];
    if (row.count == 0 || row.subindex + row.count > 255) return false;
    if (row.is_in_ram() &&
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
