#include "lab/cluster/shard.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace koboshi::lab {
namespace {

TEST(Shard, IsReadAsNumberOfCount) {
  EXPECT_EQ(parse_shard("3/8"), (Shard{3, 8}));
  EXPECT_EQ(parse_shard("1/1"), (Shard{1, 1}));
  for (const char* text : {"", "3", "0/8", "9/8", "3/", "/8", "-1/8", "3/8 ", "3/100001", "1.5/8"})
    EXPECT_THROW(static_cast<void>(parse_shard(text)), std::invalid_argument) << text;
}

TEST(Shard, HasAFileOfItsOwn) { EXPECT_EQ(shard_file("runs/a", {3, 8}), "runs/a/shard-3-of-8.jsonl"); }

TEST(Shard, RangesDivideAllItems) {
  for (std::size_t total = 1; total < 40; ++total) {
    for (std::size_t count = 1; count < 45; ++count) {
      std::size_t next = 0;
      for (std::size_t number = 1; number <= count; ++number) {
        const auto [begin, end] = range_of({number, count}, total);
        ASSERT_EQ(begin, next);
        ASSERT_LE(end - begin, (total + count - 1) / count);
        ASSERT_GE(end - begin, total / count);
        for (std::size_t item = begin; item < end; ++item)
          ASSERT_EQ(shard_of(item, total, count), number) << item << " of " << total << " in " << count;
        next = end;
      }
      ASSERT_EQ(next, total);
    }
  }
}

}  // namespace
}  // namespace koboshi::lab
