#include "firmware/robot/image.h"

namespace koboshi::robot {
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

}  // namespace koboshi::robot
