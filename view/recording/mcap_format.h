#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace koboshi::view {

// The container MCAP, version 0: https://mcap.dev/spec. All integers are little-endian; times are in
// nanoseconds.

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

enum class McapRecord : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

// Opcode and length in front of each record.
inline constexpr std::size_t kMcapRecordHead_bytes = 1 + 8;

inline constexpr std::uint64_t kNanosecondsPerMicrosecond = 1000;

// Appends fields of records to a string.
class McapFields {
 public:
  explicit McapFields(std::string& out) : out_(out) {}

  template <typename Unsigned>
  McapFields& number(Unsigned value) {
    static_assert(std::endian::native == std::endian::little);
    const auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    out_.append(bytes.data(), bytes.size());
    return *this;
  }
  McapFields& text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    out_ += text;
    return *this;
  }
  // A map from strings to strings, or any object of keys and values.
  template <typename Map>
  McapFields& map(const Map& map) {
    std::string entries;
    McapFields fields(entries);
    for (const auto& [key, value] : map) fields.value(key).value(value);
    return text(entries);
  }
  template <typename Value>
  McapFields& value(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value>) {
      return number(value);
    } else {
      return text(value);
    }
  }

 private:
  std::string& out_;
};

}  // namespace koboshi::view
