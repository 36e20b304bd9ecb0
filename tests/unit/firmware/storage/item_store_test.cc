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

namespace koboshi::storage {
namespace {

using Bytes = std::vector<std::byte>;
using test::CutFlash;

constexpr std::size_t kSectorSize = 2048;
constexpr std::size_t kMotionSize = 592;                 // of 12 poses of 20 joints
constexpr std::size_t kParameterSize = 1'000;            // more than all of the controller's take
constexpr std::uint16_t kParameterNumber = kMaxMotions;  // how these tests number the parameters

Bytes pattern(std::size_t size, unsigned seed) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 13 + i / 256 + seed);
  return bytes;
}

// A store, and the items that it should contain.
class Log {
 public:
  Log(std::size_t size_bytes, std::size_t sector_size, std::uint32_t seed = 1)
      : flash(size_bytes, sector_size, seed), size_(size_bytes) {
    store.emplace(flash, size_);
  }

  // Writes an item, and returns nothing if power fails meanwhile.
  std::optional<Status> write(std::uint16_t number, const Bytes& bytes) {
    attempted_ = {number, bytes};
    std::optional<Status> status = repeat([&] { return begin(number, bytes.size()); });
    for (std::size_t i = 0; i < bytes.size() && status == Status::kOk; i += ItemStore::kMaxAppendSize) {
      const auto piece =
          std::span(bytes).subspan(i, std::min<std::size_t>(ItemStore::kMaxAppendSize, bytes.size() - i));
      status = repeat([&] { return store->append(piece); });
    }
    if (status == Status::kOk) status = repeat([&] { return store->commit(); });
    if (status) store->release();
    if (status == Status::kOk) items[number] = bytes;
    return status;
  }
  std::optional<Status> erase(std::uint16_t number) {
    attempted_ = {number, {}};
    const auto status = repeat([&] { return store->erase(kind(number), index(number)); });
    if (status == Status::kOk) items.erase(number);
    return status;
  }
  Status begin(std::uint16_t number, std::size_t size) {
    return store->begin(kind(number), index(number), size);
  }
  // Repeats the call until the flash is ready.
  template <typename Verb>
  std::optional<Status> repeat(const Verb& verb) {
    for (int i = 0; i < 20'000; ++i) {
      const Status status = verb();
      if (flash.is_off()) return std::nullopt;
      if (status != Status::kBusy) return status;
      store->process();
      if (flash.is_off()) return std::nullopt;
    }
    ADD_FAILURE() << "the store does not end";
    return std::nullopt;
  }
  void process(int times) {
    for (int i = 0; i < times; ++i) store->process();
  }
  Bytes item(std::uint16_t number) const {
    const auto found = store->find(kind(number), index(number));
    return {found.begin(), found.end()};
  }
  // After a power failure the item that was being written is either the old or the new one.
  void restart() {
    flash.power_on();
    store.emplace(flash, size_);
    const Bytes found = item(attempted_.first);
    if (found == attempted_.second) {
      items[attempted_.first] = found;
      if (found.empty()) items.erase(attempted_.first);
    }
  }
  bool is_as_expected() const {
    for (std::uint16_t number = 0; number <= kParameterNumber; ++number) {
      const auto expected = items.find(number);
      if (item(number) != (expected == items.end() ? Bytes() : expected->second)) return false;
    }
    return true;
  }

  CutFlash flash;
  std::optional<ItemStore> store;
  std::map<std::uint16_t, Bytes> items;

 private:
  static ItemKind kind(std::uint16_t number) {
    return number == kParameterNumber ? ItemKind::kParameters : ItemKind::kMotion;
  }
  static std::uint16_t index(std::uint16_t number) { return number == kParameterNumber ? 0 : number; }

  std::size_t size_;
  std::pair<std::uint16_t, Bytes> attempted_;
};

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

// --- Power failures

