#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/crc32.h"

namespace koboshi::robot {

// What every image in flash begins with, little-endian: magic u32, version u16, reserved u16 (zero), size u32
// of the whole image, CRC-32 u32 of all its bytes but these four. Images lie in sectors that are longer than
// they are.
inline constexpr std::size_t kImageHeaderSize = 16;
inline constexpr std::size_t kImageCrcOffset = 12;

enum class [[nodiscard]] ImageStatus : std::uint8_t{
    kOk = 0,
    kTruncated = 1,   // fewer bytes than a header, or than the header's size
    kBadMagic = 2,    // another kind of image, or erased flash
    kBadVersion = 3,  // another version of the format
    kBadSize = 4,     // a size below the header's own, or something in the reserved field
    kBadCrc = 5,
};

using canopen::crc32;

// The CRC-32 of an image over everything but its CRC field. `image` holds at least a header.
[[nodiscard]] std::uint32_t image_crc32(std::span<const std::byte> image);

struct Image {
  std::uint32_t crc32 = 0;          // also tells one content from another
  std::span<const std::byte> body;  // what follows the header
};

// Checks the header and the CRC of the image at the start of `bytes`. `image` is set on kOk only.
ImageStatus open_image(std::span<const std::byte> bytes, std::uint32_t magic, std::uint16_t version,
                       Image& image);

// Reads little-endian fields one after the other. Past the end it gives zeros and `ok` turns false for good.
class ImageReader {
 public:
  explicit constexpr ImageReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  constexpr std::uint8_t u8() { return static_cast<std::uint8_t>(take(1)); }
  constexpr std::int8_t i8() { return static_cast<std::int8_t>(u8()); }
  constexpr std::uint16_t u16() { return static_cast<std::uint16_t>(take(2)); }
  constexpr std::uint32_t u32() { return take(4); }
  constexpr std::int32_t i32() { return static_cast<std::int32_t>(u32()); }

  [[nodiscard]] constexpr bool ok() const { return ok_; }
  [[nodiscard]] constexpr std::size_t remaining() const { return bytes_.size(); }

 private:
  constexpr std::uint32_t take(std::size_t size) {
    if (bytes_.size() < size) {
      ok_ = false;
      bytes_ = {};
      return 0;
    }
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::to_integer<std::uint32_t>(bytes_[i]) << (8 * i);
    bytes_ = bytes_.subspan(size);
    return value;
  }

  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

}  // namespace koboshi::robot
