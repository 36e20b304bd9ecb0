#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace koboshi::canopen {

// CRC-32 of IEEE 802.3 (reflected 0x04C11DB7, start and final inversion 0xFFFFFFFF) of bytes that may come in
// pieces: the result of one piece is the `previous` of the next. "123456789" gives 0xCBF43926.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t previous = 0);

}  // namespace koboshi::canopen