// Power fails at every word of a sequence of replacements in a log that is nearly full, and again while the
// store recovers and goes on. Afterwards everything still works.
TEST(ItemStorePowerFailure, AtEveryWordLeavesTheOldOrTheNewItem) {
  for (const std::size_t sector_size : {128u, 512u}) {
    const std::size_t size = 8 * 1024;
    Log full(size, sector_size);
    std::mt19937 random(11);
    std::uint16_t count = 0;
    while (full.write(count, pattern(60 + random() % 300, count)) == Status::kOk) ++count;
    ASSERT_GT(count, 20);
    // A few items fewer, so that larger ones fit.
    for (std::uint16_t i = 0; i < 3; ++i) ASSERT_EQ(full.erase(i), Status::kOk);
    const auto replace_all = [&](Log& log) {
      for (std::uint16_t i = 3; i < 15; ++i) {
        const auto status = i % 5 == 4 ? log.erase(i) : log.write(i, pattern(50u + 23u * i, i + 1u));
        if (!status) return false;
        EXPECT_EQ(status, Status::kOk) << i;
      }
      return true;
    };
    bool ended = false;
    for (std::uint64_t cut = 0; !ended; ++cut) {
      SCOPED_TRACE(cut);
      Log log(size, sector_size, static_cast<std::uint32_t>(cut + 1));
      log.items = full.items;
      log.flash = full.flash;
      log.restart();
      log.flash.cut_after(cut);
      ended = replace_all(log);
      log.restart();
      ASSERT_TRUE(log.is_as_expected());
      log.flash.cut_after(random() % 300);
      static_cast<void>(replace_all(log));
      log.restart();
      ASSERT_TRUE(log.is_as_expected());
      if (cut % 4 != 0) continue;
      ASSERT_TRUE(replace_all(log));
      ASSERT_TRUE(log.is_as_expected());
    }
  }
}

