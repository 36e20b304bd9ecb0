#include "firmware/storage/item_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "hal/fake/storage.h"

namespace koboshi::storage {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t kSectors = 128;
constexpr std::size_t kSectorSize = 2048;
constexpr std::size_t kFirst = kSectors * kSectorSize - kRobotLayout.size_bytes();

Bytes pattern(std::size_t size, unsigned seed) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 13 + i / 256 + seed);
  return bytes;
}

// An item store on a robot's flash.
class ItemStoreTest : public testing::Test {
 protected:
  ItemStoreTest() { storage.complete_after(3); }

  // Repeats the call until the flash is ready and returns its result, or nothing if power fails before.
  template <typename Verb>
  std::optional<Status> repeat(const Verb& verb) {
    for (int i = 0; i < 1'000; ++i) {
      const Status status = verb();
      if (status != Status::kBusy) return status;
      if (operations_left && !advance()) return std::nullopt;
      store->process();
    }
    return std::nullopt;
  }
  // Returns false if power fails here, after this number of milliseconds.
  bool advance() { return (*operations_left)-- > 0; }

  std::optional<Status> write(std::uint16_t number, const Bytes& bytes) {
    std::optional<Status> status = repeat([&] { return store->begin(ItemKind::kMotion, number); });
    for (std::size_t i = 0; i < bytes.size() && status == Status::kOk; i += 7) {
      const auto piece = std::span(bytes).subspan(i, std::min<std::size_t>(7, bytes.size() - i));
      status = repeat([&] { return store->append(piece); });
    }
    if (status == Status::kOk) status = repeat([&] { return store->commit(); });
    if (status) store->release();
    return status;
  }
  Bytes item(std::uint16_t number) const {
    const auto found = store->find(ItemKind::kMotion, number);
    return {found.begin(), found.end()};
  }
  void power_cycle() {
    storage.lose_power();
    store.emplace(storage, kRobotLayout);
  }

  hal::FakeStorage storage{kSectors, kSectorSize};
  std::optional<ItemStore> store{std::in_place, storage, kRobotLayout};
  std::optional<int> operations_left;  // milliseconds until power failure
};

TEST_F(ItemStoreTest, IsEmptyAtFirst) { EXPECT_TRUE(item(0).empty()); }

TEST_F(ItemStoreTest, KeepsItemsOfAnySizeOverAPowerCycle) {
  const std::size_t sizes[] = {0, 1, 7, 8, 9, 255, 256, 257, 2048, kRobotLayout.max_item_size_bytes()};
  for (std::uint16_t i = 0; i < std::size(sizes); ++i) {
    ASSERT_EQ(write(i, pattern(sizes[i], i)), Status::kOk);
    EXPECT_EQ(item(i), pattern(sizes[i], i));
  }
  power_cycle();
  for (std::uint16_t i = 0; i < std::size(sizes); ++i) EXPECT_EQ(item(i), pattern(sizes[i], i));
}

TEST_F(ItemStoreTest, TheNewestItemIsValid) {
  for (unsigned version = 0; version < 3 * kRobotLayout.slots; ++version) {
    ASSERT_EQ(write(3, pattern(100, version)), Status::kOk) << version;
    EXPECT_EQ(item(3), pattern(100, version));
    if (version % 5 == 0) power_cycle();
    EXPECT_EQ(item(3), pattern(100, version));
  }
}

TEST_F(ItemStoreTest, EverySlotButOneMayBeInUseAndEachBeReplaced) {
  for (std::uint16_t i = 0; i + 1u < kRobotLayout.slots; ++i) {
    ASSERT_EQ(write(i, pattern(50, i)), Status::kOk) << i;
  }
  for (std::uint16_t i = 0; i + 1u < kRobotLayout.slots; ++i) {
    ASSERT_EQ(write(i, pattern(60, i)), Status::kOk) << i;
  }
  ASSERT_EQ(write(100, pattern(50, 0)), Status::kOk);  // the last
  EXPECT_EQ(write(101, pattern(50, 0)), Status::kFull);
  power_cycle();
  for (std::uint16_t i = 0; i + 1u < kRobotLayout.slots; ++i) EXPECT_EQ(item(i), pattern(60, i));
}

