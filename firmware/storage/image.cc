#include "firmware/storage/image.h"

#include <array>

namespace koboshi::storage {
namespace {

constexpr std::uint32_t kReflectedPolynomial = 0xEDB88320u;

// One entry for each nibble: 64 bytes of flash instead of 1024, for two look-ups a byte.
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

std::uint32_t image_crc32(std::span<const std::byte> image) {
  return crc32(image.subspan(kImageHeaderSize), crc32(image.first(kImageCrcOffset)));
}

ImageStatus open_image(std::span<const std::byte> bytes, std::uint32_t magic, std::uint16_t version,
                       Image& image) {
  ImageReader reader(bytes);
  const std::uint32_t found_magic = reader.u32();
  const std::uint16_t found_version = reader.u16();
  const std::uint16_t reserved = reader.u16();
  const std::uint32_t size = reader.u32();
  const std::uint32_t found_crc32 = reader.u32();
  if (!reader.ok()) return ImageStatus::kTruncated;
  if (found_magic != magic) return ImageStatus::kBadMagic;
  if (found_version != version) return ImageStatus::kBadVersion;
  if (reserved != 0 || size < kImageHeaderSize) return ImageStatus::kBadSize;
  if (size > bytes.size()) return ImageStatus::kTruncated;
  const std::span<const std::byte> whole = bytes.first(size);
  if (image_crc32(whole) != found_crc32) return ImageStatus::kBadCrc;
  image = {found_crc32, whole.subspan(kImageHeaderSize)};
  return ImageStatus::kOk;
}

bool is_image_name(std::span<const std::byte> field) {
  bool ended = false;
  for (const std::byte letter : field) {
    const bool printable = letter >= std::byte{' '} && letter <= std::byte{'~'};
    if (printable ? ended : letter != std::byte{0}) return false;
    ended = !printable;
  }
  return field[0] != std::byte{0};
}

std::string_view image_name(std::span<const std::byte> field) {
  std::size_t length = 0;
  while (length < field.size() && field[length] != std::byte{0}) ++length;
  return {reinterpret_cast<const char*>(field.data()), length};
}

}  // namespace koboshi::storage
