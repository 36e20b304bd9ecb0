#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

namespace koboshi::canopen {

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
  kDomain = 0x0F,  // any number of bytes; they stand behind a Domain of the node's owner
};

// 0 for a DOMAIN and for a number that is none of the types above.
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
    case DataType::kDomain:
      break;
  }
  return 0;
}

constexpr bool is_signed(DataType type) {
  return type >= DataType::kInteger8 && type <= DataType::kInteger32;
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

// Where a value lies in the struct of values of its node.
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
// stand in flash, sorted by address; the values stand in the RAM of the node's owner. Sub-index 0 of an array
// or record ("highest sub-index supported") has no row: it follows from the other rows.
struct Entry {
  static constexpr std::uint16_t kConstant = 0xFFFF;  // there is no value in RAM

  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t count = 1;
  std::uint16_t offset = 0;  // of the first value; kConstant: the value is `low`
  std::uint16_t stride_bytes = 0;
  DataType type = DataType::kUnsigned32;
  Access access = Access::kReadOnly;
  Mappable mappable = Mappable::kNo;
  bool limited : 1 = false;
  bool kept : 1 = false;  // is_parameter although a PDO may write it
  std::uint32_t low = 0;  // limits of what may be written, sign-extended for a signed type
  std::uint32_t high = 0;

  // The same row, refusing values outside [minimum, maximum] from SDO clients. A PDO cannot be refused: what
  // arrives in one, the owner limits.
  template <typename T>
  constexpr Entry within(T minimum, T maximum) const {
    Entry row = *this;
    row.limited = true;
    row.low = static_cast<std::uint32_t>(minimum);
    row.high = static_cast<std::uint32_t>(maximum);
    return row;
  }

  // The same row, of a parameter that an RPDO may write, too.
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

// Whether a row holds parameters: values that configure the node, which it may store (0x1010). What PDOs
// write besides are process values.
constexpr bool is_parameter(const Entry& row) {
  const bool by_rpdo = row.mappable == Mappable::kRpdo || row.mappable == Mappable::kBoth;
  return row.access == Access::kReadWrite && row.type != DataType::kDomain && (row.kept || !by_rpdo);
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

// A DOMAIN. NodeApplication::domain says where its bytes are.
constexpr Entry domain(std::uint16_t index, std::uint8_t subindex, Access access) {
  return {.index = index,
          .subindex = subindex,
          .offset = Entry::kConstant,
          .type = DataType::kDomain,
          .access = access};
}

}  // namespace koboshi::canopen
