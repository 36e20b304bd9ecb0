#include "simulation/assembly/storage_contents.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/storage/catalogue.h"
#include "firmware/storage/image.h"

namespace koboshi::simulation {
namespace {

using storage::Catalogue;
using storage::ItemKind;
using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::size_t size, int first) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(first + static_cast<int>(i));
  return bytes;
}

class StorageContents : public testing::Test {
 protected:
  const Bytes model_ = bytes_of(101, 1);
  const std::vector<Bytes> motions_{bytes_of(33, 50), bytes_of(64, 90)};
  Bytes contents_ = make_storage_contents(model_, motions_);
};

TEST_F(StorageContents, TheFirmwareFindsEachItem) {
  const Catalogue catalogue(contents_);
  EXPECT_TRUE(std::ranges::equal(catalogue.find(ItemKind::kRobotModel, 0), model_));
  EXPECT_TRUE(std::ranges::equal(catalogue.find(ItemKind::kMotion, 0), motions_[0]));
  EXPECT_TRUE(std::ranges::equal(catalogue.find(ItemKind::kMotion, 1), motions_[1]));
}

TEST_F(StorageContents, TheFirmwareFindsNothingElse) {
  const Catalogue catalogue(contents_);
  EXPECT_TRUE(catalogue.find(ItemKind::kMotion, 2).empty());
  EXPECT_TRUE(catalogue.find(ItemKind::kRobotModel, 1).empty());
}

TEST_F(StorageContents, ADamagedCatalogueIsEmpty) {
  contents_[storage::kImageHeaderSize + 5] ^= std::byte{1};
  EXPECT_TRUE(Catalogue(contents_).find(ItemKind::kRobotModel, 0).empty());
}

TEST_F(StorageContents, AnItemThatDoesNotFitIntoStorageIsNotFound) {
  contents_.resize(contents_.size() - 1);
  const Catalogue catalogue(contents_);
  EXPECT_TRUE(catalogue.find(ItemKind::kMotion, 1).empty());
  EXPECT_FALSE(catalogue.find(ItemKind::kMotion, 0).empty());
}

TEST(ErasedStorage, IsEmpty) {
  const Bytes erased(4096, std::byte{0xFF});
  EXPECT_TRUE(Catalogue(erased).find(ItemKind::kRobotModel, 0).empty());
  EXPECT_TRUE(Catalogue({}).find(ItemKind::kRobotModel, 0).empty());
}

}  // namespace
}  // namespace koboshi::simulation
