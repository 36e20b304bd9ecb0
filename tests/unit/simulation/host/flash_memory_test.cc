#include "simulation/host/flash_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <vector>

#include "base/text/error.h"
#include "firmware/storage/item_store.h"
#include "hal/flash/flash_model.h"
#include "simulation/assembly/storage_contents.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

constexpr std::size_t kStored = FlashMemory::kSize_bytes - storage::kRobotLogSize_bytes;

class FlashFile : public testing::Test {
 protected:
  const koboshi::test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "test.flash";
  const std::vector<std::byte> contents =
      make_storage_contents(std::vector<std::byte>(100, std::byte{7}), {});

  void expect_refusal(const std::vector<std::byte>& bytes, const char* found) {
    koboshi::test::write_file(file, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    try {
      const FlashMemory flash(contents, file);
      FAIL() << found;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(found));
    }
  }
  static void store(storage::ItemStore& items, std::uint16_t motion, std::size_t size) {
    const auto await = [&items](auto step) {
      while (step() == storage::Status::kBusy) items.process();
    };
    const std::vector<std::byte> bytes(storage::ItemStore::kMaxAppendSize, std::byte{42});
    await([&] { return items.begin(storage::ItemKind::kMotion, motion, size); });
    for (std::size_t done = 0; done < size; done += bytes.size()) {
      const auto part = std::span(bytes).first(std::min(bytes.size(), size - done));
      await([&] { return items.append(part); });
    }
    await([&] { return items.commit(); });
    items.release();
  }
  std::vector<std::byte> stored() const {
    const std::string text = koboshi::test::read_file(file);
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
  }
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
  const auto others = make_storage_contents(std::vector<std::byte>(50, std::byte{8}), {});
  FlashMemory flash(others, file);
  EXPECT_EQ(flash.bytes()[others.size() - 1], std::byte{8});
  EXPECT_EQ(flash.bytes()[others.size()], std::byte{0xFF});
  EXPECT_EQ(flash.bytes()[kStored], std::byte{1});
  EXPECT_EQ(flash.bytes().back(), std::byte{2});
}

TEST_F(FlashFile, RejectsAnyOtherFile) {
  koboshi::test::write_file(file, "something else");
  EXPECT_THROW(FlashMemory(contents, file), InputError);
  EXPECT_EQ(std::filesystem::file_size(file), 14u);  // unchanged
  EXPECT_THROW(FlashMemory(contents, folder.path), InputError);
}

// The file has the right size, but no run has written it.
TEST_F(FlashFile, RejectsOtherContentsOfItsSize) {
  std::mt19937 random(20261125);
  std::vector<std::byte> noise(FlashMemory::kSize_bytes);
  for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
  expect_refusal(noise, "contents without a catalogue");
  EXPECT_EQ(stored(), noise);  // unchanged
  expect_refusal(std::vector<std::byte>(FlashMemory::kSize_bytes), "contents without a catalogue");
  std::filesystem::remove(file);
  { FlashMemory flash(contents, file); }
  std::vector<std::byte> damaged = stored();
  std::ranges::copy(std::span(noise).subspan(kStored), damaged.begin() + kStored);
  expect_refusal(damaged, "a log without a single record");
}

TEST_F(FlashFile, AcceptsAnErasedFlash) {
  const std::vector<std::byte> erased(FlashMemory::kSize_bytes, std::byte{0xFF});
  koboshi::test::write_file(file, std::string(erased.size(), '\xFF'));
  EXPECT_EQ(FlashMemory(contents, file).bytes()[contents.size() - 1], std::byte{7});
}

TEST_F(FlashFile, AcceptsALogThatHasItems) {
  {
    FlashMemory flash(contents, file);
    hal::FlashModel model(flash.bytes());
    storage::ItemStore items(model, storage::kRobotLogSize_bytes);
    for (std::uint16_t motion = 0; motion < 5; ++motion) store(items, motion, 4'000);
  }
  FlashMemory flash(contents, file);
  hal::FlashModel model(flash.bytes());
  const storage::ItemStore items(model, storage::kRobotLogSize_bytes);
  EXPECT_EQ(items.find(storage::ItemKind::kMotion, 4).size(), 4'000u);
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
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("slots of 6 KiB"));
  }
  FlashMemory other(contents, folder.path / "other.flash");
  EXPECT_EQ(other.bytes()[trailer], std::byte{0xFF});
}

}  // namespace
}  // namespace koboshi::simulation
