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

// Flash may keep another bit than the one that was written and report success. Every write is read back.
TEST(ItemStoreDamage, NoticesFlashThatIsWrongWithoutAWord) {
  Log log(24 * 1024, kSectorSize);
  for (std::uint16_t i = 0; i < 20; ++i) ASSERT_EQ(log.write(i, pattern(500, i)), Status::kOk);
  int noticed = 0;
  for (unsigned i = 0; i < 300; ++i) {
    if (i % 5 == 0) log.flash.corrupt_next();
    const auto number = static_cast<std::uint16_t>(i % 20);
    if (log.write(number, pattern(500, i)) == Status::kFailed) {
      ++noticed;
      ASSERT_EQ(log.write(number, pattern(500, i)), Status::kOk) << i;
    }
    ASSERT_TRUE(log.is_as_expected()) << i;
    if (i % 50 == 0) log.restart();
    ASSERT_TRUE(log.is_as_expected()) << i;
  }
  EXPECT_GT(noticed, 40);
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

// The contents of an item are not taken for a record, even if they look like one.
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

}  // namespace
}  // namespace koboshi::storage