// The reserve: however often power fails, a full log can be compacted.
TEST(ItemStorePowerFailure, NeverUsesUpTheReserve) {
  for (const std::size_t sector_size : {128u, 512u, 2048u}) {
    Log log(24 * 1024, sector_size);
    std::mt19937 random(17);
    std::uint16_t count = 0;
    while (log.write(count, pattern(500 + random() % 100, count)) == Status::kOk) ++count;
    ASSERT_EQ(log.erase(0), Status::kOk);  // the place of a next version
    ASSERT_EQ(log.erase(1), Status::kOk);
    int failures = 0;
    for (unsigned i = 0; i < 40; ++i) {
      const auto number = static_cast<std::uint16_t>(2 + random() % (count - 2u));
      const Bytes bytes = pattern(500 + random() % 100, i);
      for (std::optional<Status> status; status != Status::kOk;) {
        // Sometimes long enough for a sector, or an item.
        log.flash.cut_after(random() % (sector_size / 8 + 160));
        status = log.write(number, bytes);
        if (status) {
          ASSERT_EQ(status, Status::kOk) << i << ", " << sector_size << ", " << failures;
          continue;
        }
        log.restart();
        ASSERT_TRUE(log.is_as_expected()) << i << ", " << failures;
        ASSERT_LT(++failures, 20'000);
      }
    }
    EXPECT_GT(failures, 100);
  }
}

TEST(ItemStorePowerFailure, ARestartCostsNoCapacity) {
  Log log(24 * 1024, kSectorSize);
  std::uint16_t count = 0;
  while (log.write(count, pattern(600, count)) == Status::kOk) ++count;
  for (unsigned i = 0; i < 100; ++i) {
    log.restart();
    ASSERT_EQ(log.erase(static_cast<std::uint16_t>(i % count)), Status::kOk) << i;
    log.restart();
    ASSERT_EQ(log.write(static_cast<std::uint16_t>(i % count), pattern(600, i)), Status::kOk) << i;
    ASSERT_TRUE(log.is_as_expected());
  }
}

// --- Damage

TEST(ItemStoreDamage, WorksAroundFlashThatFails) {
  Log log(kRobotLogSize_bytes, kSectorSize);
  ASSERT_EQ(log.write(3, pattern(100, 1)), Status::kOk);
  std::mt19937 random(2);
  for (unsigned i = 0; i < 200; ++i) {
    log.flash.fail_next();
    EXPECT_EQ(log.write(3, pattern(100, i + 2)), Status::kFailed);
    ASSERT_TRUE(log.is_as_expected());
    for (unsigned again = 0; again < 3; ++again) {
      const auto status = log.write(3, pattern(100 + random() % 3'000, i + again));
      ASSERT_TRUE(status == Status::kOk) << i;
      ASSERT_TRUE(log.is_as_expected());
    }
  }
}

TEST(ItemStoreDamage, AFailureWhileCompactingIsReportedOnce) {
  Log log(24 * 1024, kSectorSize);
  for (std::uint16_t i = 0; i < 20; ++i) ASSERT_EQ(log.write(i, pattern(500, i)), Status::kOk);
  int failed = 0;
  for (unsigned i = 0; i < 300; ++i) {
    if (i % 10 == 0) log.flash.fail_next();
    const auto number = static_cast<std::uint16_t>(i % 20);
    if (log.write(number, pattern(500, i)) == Status::kFailed) {
      ++failed;
      ASSERT_EQ(log.write(number, pattern(500, i)), Status::kOk) << i;
    }
    ASSERT_TRUE(log.is_as_expected());
  }
  EXPECT_GT(failed, 10);
}

TEST(ItemStoreDamage, IgnoresGarbage) {
  for (std::uint32_t seed = 1; seed < 20; ++seed) {
    Log log(kRobotLogSize_bytes, kSectorSize, seed);
    std::mt19937 random(seed);
    Bytes garbage(kRobotLogSize_bytes);
    // Much of it looks like headers.
    for (std::byte& byte : garbage)
      byte = static_cast<std::byte>(seed % 2 == 0 ? random() : 2 + random() % 2);
    log.flash.load(0, garbage);
    log.restart();
    EXPECT_TRUE(log.is_as_expected());
    for (std::uint16_t i = 0; i < kMaxMotions; ++i) ASSERT_EQ(log.write(i, pattern(300, i)), Status::kOk);
    log.restart();
    EXPECT_TRUE(log.is_as_expected());
  }
}

TEST(ItemStoreDamage, ADamagedRecordIsNotLoaded) {
  Log log(16 * 1024, kSectorSize);
  for (std::uint16_t i = 0; i < 10; ++i) ASSERT_EQ(log.write(i, pattern(100, i)), Status::kOk);
  const Bytes whole(log.flash.contents().begin(), log.flash.contents().end());
  for (std::size_t offset = 0; offset < 10 * 120; ++offset) {
    if (offset % 120 >= 116) continue;  // padding
    Bytes damaged = whole;
    damaged[offset] ^= std::byte{0x10};
    log.flash.load(0, damaged);
    log.restart();
    for (std::uint16_t i = 0; i < 10; ++i)
      ASSERT_EQ(log.item(i), i == offset / 120 ? Bytes() : pattern(100, i)) << offset;
  }
}

// What an item contains is not taken for a record, even if it looks like one.
TEST(ItemStoreDamage, AnItemThatContainsARecordIsNoRecord) {
  Log other(16 * 1024, kSectorSize);
  for (unsigned i = 0; i < 9; ++i) ASSERT_EQ(other.write(5, pattern(100, i)), Status::kOk);
  Log log(16 * 1024, kSectorSize);
  ASSERT_EQ(log.write(5, pattern(50, 77)), Status::kOk);
  ASSERT_EQ(log.write(6, Bytes(other.flash.contents().begin(), other.flash.contents().begin() + 1'080)),
            Status::kOk);
  log.restart();
  EXPECT_TRUE(log.is_as_expected());
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

}  // namespace
}  // namespace koboshi::storage
