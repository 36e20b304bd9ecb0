#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

// CRC of an SDO block transfer (CiA 301, 7.2.4.3.16): x^16 + x^12 + x^5 + 1, start value 0, nothing
// reflected; of "123456789" it is 0x31C3. `crc`: that of the bytes before.
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

// The bytes of SDO messages (CiA 301, 7.2.4.3): a command byte, followed in most of them by the object's
// address and four bytes of data.
namespace koboshi::canopen::sdo {

using Data = std::array<std::uint8_t, 8>;

// Command bytes without their variable bits; the specifier is in bits 5..7.
inline constexpr std::uint8_t kSpecifierMask = 0xE0;
inline constexpr std::uint8_t kDownloadSegmentRequest = 0x00;
inline constexpr std::uint8_t kInitiateDownloadRequest = 0x20;
inline constexpr std::uint8_t kInitiateUploadRequest = 0x40;
inline constexpr std::uint8_t kUploadSegmentRequest = 0x60;
inline constexpr std::uint8_t kUploadSegmentResponse = 0x00;
inline constexpr std::uint8_t kDownloadSegmentResponse = 0x20;
inline constexpr std::uint8_t kInitiateUploadResponse = 0x40;
inline constexpr std::uint8_t kInitiateDownloadResponse = 0x60;
inline constexpr std::uint8_t kAbort = 0x80;
inline constexpr std::uint8_t kBlockDownloadRequest = 0xC0;
inline constexpr std::uint8_t kBlockDownloadResponse = 0xA0;
inline constexpr std::uint8_t kBlockUploadRequest = 0xA0;
inline constexpr std::uint8_t kBlockUploadResponse = 0xC0;

// Variable bits of an initiate message.
inline constexpr std::uint8_t kExpedited = 0x02;
inline constexpr std::uint8_t kSizeIndicated = 0x01;
// Variable bits of a segment; bits 1..3 count its unused bytes.
inline constexpr std::uint8_t kToggle = 0x10;
inline constexpr std::uint8_t kLastSegment = 0x01;
inline constexpr std::size_t kSegmentBytes = 7;

// Variable bits of block transfers (CiA 301, 7.2.4.3.9 to 7.2.4.3.15). The sub-command is in bits 0 and
// 1, in requests of a download in bit 0 alone; of an end message, bits 2..4 count the unused bytes of the
// last segment.
inline constexpr std::uint8_t kBlockSubcommandMask = 0x03;
inline constexpr std::uint8_t kBlockInitiate = 0x00;
inline constexpr std::uint8_t kBlockEnd = 0x01;
inline constexpr std::uint8_t kBlockConfirm = 0x02;
inline constexpr std::uint8_t kBlockStartUpload = 0x03;
inline constexpr std::uint8_t kBlockSizeIndicated = 0x02;
inline constexpr std::uint8_t kBlockCrc = 0x04;  // the sender can generate and check the CRC
// A segment of a block has a sequence number, from 1 on, instead of a command.
inline constexpr std::uint8_t kBlockLastSegment = 0x80;
inline constexpr std::uint8_t kMaxBlockSize = 127;

constexpr bool is_block_size(std::uint8_t segments) { return segments >= 1 && segments <= kMaxBlockSize; }
constexpr std::size_t block_end_size(std::uint8_t command) { return kSegmentBytes - ((command >> 2) & 7u); }

// `size` in 1..4.
constexpr std::uint8_t expedited(std::uint8_t command, std::size_t size) {
  return static_cast<std::uint8_t>(command | ((4 - size) << 2) | kExpedited | kSizeIndicated);
}
constexpr bool is_expedited(std::uint8_t command, std::uint8_t initiate) {
  return (command & (kSpecifierMask | kExpedited)) == (initiate | kExpedited);
}
// 4 when the sender has not indicated the size.
constexpr std::size_t expedited_size(std::uint8_t command) {
  return (command & kSizeIndicated) != 0 ? 4u - ((command >> 2) & 3u) : 4u;
}
constexpr std::size_t segment_size(std::uint8_t command) { return kSegmentBytes - ((command >> 1) & 7u); }

constexpr ObjectAddress address_of(const Data& data) { return {load_u16(&data[1]), data[3]}; }
constexpr std::uint32_t data_of(const Data& data) { return load_u32(&data[4]); }

constexpr Data message(std::uint8_t command, ObjectAddress address, std::uint32_t value) {
  Data data{};
  data[0] = command;
  store_u16(&data[1], address.index);
  data[3] = address.subindex;
  store_u32(&data[4], value);
  return data;
}

}  // namespace koboshi::canopen::sdo
