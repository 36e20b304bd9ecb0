#include "firmware/storage/item_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "firmware/storage/image.h"
#include "hal/fake/storage.h"
#include "tests/unit/firmware/storage/cut_flash.h"
#include "tests/unit/firmware/storage/item_log.h"

namespace koboshi::storage {
namespace {

using test::CutFlash;

// --- Items

TEST(ItemStoreTest, IsEmptyAtFirst) {
  const Log log(kRobotLogSize_bytes, kSectorSize);
  EXPECT_TRUE(log.is_as_expected());
  EXPECT_EQ(log.flash.words, 0u);
}

TEST(ItemStoreTest, KeepsItemsOfAnySizeOverAPowerCycle) {
  Log log(kRobotLogSize_bytes, kSectorSize);
  const std::size_t sizes[] = {1,   7,   8,   9,    239,   240,
                               241, 255, 256, 2048, 6'144, ItemStore::kMaxItemSize_bytes};
  for (std::uint16_t i = 0; i < std::size(sizes); ++i) {
    ASSERT_EQ(log.write(i, pattern(sizes[i], i)), Status::kOk);
    ASSERT_TRUE(log.is_as_expected());
  }
  log.restart();
  EXPECT_TRUE(log.is_as_expected());
}

// One of each kind, found under its own kind after a restart.
TEST(ItemStoreTest, KeepsTheKindOfEachItem) {
  hal::FakeStorage flash(kRobotLogSize_bytes / kSectorSize, kSectorSize);
  const ItemKind kinds[] = {ItemKind::kMotion, ItemKind::kParameters, ItemKind::kNodeId, ItemKind::kPolicy};
  {
    ItemStore store(flash, kRobotLogSize_bytes);
    for (const ItemKind kind : kinds) {
      const auto bytes = pattern(40, static_cast<unsigned>(kind));
      const auto repeat = [&](auto&& operation) {
        Status status = Status::kBusy;
        for (int i = 0; i < 1'000 && status == Status::kBusy; ++i) {
          status = operation();
          store.process();
        }
        return status;
      };
      ASSERT_EQ(repeat([&] { return store.begin(kind, 0, 40); }), Status::kOk);
      ASSERT_EQ(repeat([&] { return store.append(bytes); }), Status::kOk);
      ASSERT_EQ(repeat([&] { return store.flush(); }), Status::kOk);
      ASSERT_EQ(repeat([&] { return store.commit(); }), Status::kOk);
      store.release();
    }
  }
  const ItemStore again(flash, kRobotLogSize_bytes);
  for (const ItemKind kind : kinds) {
    const auto found = again.find(kind, 0);
    const auto expected = pattern(40, static_cast<unsigned>(kind));
    EXPECT_TRUE(std::ranges::equal(found, expected)) << static_cast<int>(kind);
  }
}

TEST(ItemStoreTest, TheNewestItemIsValid) {
  Log log(16 * 1024, kSectorSize);
  for (unsigned version = 0; version < 300; ++version) {
    ASSERT_EQ(log.write(3, pattern(100 + version, version)), Status::kOk) << version;
    if (version % 5 == 0) log.restart();
    ASSERT_TRUE(log.is_as_expected()) << version;
  }
}

class ItemStoreSectors : public testing::TestWithParam<std::size_t> {};

// The robot's log with all that it must hold, each item of which may be replaced.
TEST_P(ItemStoreSectors, Hold200MotionsAndTheParameters) {
  const std::size_t sector_size = GetParam();
  const std::uint16_t motions = sector_size <= 2048 ? kMaxMotions : 194;
  Log log(kRobotLogSize_bytes, sector_size);
  ASSERT_EQ(log.write(kParameterNumber, pattern(kParameterSize, 7)), Status::kOk);
  for (std::uint16_t i = 0; i < motions; ++i)
    ASSERT_EQ(log.write(i, pattern(kMotionSize, i)), Status::kOk) << i;
  ASSERT_TRUE(log.is_as_expected());
  for (std::uint16_t i = 0; i < 40; ++i)
    ASSERT_EQ(log.write(static_cast<std::uint16_t>(i * 77u % motions), pattern(kMotionSize, i + 1)),
              Status::kOk);
  ASSERT_EQ(log.write(kParameterNumber, pattern(kParameterSize, 8)), Status::kOk);
  ASSERT_TRUE(log.is_as_expected());
  log.restart();
  EXPECT_TRUE(log.is_as_expected());
  EXPECT_EQ(log.write(3, pattern(kMotionSize, 9)), Status::kOk);
}
INSTANTIATE_TEST_SUITE_P(Sizes, ItemStoreSectors, testing::Values(128, 256, 512, 1024, 2048, 4096));

TEST(ItemStoreTest, IsFullOnlyIfNothingMoreFits) {
  Log log(kRobotLogSize_bytes, kSectorSize);
  const auto used = [&] {  // as the header of the store promises
    std::size_t live = 0;
    std::size_t largest = 0;
    for (const auto& [number, bytes] : log.items) {
      const std::size_t size = ItemStore::kHeaderSize + (bytes.size() + 7) / 8 * 8;
      live += size;
      largest = std::max(largest, size);
    }
    return std::pair(live, largest);
  };
  std::mt19937 random(5);
  int refused = 0;
  for (int i = 0; i < 1'000; ++i) {
    const Bytes bytes = pattern(1 + random() % 1'500, static_cast<unsigned>(i));
    const auto [live, largest] = used();
    const std::size_t size = ItemStore::kHeaderSize + (bytes.size() + 7) / 8 * 8;
    const bool fits = live + size + ItemStore::kHeaderSize + 2 * (std::max(largest, size) + kSectorSize) <=
                      kRobotLogSize_bytes;
    ASSERT_EQ(log.write(static_cast<std::uint16_t>(random() % kMaxMotions), bytes),
              fits ? Status::kOk : Status::kFull)
        << i;
    refused += fits ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
  EXPECT_TRUE(log.is_as_expected());
  EXPECT_LT(log.store->free_bytes(), 2'000u);
}

TEST(ItemStoreTest, AFullLogCanBeEmptied) {
  Log log(kRobotLogSize_bytes, kSectorSize);
  for (std::uint16_t i = 0; i < kMaxMotions; ++i) {
    if (log.write(i, pattern(900, i)) == Status::kFull) break;
  }
  ASSERT_EQ(log.write(199, pattern(900, 1)), Status::kFull);
  const std::size_t free = log.store->free_bytes();
  for (std::uint16_t i = 0; i < kMaxMotions; ++i) ASSERT_EQ(log.erase(i), Status::kOk) << i;
  EXPECT_TRUE(log.is_as_expected());
  EXPECT_GT(log.store->free_bytes(), free + 100'000);
  log.restart();
  EXPECT_TRUE(log.is_as_expected());
  for (std::uint16_t i = 0; i < 100; ++i) ASSERT_EQ(log.write(i, pattern(900, i + 3u)), Status::kOk) << i;
}

TEST(ItemStoreTest, DoesNotModifyTheFactoryPart) {
  CutFlash flash(kRobotLogSize_bytes + 4 * kSectorSize, kSectorSize);
  const Bytes factory = pattern(4 * kSectorSize, 1);
  flash.load(0, factory);
  ItemStore store(flash, kRobotLogSize_bytes);
  for (unsigned i = 0; i < 60; ++i) {
    while (store.begin(ItemKind::kMotion, 0) == Status::kBusy) store.process();
    for (int part = 0; part < 40; ++part) {
      while (store.append(pattern(200, i)) == Status::kBusy) store.process();
    }
    while (store.commit() == Status::kBusy) store.process();
    store.release();
    ASSERT_EQ(store.find(ItemKind::kMotion, 0).size(), 8'000u);
  }
  EXPECT_TRUE(std::ranges::equal(flash.contents().first(factory.size()), factory));
}

TEST(ItemStoreTest, NothingHappensWithoutCommit) {
  Log log(16 * 1024, 256);
  ASSERT_EQ(log.write(3, pattern(100, 1)), Status::kOk);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(log.repeat([&] { return log.begin(3, 1'000); }), Status::kOk);
    ASSERT_EQ(log.store->append(pattern(200, 2)), Status::kOk);
    log.process(i % 3);
    EXPECT_EQ(log.begin(4, 10), Status::kInUse);  // only one item at a time
    log.store->release();
    if (i % 7 == 0) log.restart();
    ASSERT_TRUE(log.is_as_expected());
  }
  ASSERT_EQ(log.write(3, pattern(100, 3)), Status::kOk);
  EXPECT_TRUE(log.is_as_expected());
}

TEST(ItemStoreTest, RefusesMoreBytesThanAnnounced) {
  Log log(kRobotLogSize_bytes, kSectorSize);
  EXPECT_EQ(log.begin(3, ItemStore::kMaxItemSize_bytes + 1), Status::kTooLong);
  ASSERT_EQ(log.repeat([&] { return log.begin(3, 10); }), Status::kOk);
  EXPECT_EQ(log.store->append(pattern(11, 1)), Status::kTooLong);
  EXPECT_EQ(log.store->append(pattern(10, 1)), Status::kOk);
  EXPECT_EQ(log.store->append(pattern(1, 1)), Status::kTooLong);
}

TEST(ItemStoreTest, OnlyItsWriterEndsAnItem) {
  Log log(16 * 1024, kSectorSize);
  ASSERT_EQ(log.repeat([&] { return log.begin(3, 100); }), Status::kOk);
  ASSERT_EQ(log.store->append(pattern(50, 2)), Status::kOk);
  log.flash.fail_next();
  ASSERT_EQ(log.repeat([&] { return log.store->flush(); }), Status::kFailed);
  EXPECT_EQ(log.begin(4, 100), Status::kInUse);
  EXPECT_EQ(log.store->commit(), Status::kFailed);
  log.store->release();
  ASSERT_EQ(log.repeat([&] { return log.begin(3, 100); }), Status::kOk);
  ASSERT_EQ(log.repeat([&] { return log.store->commit(); }), Status::kOk);
  EXPECT_EQ(log.begin(4, 100), Status::kInUse);
  EXPECT_EQ(log.store->commit(), Status::kOk);
  log.store->release();
  EXPECT_EQ(log.write(4, pattern(50, 3)), Status::kOk);
}

TEST(ItemStoreTest, AcceptsTheLargestPieceAfterAPartialWriteUnit) {
  Log log(16 * 1024, kSectorSize);
  ASSERT_EQ(log.repeat([&] { return log.begin(3, 1'000); }), Status::kOk);
  ASSERT_EQ(log.store->append(pattern(7, 1)), Status::kOk);
  EXPECT_EQ(log.repeat([&] { return log.store->append(pattern(ItemStore::kMaxAppendSize, 2)); }),
            Status::kOk);
}

TEST(ItemStoreTest, AssertsItsPreconditions) {
  Log log(16 * 1024, kSectorSize);
  ItemStore& store = *log.store;
  EXPECT_DEATH(static_cast<void>(store.flush()), "begun");
  EXPECT_DEATH(static_cast<void>(store.commit()), "begun");
  EXPECT_DEATH(static_cast<void>(store.written()), "begun");
  EXPECT_DEATH(static_cast<void>(store.append({})), "begun");
  EXPECT_DEATH(static_cast<void>(store.begin(ItemKind::kMotion, kMaxMotions)), "key");
  ASSERT_EQ(log.repeat([&] { return log.begin(3, 1'000); }), Status::kOk);
  EXPECT_DEATH(static_cast<void>(store.append(pattern(ItemStore::kMaxAppendSize + 1, 1))), "kMaxAppendSize");
  hal::FakeStorage large_sectors(16, 48 * 1024);
  EXPECT_DEATH(ItemStore(large_sectors, kRobotLogSize_bytes), "sector_size");
}

TEST(ItemStoreTest, HasOneItemOfEachKindButMotions) {
  Log log(16 * 1024, kSectorSize);
  const Bytes one = pattern(1, 9);
  for (const ItemKind kind : {ItemKind::kParameters, ItemKind::kNodeId}) {
    EXPECT_TRUE(log.store->find(kind, 0).empty());
    EXPECT_EQ(log.repeat([&] { return log.store->begin(kind, 0, one.size()); }), Status::kOk);
    EXPECT_EQ(log.repeat([&] { return log.store->append(one); }), Status::kOk);
    EXPECT_EQ(log.repeat([&] { return log.store->commit(); }), Status::kOk);
    log.store->release();
    EXPECT_TRUE(std::ranges::equal(log.store->find(kind, 0), one));
    EXPECT_TRUE(log.store->find(kind, 1).empty());
  }
  EXPECT_TRUE(log.store->find(ItemKind::kMotion, kMaxMotions).empty());
  EXPECT_TRUE(log.store->find(ItemKind::kFactoryParameters, 0).empty());
}

// A mark stays with its item until the item is written again.
TEST(ItemStoreTest, MarksEachItemByItself) {
  Log log(64 * 1024, kSectorSize);
  const auto marked = [&](std::uint16_t number) { return log.store->marked(ItemKind::kMotion, number); };
  for (const std::uint16_t number :
       {std::uint16_t{1}, std::uint16_t{31}, std::uint16_t{32}, std::uint16_t{63}})
    ASSERT_EQ(log.write(number, pattern(20, number)), Status::kOk);
  log.store->mark(ItemKind::kMotion, 5);  // there is no such item
  EXPECT_FALSE(marked(5));
  for (const std::uint16_t number : {std::uint16_t{31}, std::uint16_t{32}, std::uint16_t{63}}) {
    EXPECT_FALSE(marked(number));
    log.store->mark(ItemKind::kMotion, number);
    EXPECT_TRUE(marked(number));
  }
  EXPECT_FALSE(marked(1));
  ASSERT_EQ(log.write(63, pattern(20, 3)), Status::kOk);
  EXPECT_FALSE(marked(63));
  EXPECT_TRUE(marked(31));
  EXPECT_TRUE(marked(32));
  ASSERT_EQ(log.write(31, pattern(20, 4)), Status::kOk);
  EXPECT_FALSE(marked(31));
  EXPECT_TRUE(marked(32));
}

TEST(ItemStoreTest, StorageWithoutRoomStoresNothing) {
  hal::FakeStorage small(4, 1024);
  ItemStore none(small, kRobotLogSize_bytes);
  EXPECT_EQ(none.begin(ItemKind::kMotion, 0, 1), Status::kFull);
  EXPECT_EQ(none.erase(ItemKind::kMotion, 0), Status::kOk);
  EXPECT_TRUE(none.find(ItemKind::kMotion, 0).empty());
  EXPECT_EQ(none.free_bytes(), 0u);
}

// Each call starts at most one operation of the flash.
TEST(ItemStoreTest, WaitsForSlowFlash) {
  hal::FakeStorage flash(8, kSectorSize);
  flash.complete_by_finish();
  ItemStore store(flash, 8 * kSectorSize);
  EXPECT_EQ(store.begin(ItemKind::kMotion, 0, 100), Status::kBusy);
  for (int i = 0; i < 100; ++i) store.process();
  EXPECT_EQ(store.begin(ItemKind::kMotion, 0, 100), Status::kBusy);
  flash.finish();
  store.process();
  EXPECT_EQ(store.begin(ItemKind::kMotion, 0, 100), Status::kOk);
}

// --- Compaction and pins

TEST(ItemStoreTest, WearsAllSectorsAlike) {
  Log log(kRobotLogSize_bytes, kSectorSize);
  std::mt19937 random(3);
  for (unsigned i = 0; i < 10'000; ++i) {
    const std::uint16_t number = static_cast<std::uint16_t>(random() % 120);
    ASSERT_EQ(log.write(number, pattern(40 + random() % 1'000, i)), Status::kOk) << i;
  }
  EXPECT_TRUE(log.is_as_expected());
  const auto [least, most] = std::ranges::minmax(log.flash.erasures);
  EXPECT_GT(least, 40u);
  EXPECT_LE(most, least + 1);
}

TEST(ItemStoreTest, CompactsBeforeTheNextItemIsDue) {
  Log log(kRobotLogSize_bytes, kSectorSize);
  for (std::uint16_t i = 0; i < 190; ++i) ASSERT_EQ(log.write(i, pattern(kMotionSize, i)), Status::kOk);
  for (std::uint16_t i = 0; i < 60; ++i) {
    ASSERT_EQ(log.write(static_cast<std::uint16_t>(i * 3), pattern(kMotionSize, i + 1u)), Status::kOk);
    log.process(20'000);
    if (log.begin(0, kMotionSize) != Status::kOk) {  // one erasure
      log.process(1);
      ASSERT_EQ(log.begin(0, kMotionSize), Status::kOk) << i;
    }
    log.store->release();
  }
}

TEST(ItemStoreTest, PinnedItemsStayInPlace) {
  Log log(32 * 1024, kSectorSize);
  for (std::uint16_t i = 0; i < 10; ++i) ASSERT_EQ(log.write(i, pattern(kMotionSize, i)), Status::kOk);
  const auto played = log.store->find(ItemKind::kMotion, 2);
  log.store->pin(Holder::kPlayer, played);
  unsigned writes = 0;
  std::optional<Status> status = Status::kOk;
  for (; status == Status::kOk && writes < 1'000; ++writes) {
    status = log.write(static_cast<std::uint16_t>(writes % 10), pattern(kMotionSize, writes + 1));
    EXPECT_TRUE(std::ranges::equal(played, pattern(kMotionSize, 2)));
  }
  EXPECT_EQ(status, Status::kInUse);  // the head has come round to it
  EXPECT_GT(writes, 20u);
  log.process(1'000);
  EXPECT_EQ(log.begin(1, kMotionSize), Status::kInUse);
  EXPECT_TRUE(std::ranges::equal(played, pattern(kMotionSize, 2)));
  EXPECT_TRUE(log.is_as_expected());
  log.store->unpin(Holder::kPlayer);
  for (std::uint16_t i = 0; i < 100; ++i)
    ASSERT_EQ(log.write(i % 10, pattern(kMotionSize, i + 5u)), Status::kOk);
  EXPECT_TRUE(log.is_as_expected());
}

TEST(ItemStoreTest, APinnedItemMayBeCopiedMeanwhile) {
  Log log(14 * 1024, 512);
  std::mt19937 random(9);
  for (std::uint16_t i = 0; i < 20; ++i) ASSERT_EQ(log.write(i, pattern(400, i)), Status::kOk);
  std::array<std::span<const std::byte>, kHolders> held;
  std::array<Bytes, kHolders> contents;
  int refused = 0;
  for (unsigned i = 0; i < 3'000; ++i) {
    const auto number = static_cast<std::uint16_t>(random() % 20);
    const std::size_t holder = random() % held.size();
    held[holder] =
        random() % 2 == 0 ? log.store->find(ItemKind::kMotion, number) : std::span<const std::byte>();
    contents[holder].assign(held[holder].begin(), held[holder].end());
    log.store->pin(static_cast<Holder>(holder), held[holder]);
    const auto status = log.write(number, pattern(100 + random() % 500, i));
    ASSERT_TRUE(status == Status::kOk || status == Status::kInUse) << i;
    refused += status == Status::kInUse ? 1 : 0;
    for (std::size_t h = 0; h < held.size(); ++h) ASSERT_TRUE(std::ranges::equal(held[h], contents[h])) << i;
    ASSERT_TRUE(log.is_as_expected()) << i;
  }
  EXPECT_GT(refused, 10);
  EXPECT_LT(refused, 2'900);
}

TEST(ItemStoreTest, BytesOutsideTheLogNeedNoPin) {
  CutFlash flash(20 * 1024, 1024);
  ItemStore store(flash, 16 * 1024);
  store.pin(Holder::kPlayer, flash.contents().first(100));
  EXPECT_EQ(store.begin(ItemKind::kMotion, 0, 100), Status::kBusy);
}

// --- Everything at random

TEST(ItemStoreProperty, BehavesLikeAMap) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const std::size_t sector_size = std::size_t{128} << seed % 6;
    Log log((12 + random() % 20) * 4096, sector_size, seed);
    for (unsigned i = 0; i < 600; ++i) {
      const auto number = static_cast<std::uint16_t>(random() % 30);
      const auto kind = random() % 20;
      if (kind < 3) log.flash.cut_after(random() % 400);
      std::optional<Status> status = Status::kOk;
      if (kind == 5) {
        log.process(static_cast<int>(random() % 50));
      } else if (kind == 6) {
        status = log.erase(number);
      } else {
        const bool large = random() % 40 == 0;
        status = log.write(number == 29 ? kParameterNumber : number,
                           pattern(1 + random() % (large ? 6'144 : 900), i));
      }
      if (!status) log.restart();
      if (kind == 7) log.restart();
      ASSERT_TRUE(!status || status == Status::kOk || status == Status::kFull) << i;
      ASSERT_TRUE(log.is_as_expected()) << i;
      log.flash.power_on();
    }
  }
}

// The rest of a write unit stays as an erasure leaves it. A record: 16 bytes of header, 5 of the item, 3 of
// padding.
TEST(ItemStoreFormat, PadsAnItemWithErasedBytes) {
  Log log(16 * 1024, kSectorSize);
  ASSERT_EQ(log.write(3, Bytes(5, std::byte{0x11})), Status::kOk);
  const auto record = log.flash.contents().first(24);
  EXPECT_EQ(record[0], static_cast<std::byte>(ItemKind::kMotion));
  EXPECT_EQ(record[1], std::byte{3});
  EXPECT_EQ(record[2], std::byte{5});
  EXPECT_EQ(record[3], std::byte{0});
  for (std::size_t i = 16; i < 21; ++i) EXPECT_EQ(record[i], std::byte{0x11}) << i;
  for (std::size_t i = 21; i < 24; ++i) EXPECT_EQ(record[i], std::byte{0xFF}) << i;
}

}  // namespace
}  // namespace koboshi::storage
