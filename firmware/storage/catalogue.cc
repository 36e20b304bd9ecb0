#include "firmware/storage/catalogue.h"

#include "firmware/storage/image.h"

namespace koboshi::storage {

Catalogue::Catalogue(std::span<const std::byte> storage) : storage_(storage) {
  Image image;
  if (open_image(storage, kCatalogueMagic, kCatalogueVersion, image) != ImageStatus::kOk) return;
  ImageReader reader(image.body);
  const std::size_t count = reader.u16();
  static_cast<void>(reader.u16());
  if (!reader.ok() || reader.remaining() != count * kCatalogueItemSize) return;
  items_ = image.body.last(reader.remaining());
}

std::span<const std::byte> Catalogue::find(ItemKind kind, std::uint16_t number) const {
  for (std::size_t start = 0; start < items_.size(); start += kCatalogueItemSize) {
    ImageReader item(items_.subspan(start, kCatalogueItemSize));
    if (item.u16() != static_cast<std::uint16_t>(kind) || item.u16() != number) continue;
    const std::size_t offset = item.u32();
    const std::size_t size = item.u32();
    if (offset > storage_.size() || size > storage_.size() - offset) return {};
    return storage_.subspan(offset, size);
  }
  return {};
}

}  // namespace koboshi::storage