TEST_F(ItemStoreTest, DoesNotModifyTheFactoryPart) {
  const Bytes factory = pattern(kFirst, 1);
  storage.load(0, factory);
  for (std::uint16_t i = 0; i < 40; ++i) ASSERT_EQ(write(i % 8, pattern(6'000, i)), Status::kOk);
  EXPECT_TRUE(std::ranges::equal(storage.contents().first(kFirst), factory));
}

TEST_F(ItemStoreTest, NothingHappensWithoutCommit) {
  ASSERT_EQ(write(3, pattern(100, 1)), Status::kOk);
  ASSERT_EQ(repeat([&] { return store->begin(ItemKind::kMotion, 3); }), Status::kOk);
  ASSERT_EQ(store->append(pattern(50, 2)), Status::kOk);
  EXPECT_EQ(store->begin(ItemKind::kMotion, 4), Status::kInUse);  // only one transfer at a time
  store->release();
  EXPECT_EQ(item(3), pattern(100, 1));
  ASSERT_EQ(write(3, pattern(100, 3)), Status::kOk);
  EXPECT_EQ(item(3), pattern(100, 3));
}

TEST_F(ItemStoreTest, RefusesAnItemThatIsTooLong) {
  EXPECT_EQ(write(3, pattern(kRobotLayout.max_item_size_bytes() + 1, 1)), Status::kTooLong);
  EXPECT_TRUE(item(3).empty());
}

TEST_F(ItemStoreTest, WorksAroundFlashThatFails) {
  ASSERT_EQ(write(3, pattern(100, 1)), Status::kOk);
  storage.fail_next();
  EXPECT_EQ(write(3, pattern(100, 2)), Status::kFailed);
  EXPECT_EQ(item(3), pattern(100, 1));
  EXPECT_EQ(write(3, pattern(100, 2)), Status::kOk);
  EXPECT_EQ(item(3), pattern(100, 2));
}

TEST_F(ItemStoreTest, OnlyItsWriterEndsAnItem) {
  ASSERT_EQ(repeat([&] { return store->begin(ItemKind::kMotion, 3); }), Status::kOk);
  ASSERT_EQ(store->append(pattern(50, 2)), Status::kOk);
  storage.fail_next();
  ASSERT_EQ(repeat([&] { return store->flush(); }), Status::kFailed);
  EXPECT_EQ(store->begin(ItemKind::kMotion, 4), Status::kInUse);
  EXPECT_EQ(store->commit(), Status::kFailed);
  store->release();
  ASSERT_EQ(repeat([&] { return store->begin(ItemKind::kMotion, 3); }), Status::kOk);
  ASSERT_EQ(repeat([&] { return store->commit(); }), Status::kOk);
  EXPECT_EQ(store->begin(ItemKind::kMotion, 4), Status::kInUse);
  EXPECT_EQ(store->commit(), Status::kOk);
  store->release();
  EXPECT_EQ(write(4, pattern(50, 3)), Status::kOk);
}

TEST_F(ItemStoreTest, AcceptsTheLargestPieceAfterAPartialWriteUnit) {
  ASSERT_EQ(repeat([&] { return store->begin(ItemKind::kMotion, 3); }), Status::kOk);
  ASSERT_EQ(store->append(pattern(7, 1)), Status::kOk);
  EXPECT_EQ(repeat([&] { return store->append(pattern(ItemStore::kMaxAppendSize, 2)); }), Status::kOk);
}

TEST_F(ItemStoreTest, AssertsItsPreconditions) {
  EXPECT_DEATH(static_cast<void>(store->flush()), "begun");
  EXPECT_DEATH(static_cast<void>(store->commit()), "begun");
  EXPECT_DEATH(static_cast<void>(store->written()), "begun");
  EXPECT_DEATH(static_cast<void>(store->append({})), "begun");
  ASSERT_EQ(repeat([&] { return store->begin(ItemKind::kMotion, 3); }), Status::kOk);
  EXPECT_DEATH(static_cast<void>(store->append(pattern(ItemStore::kMaxAppendSize + 1, 1))), "kMaxAppendSize");
  hal::FakeStorage large_sectors(16, 16 * 1024);
  EXPECT_DEATH(ItemStore(large_sectors, kRobotLayout), "sector_size_bytes");
}

TEST_F(ItemStoreTest, StorageWithoutRoomStoresNothing) {
  hal::FakeStorage small(4, 1024);
  ItemStore none(small, kRobotLayout);
  EXPECT_EQ(none.begin(ItemKind::kMotion, 0), Status::kFull);
  EXPECT_TRUE(none.find(ItemKind::kMotion, 0).empty());
}

// Power fails in every millisecond of a write; the interrupted operation leaves its range scrambled.
TEST_F(ItemStoreTest, PowerFailureLeavesTheOldOrTheNewItem) {
  const Bytes before = pattern(700, 1);
  const Bytes after = pattern(700, 2);
  int failures = 0;
  for (int time_ms = 0;; ++time_ms) {
    operations_left.reset();
    ASSERT_EQ(write(3, before), Status::kOk);
    operations_left = time_ms;
    const std::optional<Status> written = write(3, after);
    power_cycle();
    if (written == Status::kOk) break;
    ++failures;
    ASSERT_TRUE(item(3) == before || item(3) == after) << time_ms;
    operations_left.reset();
    ASSERT_EQ(write(4, after), Status::kOk) << time_ms;  // writing still works
  }
  EXPECT_EQ(item(3), after);
  EXPECT_GT(failures, 20);
}

// The same by words, the unit of a flash write: all words before the cut are complete, the one at the cut is
// complete, torn or missing.
TEST_F(ItemStoreTest, ImageCutAtAnyWordIsNotLoaded) {
  const Bytes before = pattern(700, 1);
  ASSERT_EQ(write(3, before), Status::kOk);
  ASSERT_EQ(write(3, pattern(700, 2)), Status::kOk);
  const Bytes whole(storage.contents().begin(), storage.contents().end());
  const std::size_t start = kFirst + 2 * kRobotLayout.slot_size_bytes;
  for (std::size_t cut = 0; cut < kRobotLayout.slot_size_bytes; cut += 8) {
    if (std::ranges::all_of(std::span(whole).subspan(start + cut, 8),
                            [](std::byte byte) { return byte == std::byte{0xFF}; })) {
      continue;  // words that are never written
    }
    for (const std::byte torn : {std::byte{0xFF}, std::byte{0xA5}, std::byte{0x00}}) {
      Bytes flash = whole;
      const auto rest = flash.begin() + static_cast<std::ptrdiff_t>(start + cut);
      std::fill(rest, rest + static_cast<std::ptrdiff_t>(kRobotLayout.slot_size_bytes - cut),
                std::byte{0xFF});
      std::fill_n(rest, 4, torn);
      storage.load(0, flash);
      power_cycle();
      ASSERT_EQ(item(3), before) << cut;
    }
  }
  storage.load(0, whole);
  power_cycle();
  EXPECT_EQ(item(3), pattern(700, 2));
}

}  // namespace
}  // namespace koboshi::storage
