#include "sim_board/storage/node_flash.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

namespace koboshi::sim_board {
namespace {

using hal::StorageState;

constexpr std::array kBytes{std::byte{0x12}, std::byte{0x34}};

int polls_until_idle(const NodeFlash& flash) {
  int polls = 0;
  while (flash.state() == StorageState::kBusy) ++polls;
  return polls;
}

bool holds(const NodeFlash& flash, std::size_t offset) {
  return std::ranges::equal(flash.contents().subspan(offset, kBytes.size()), kBytes);
}

TEST(NodeFlash, IsErasedWhenItIsNew) {
  const NodeFlash flash;
  EXPECT_EQ(flash.contents().size(), NodeFlash::kSize_bytes);
  EXPECT_TRUE(std::ranges::all_of(flash.contents(), [](std::byte byte) { return byte == std::byte{0xFF}; }));
  EXPECT_EQ(flash.state(), StorageState::kIdle);
}

TEST(NodeFlash, TakesItsTime) {
  NodeFlash flash;
  ASSERT_TRUE(flash.begin_write(16, kBytes));
  EXPECT_FALSE(flash.begin_write(32, kBytes));
  EXPECT_FALSE(flash.begin_erase(0));
  EXPECT_FALSE(holds(flash, 16));
  EXPECT_EQ(polls_until_idle(flash), NodeFlash::kWritePolls);
  EXPECT_TRUE(holds(flash, 16));
  ASSERT_TRUE(flash.begin_erase(0));
  EXPECT_EQ(polls_until_idle(flash), NodeFlash::kErasePolls);
  EXPECT_EQ(flash.contents()[16], std::byte{0xFF});
}

TEST(NodeFlash, RejectsImpossibleOperations) {
  NodeFlash flash;
  EXPECT_FALSE(flash.begin_erase(1));
  EXPECT_FALSE(flash.begin_erase(NodeFlash::kSize_bytes));
  EXPECT_FALSE(flash.begin_write(NodeFlash::kSize_bytes - 1, kBytes));
  EXPECT_FALSE(flash.begin_write(0, {}));
  ASSERT_TRUE(flash.begin_write(0, kBytes));
  polls_until_idle(flash);
  EXPECT_FALSE(flash.begin_write(0, std::array{std::byte{0x13}}));  // a bit would have to be set
  EXPECT_TRUE(flash.begin_write(0, std::array{std::byte{0x10}}));
}

TEST(NodeFlash, LeavesAnUndefinedRangeAfterAPowerFailure) {
  NodeFlash flash;
  ASSERT_TRUE(flash.begin_write(0, kBytes));
  flash.lose_power();
  EXPECT_EQ(flash.state(), StorageState::kIdle);
  EXPECT_FALSE(holds(flash, 0));
  EXPECT_NE(flash.contents()[0], std::byte{0xFF});
  EXPECT_EQ(flash.contents()[2], std::byte{0xFF});
}

}  // namespace
}  // namespace koboshi::sim_board
