#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace koboshi::storage {

// CRC-32 of IEEE 802.3 (reflected 0x04C11DB7, start and final inversion 0xFFFFFFFF) of bytes that may come in
// pieces: the result of one piece is the `previous` of the next. "123456789" gives 0xCBF43926.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t previous = 0);

// The header of every image in flash (robot model, motion, catalogue), little-endian: magic u32, version u16,
// reserved u16 (zero), size u32 of the whole image, CRC-32 u32 of all its bytes but these four. The sectors
// that hold an image may be longer than the image.
inline constexpr std::size_t kImageHeaderSize = 16;
inline constexpr std::size_t kImageVersionOffset = 4;
inline constexpr std::size_t kImageSizeOffset = 8;
inline constexpr std::size_t kImageCrcOffset = 12;

enum class [[nodiscard]] ImageStatus : std::uint8_t{
    kOk = 0,
    kTruncated = 1,   // fewer bytes than a header, or than the header's size
    kBadMagic = 2,    // another kind of image, or erased flash
    kBadVersion = 3,  // another version of the format
    kBadSize = 4,     // a size below the header's own, or a reserved field that is not zero
    kBadCrc = 5,
};

// The CRC-32 of an image over everything but its CRC field. `image` holds at least a header.
[[nodiscard]] std::uint32_t image_crc32(std::span<const std::byte> image);

struct Image {
  std::uint32_t crc32 = 0;          // also identifies the contents
  std::span<const std::byte> body;  // what follows the header
};

// Checks the header and the CRC of the image at the start of `bytes`. Sets `image` on kOk only.
ImageStatus open_image(std::span<const std::byte> bytes, std::uint32_t magic, std::uint16_t version,
                       Image& image);

// Returns whether the field is a name: at least one printable ASCII character, padded with zeros.
[[nodiscard]] bool is_image_name(std::span<const std::byte> field);
// Returns the name in the field, without its padding.
[[nodiscard]] std::string_view image_name(std::span<const std::byte> field);

// Reads consecutive little-endian fields. Past the end it returns zeros, and `ok` is false from then on.
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

// Writes consecutive little-endian fields into `bytes`, which must have room for all of them.
class FieldWriter {
 public:
  explicit constexpr FieldWriter(std::span<std::byte> bytes) : bytes_(bytes) {}

  constexpr void u8(std::uint8_t value) { put(value, 1); }
  constexpr void u16(std::uint16_t value) { put(value, 2); }
  constexpr void u32(std::uint32_t value) { put(value, 4); }

 private:
  constexpr void put(std::uint32_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes_[i] = static_cast<std::byte>(value >> (8 * i));
    bytes_ = bytes_.subspan(size);
  }

  std::span<std::byte> bytes_;
};

}  // namespace koboshi::storage
