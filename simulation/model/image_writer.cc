#include "simulation/model/image_writer.h"

#include "firmware/storage/image.h"

namespace koboshi::simulation {

std::vector<std::byte> ImageWriter::finish(std::uint32_t magic, std::uint16_t version) const {
  const auto size = static_cast<std::uint32_t>(storage::kImageHeaderSize + body_.size());
  const auto with_crc = [&](std::uint32_t crc) {
    ImageWriter image;
    image.u32(magic);
    image.u16(version);
    image.u16(0);
    image.u32(size);
    image.u32(crc);
    image.body_.insert(image.body_.end(), body_.begin(), body_.end());
    return image.body_;
  };
  return with_crc(storage::image_crc32(with_crc(0)));
}

}  // namespace koboshi::simulation
