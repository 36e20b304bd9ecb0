#include "firmware/storage/catalogue.h"

#include <gtest/gtest.h>

#include "firmware/storage/image.h"
#include "tests/support/robot_storage.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::storage {
namespace {

const std::vector<std::byte> kModel(10, std::byte{1});
const std::vector<std::vector<std::byte>> kMotions{std::vector<std::byte>(5, std::byte{2}),
                                                   std::vector<std::byte>(7, std::byte{3})};

constexpr std::size_t kFirstItem = kImageHeaderSize + 4;
constexpr std::size_t kOffsetField = 4;
constexpr std::size_t kSizeField = 8;

// Returns the storage with one field of the catalogue changed and the CRC updated.
std::vector<std::byte> with_field(std::size_t item, std::size_t field, std::uint32_t value) {
  std::vector<std::byte> storage = test::make_storage(kModel, kMotions);
  std::vector<std::byte> catalogue(storage.begin(), storage.begin() + kFirstItem + 3 * kCatalogueItemSize);
  std::vector<std::byte> bytes;
  test::put(bytes, value, 4);
  std::ranges::copy(
      bytes, catalogue.begin() + static_cast<std::ptrdiff_t>(kFirstItem + item * kCatalogueItemSize + field));
  test::seal(catalogue);
  std::ranges::copy(catalogue, storage.begin());
  return storage;
}

TEST(Catalogue, FindsItemsByKindAndNumber) {
  const auto storage = test::make_storage(kModel, kMotions);
  const Catalogue catalogue(storage);
  EXPECT_TRUE(std::ranges::equal(catalogue.find(ItemKind::kRobotModel, 0), kModel));
  EXPECT_TRUE(std::ranges::equal(catalogue.find(ItemKind::kMotion, 0), kMotions[0]));
  EXPECT_TRUE(std::ranges::equal(catalogue.find(ItemKind::kMotion, 1), kMotions[1]));
  EXPECT_TRUE(catalogue.find(ItemKind::kMotion, 2).empty());
  EXPECT_TRUE(catalogue.find(ItemKind::kRobotModel, 1).empty());
}

TEST(Catalogue, IsEmptyInErasedOrDamagedStorage) {
  EXPECT_TRUE(
      Catalogue(std::vector<std::byte>(1024, std::byte{0xFF})).find(ItemKind::kRobotModel, 0).empty());
  EXPECT_TRUE(Catalogue({}).find(ItemKind::kRobotModel, 0).empty());
  auto storage = test::make_storage(kModel, kMotions);
  storage[kFirstItem] ^= std::byte{1};
  EXPECT_TRUE(Catalogue(storage).find(ItemKind::kRobotModel, 0).empty());
}

TEST(Catalogue, NeverPointsOutsideTheStorage) {
  for (const std::uint32_t beyond : {100u, 0x7FFF'FFFFu, 0xFFFF'FFFFu}) {
    for (const std::size_t field : {kOffsetField, kSizeField}) {
      const auto storage = with_field(1, field, beyond);
      const Catalogue catalogue(storage);
      EXPECT_TRUE(catalogue.find(ItemKind::kMotion, 0).empty());
      EXPECT_EQ(catalogue.find(ItemKind::kMotion, 1).size(), kMotions[1].size());
    }
  }
}

TEST(Catalogue, IsEmptyWhenItsCountIsNotItsLength) {
  std::vector<std::byte> catalogue = test::make_storage(kModel, kMotions);
  catalogue.resize(kFirstItem + 3 * kCatalogueItemSize);
  catalogue[kImageHeaderSize] = std::byte{4};
  test::seal(catalogue);
  EXPECT_TRUE(Catalogue(catalogue).find(ItemKind::kRobotModel, 0).empty());
}

}  // namespace
}  // namespace koboshi::storage
