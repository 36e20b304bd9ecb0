#include "hal/fake/storage.h"

#include <gtest/gtest.h>

#include <array>

namespace koboshi::hal {
namespace {

constexpr std::byte kErased{0xFF};

std::array<std::byte, 2> bytes(int first, int second) {
  return {static_cast<std::byte>(first), static_cast<std::byte>(second)};
}

TEST(FakeStorage, StartsErased) {
  const FakeStorage storage(3, 16);
  ASSERT_EQ(storage.contents().size(), 48u);
  EXPECT_EQ(storage.sector_size_bytes(), 16u);
  for (const std::byte byte : storage.contents()) EXPECT_EQ(byte, kErased);
  EXPECT_EQ(storage.state(), StorageState::kIdle);
}

TEST(FakeStorage, IsBusyForTheScriptedNumberOfPolls) {
  FakeStorage storage(1, 16);
  storage.complete_after(2);
  ASSERT_TRUE(storage.begin_write(4, bytes(0x12, 0x34)));
  EXPECT_NE(storage.contents()[4], std::byte{0x12}) << "undefined until idle";
  EXPECT_EQ(storage.state(), StorageState::kBusy);
  EXPECT_FALSE(storage.begin_write(8, bytes(0, 0)));
  EXPECT_FALSE(storage.begin_erase(0));
  EXPECT_EQ(storage.state(), StorageState::kBusy);
  EXPECT_EQ(storage.state(), StorageState::kIdle);
  EXPECT_EQ(storage.contents()[4], std::byte{0x12});
  EXPECT_EQ(storage.contents()[5], std::byte{0x34});
  EXPECT_EQ(storage.contents()[6], kErased);
}

TEST(FakeStorage, WaitsForFinish) {
  FakeStorage storage(1, 16);
  storage.complete_by_finish();
  ASSERT_TRUE(storage.begin_write(0, bytes(1, 2)));
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(storage.state(), StorageState::kBusy);
  storage.finish();
  EXPECT_EQ(storage.state(), StorageState::kIdle);
  EXPECT_EQ(storage.contents()[1], std::byte{2});
}

TEST(FakeStorage, ClearsBitsOnlyUntilErased) {
  FakeStorage storage(2, 16);
  ASSERT_TRUE(storage.begin_write(0, bytes(0xF0, 0x00)));
  ASSERT_EQ(storage.state(), StorageState::kIdle);
  EXPECT_FALSE(storage.begin_write(0, bytes(0x0F, 0x00))) << "sets bits";
  ASSERT_TRUE(storage.begin_write(0, bytes(0x30, 0x00))) << "clears more bits";
  ASSERT_EQ(storage.state(), StorageState::kIdle);
  EXPECT_EQ(storage.contents()[0], std::byte{0x30});
  ASSERT_TRUE(storage.begin_write(16, bytes(0x00, 0x00)));
  ASSERT_EQ(storage.state(), StorageState::kIdle);

  ASSERT_TRUE(storage.begin_erase(0));
  ASSERT_EQ(storage.state(), StorageState::kIdle);
  EXPECT_EQ(storage.contents()[0], kErased);
  EXPECT_EQ(storage.contents()[16], std::byte{0}) << "another sector";
}

TEST(FakeStorage, RejectsMisalignedOutOfRangeAndTooLongWrites) {
  FakeStorage storage(2, 512);
  EXPECT_FALSE(storage.begin_erase(1));
  EXPECT_FALSE(storage.begin_erase(1024));
  EXPECT_FALSE(storage.begin_write(1023, bytes(0, 0)));
  EXPECT_FALSE(storage.begin_write(static_cast<std::size_t>(-1), bytes(0, 0)));
  const std::array<std::byte, StoragePort::kMaxWriteSize + 1> long_bytes{};
  EXPECT_FALSE(storage.begin_write(0, long_bytes));
  EXPECT_FALSE(storage.begin_write(0, {}));
  EXPECT_TRUE(storage.begin_write(0, std::span(long_bytes).first(StoragePort::kMaxWriteSize)));
}

TEST(FakeStorage, FailsOnceOnRequest) {
  FakeStorage storage(1, 16);
  storage.fail_next();
  ASSERT_TRUE(storage.begin_write(0, bytes(1, 2)));
  EXPECT_EQ(storage.state(), StorageState::kFailed);
  EXPECT_NE(storage.contents()[0], std::byte{1});
  ASSERT_TRUE(storage.begin_erase(0));
  EXPECT_EQ(storage.state(), StorageState::kIdle);
}

TEST(FakeStorage, KeepsAWrongBitWithoutAWordOnRequest) {
  FakeStorage storage;
  const std::array wanted{std::byte{0x12}, std::byte{0x34}};
  storage.corrupt_next();
  ASSERT_TRUE(storage.begin_write(8, wanted));
  EXPECT_EQ(storage.state(), StorageState::kIdle);
  EXPECT_EQ(storage.contents()[8], std::byte{0x12});
  EXPECT_EQ(storage.contents()[9], std::byte{0x35});
  ASSERT_TRUE(storage.begin_write(16, wanted));
  EXPECT_EQ(storage.state(), StorageState::kIdle);
  EXPECT_EQ(storage.contents()[17], std::byte{0x34});
}

TEST(FakeStorage, LeavesHalfDoneWorkWhenPowerFails) {
  FakeStorage storage(1, 16);
  storage.load(0, bytes(1, 2));
  storage.complete_by_finish();
  ASSERT_TRUE(storage.begin_erase(0));
  storage.lose_power();
  EXPECT_EQ(storage.state(), StorageState::kIdle);
  EXPECT_NE(storage.contents()[0], std::byte{1});
  EXPECT_NE(storage.contents()[0], kErased);
}

}  // namespace
}  // namespace koboshi::hal
