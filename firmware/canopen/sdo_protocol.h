#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/canopen/frame.h"
#include "firmware/canopen/object.h"

// The bytes of SDO messages (CiA 301, 7.2.4.3): a command byte, then for most the object's address and four
// bytes of data.
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

// Variable bits of an initiate message.
inline constexpr std::uint8_t kExpedited = 0x02;
inline constexpr std::uint8_t kSizeIndicated = 0x01;
// Variable bits of a segment; bits 1..3 count its unused bytes.
inline constexpr std::uint8_t kToggle = 0x10;
inline constexpr std::uint8_t kLastSegment = 0x01;
inline constexpr std::size_t kSegmentBytes = 7;

// `size` in 1..4.
constexpr std::uint8_t expedited(std::uint8_t command, std::size_t size) {
  return static_cast<std::uint8_t>(command | ((4 - size) << 2) | kExpedited | kSizeIndicated);
}
constexpr bool is_expedited(std::uint8_t command, std::uint8_t initiate) {
  return (command & (kSpecifierMask | kExpedited)) == (initiate | kExpedited);
}
// 4 when the sender has not told the size.
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
