#include "simulation/host/flash_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "firmware/storage/item_store.h"
#include "sim_board/input/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

constexpr std::size_t kStored = FlashMemory::kSize_bytes - storage::kRobotLogSize_bytes;

class FlashFile : public testing::Test {
 protected:
  const koboshi::test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "test.flash";
  const std::vector<std::byte> contents = std::vector<std::byte>(100, std::byte{7});
};

TEST(FlashMemory, HoldsItsContentsAndIsErasedAfterThem) {
  const std::vector<std::byte> contents(100, std::byte{7});
  FlashMemory flash(contents);
  EXPECT_EQ(flash.bytes()[99], std::byte{7});
  EXPECT_EQ(flash.bytes()[100], std::byte{0xFF});
  EXPECT_EQ(flash.bytes().back(), std::byte{0xFF});
}

TEST(FlashMemory, LeavesSpaceForStoredItems) {
  EXPECT_NO_THROW(FlashMemory(std::vector<std::byte>(kStored)));
  EXPECT_THROW(FlashMemory(std::vector<std::byte>(kStored + 1)), std::length_error);
}

TEST_F(FlashFile, KeepsStoredItemsAndReplacesTheFactoryContents) {
  {
    FlashMemory flash(contents, file);
    EXPECT_EQ(flash.bytes()[kStored], std::byte{0xFF});
    flash.bytes()[kStored] = std::byte{1};
    flash.bytes().back() = std::byte{2};
  }
  FlashMemory flash(std::vector<std::byte>(50, std::byte{8}), file);
  EXPECT_EQ(flash.bytes()[49], std::byte{8});
  EXPECT_EQ(flash.bytes()[50], std::byte{0xFF});
  EXPECT_EQ(flash.bytes()[kStored], std::byte{1});
  EXPECT_EQ(flash.bytes().back(), std::byte{2});
}

TEST_F(FlashFile, RejectsAnyOtherFile) {
  koboshi::test::write_file(file, "something else");
  EXPECT_THROW(FlashMemory(contents, file), sim::InputError);
  EXPECT_EQ(std::filesystem::file_size(file), 14u);  // unchanged
  EXPECT_THROW(FlashMemory(contents, folder.path), sim::InputError);
}

TEST_F(FlashFile, RejectsTheSlotsOfAnEarlierVersion) {
  { FlashMemory flash(contents, file); }
  std::vector<std::byte> slots(FlashMemory::kSize_bytes, std::byte{0xFF});
  const std::size_t trailer = slots.size() - 33 * 6'144 - 24;
  for (std::size_t i = 0; i < 4; ++i) slots[trailer + i] = static_cast<std::byte>("KITM"[i]);
  koboshi::test::write_file(file, std::string(reinterpret_cast<const char*>(slots.data()), slots.size()));
  try {
    const FlashMemory flash(contents, file);
    FAIL();
  } catch (const sim::InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("slots of 6 KiB"));
  }
  FlashMemory other(contents, folder.path / "other.flash");
  EXPECT_EQ(other.bytes()[trailer], std::byte{0xFF});
}

}  // namespace
}  // namespace koboshi::simulation
