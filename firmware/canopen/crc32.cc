#include "firmware/canopen/crc32.h"

#include <array>

namespace koboshi::canopen {
namespace {

constexpr std::uint32_t kReflectedPolynomial = 0xEDB88320u;

// A table by nibbles: 64 bytes of flash instead of 1024, at two look-ups a byte.
constexpr std::array<std::uint32_t, 16> make_nibble_table() {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t nibble = 0; nibble < table.size(); ++nibble) {
    std::uint32_t remainder = nibble;
    for (int bit = 0; bit < 4; ++bit) {
      remainder = (remainder >> 1) ^ ((remainder & 1u) != 0 ? kReflectedPolynomial : 0u);
    }
    table[nibble] = remainder;
  }
  return table;
}

constexpr std::array<std::uint32_t, 16> kNibbleTable = make_nibble_table();

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t previous) {
  std::uint32_t crc = ~previous;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    crc = (crc >> 4) ^ kNibbleTable[crc & 0xFu];
    crc = (crc >> 4) ^ kNibbleTable[crc & 0xFu];
  }
  return ~crc;
}

}  // namespace koboshi::canopen
