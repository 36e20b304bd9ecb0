#include "firmware/storage/parameter_store.h"

#include <gtest/gtest.h>

namespace koboshi::storage {
namespace {

TEST(IndexRange, ContainsBothItsEnds) {
  constexpr IndexRange kProfile{0x6000, 0x9FFF};
  EXPECT_TRUE(kProfile.contains(0x6000));
  EXPECT_TRUE(kProfile.contains(0x9FFF));
  EXPECT_FALSE(kProfile.contains(0x5FFF));
  EXPECT_FALSE(kProfile.contains(0xA000));
}

TEST(IndexRange, ContainsAllIndicesAtFirst) {
  EXPECT_TRUE(IndexRange().contains(0));
  EXPECT_TRUE(IndexRange().contains(0xFFFF));
}

}  // namespace
}  // namespace koboshi::storage
