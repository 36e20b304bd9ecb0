#include "hal/flash/flash_model.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace koboshi::hal {
namespace {

class Flash : public ::testing::Test {
 protected:
  std::byte at(std::size_t offset) const { return flash_.contents()[offset]; }
  // Counts the busy answers of `state`.
  int wait() {
    int polls = 0;
    while (flash_.state() == StorageState::kBusy && polls < 1000) ++polls;
    return polls;
  }

  std::vector<std::byte> memory_ = std::vector<std::byte>(FlashModel::kSize_bytes, std::byte{0xFF});
  FlashModel flash_{std::span(memory_).first<FlashModel::kSize_bytes>()};
};

TEST_F(Flash, WritesAfterItsTime) {
  const std::vector bytes{std::byte{0x12}, std::byte{0x34}};
  ASSERT_TRUE(flash_.begin_write(100, bytes));
  EXPECT_NE(at(100), std::byte{0x12});  // reading without waiting does not give the data
  EXPECT_EQ(wait(), FlashModel::kWritePolls);
  EXPECT_EQ(flash_.state(), StorageState::kIdle);
  EXPECT_EQ(at(99), std::byte{0xFF});
  EXPECT_EQ(at(100), std::byte{0x12});
  EXPECT_EQ(at(101), std::byte{0x34});
  EXPECT_EQ(at(102), std::byte{0xFF});
}

TEST_F(Flash, ErasesOneSectorAfterItsTime) {
  std::ranges::fill(memory_, std::byte{0x00});
  ASSERT_TRUE(flash_.begin_erase(FlashModel::kSectorSize_bytes));
  EXPECT_NE(at(FlashModel::kSectorSize_bytes), std::byte{0xFF});
  EXPECT_EQ(wait(), FlashModel::kErasePolls);
  EXPECT_EQ(at(FlashModel::kSectorSize_bytes - 1), std::byte{0x00});
  EXPECT_EQ(at(FlashModel::kSectorSize_bytes), std::byte{0xFF});
  EXPECT_EQ(at(2 * FlashModel::kSectorSize_bytes - 1), std::byte{0xFF});
  EXPECT_EQ(at(2 * FlashModel::kSectorSize_bytes), std::byte{0x00});
}

TEST_F(Flash, OnlyClearsBits) {
  memory_[7] = std::byte{0x0F};
  EXPECT_FALSE(flash_.begin_write(7, std::vector{std::byte{0x10}}));
  EXPECT_EQ(at(7), std::byte{0x0F});
  EXPECT_TRUE(flash_.begin_write(7, std::vector{std::byte{0x05}}));
  wait();
  EXPECT_EQ(at(7), std::byte{0x05});
}

TEST_F(Flash, RefusesWhileBusy) {
  ASSERT_TRUE(flash_.begin_erase(0));
  EXPECT_FALSE(flash_.begin_erase(FlashModel::kSectorSize_bytes));
  EXPECT_FALSE(flash_.begin_write(FlashModel::kSectorSize_bytes, std::vector{std::byte{0}}));
  wait();
  EXPECT_TRUE(flash_.begin_erase(FlashModel::kSectorSize_bytes));
}

TEST_F(Flash, RejectsWritesOutOfRange) {
  const std::vector<std::byte> page(StoragePort::kMaxWriteSize);
  EXPECT_FALSE(flash_.begin_erase(1));
  EXPECT_FALSE(flash_.begin_erase(FlashModel::kSize_bytes));
  EXPECT_FALSE(flash_.begin_write(FlashModel::kSize_bytes - page.size() + 1, page));
  EXPECT_FALSE(flash_.begin_write(0, std::vector<std::byte>(page.size() + 1)));
  EXPECT_FALSE(flash_.begin_write(SIZE_MAX, page));
  EXPECT_FALSE(flash_.program(FlashModel::kSize_bytes, page));
  EXPECT_TRUE(flash_.begin_write(FlashModel::kSize_bytes - page.size(), page));
}

TEST_F(Flash, IsProgrammedAtOnce) {
  ASSERT_TRUE(flash_.program(5, std::vector{std::byte{0x42}}));
  EXPECT_EQ(flash_.state(), StorageState::kIdle);
  EXPECT_EQ(at(5), std::byte{0x42});
}

}  // namespace
}  // namespace koboshi::hal
