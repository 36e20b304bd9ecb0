#include "simulation/assembly/storage_contents.h"

#include "firmware/storage/catalogue.h"
#include "firmware/storage/image.h"
#include "simulation/model/image_writer.h"

namespace koboshi::simulation {
namespace {

constexpr std::size_t kAlignment = 8;

struct Item {
  storage::ItemKind kind;
  std::uint16_t number;
  std::span<const std::byte> bytes;
};

std::size_t aligned(std::size_t offset) { return (offset + kAlignment - 1) / kAlignment * kAlignment; }

}  // namespace

std::vector<std::byte> make_storage_contents(std::span<const std::byte> model,
                                             std::span<const std::vector<std::byte>> motions,
                                             std::span<const std::byte> parameters,
                                             std::span<const std::byte> policy) {
  std::vector<Item> items{{storage::ItemKind::kRobotModel, 0, model}};
  for (std::size_t i = 0; i < motions.size(); ++i) {
    items.push_back({storage::ItemKind::kMotion, static_cast<std::uint16_t>(i), motions[i]});
  }
  if (!parameters.empty()) items.push_back({storage::ItemKind::kFactoryParameters, 0, parameters});
  if (!policy.empty()) items.push_back({storage::ItemKind::kPolicy, 0, policy});
  const std::size_t first = storage::kImageHeaderSize + 4 + items.size() * storage::kCatalogueItemSize;
  ImageWriter catalogue;
  catalogue.u16(static_cast<std::uint16_t>(items.size()));
  catalogue.u16(0);
  std::size_t offset = aligned(first);
  for (const Item& item : items) {
    catalogue.u16(static_cast<std::uint16_t>(item.kind));
    catalogue.u16(item.number);
    catalogue.u32(static_cast<std::uint32_t>(offset));
    catalogue.u32(static_cast<std::uint32_t>(item.bytes.size()));
    offset = aligned(offset + item.bytes.size());
  }
  std::vector<std::byte> contents = catalogue.finish(storage::kCatalogueMagic, storage::kCatalogueVersion);
  for (const Item& item : items) {
    contents.resize(aligned(contents.size()), std::byte{0xFF});
    contents.insert(contents.end(), item.bytes.begin(), item.bytes.end());
  }
  return contents;
}

}  // namespace koboshi::simulation
