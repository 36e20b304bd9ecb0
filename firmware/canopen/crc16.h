#pragma once

#include <cstdint>
#include <span>

namespace koboshi::canopen {

// CRC of an SDO block transfer (CiA 301, 7.2.4.3.16): x^16 + x^12 + x^5 + 1, start value 0, nothing
// reflected; of "123456789" it is 0x31C3. Goes on from `crc`.
constexpr std::uint16_t crc16(std::uint16_t crc, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ (byte << 8));
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 0x8000) != 0 ? (crc << 1) ^ 0x1021 : crc << 1);
    }
  }
  return crc;
}

}  // namespace koboshi::canopen
