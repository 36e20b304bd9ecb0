#include "firmware/canopen/slot_map.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>

namespace koboshi::canopen {
namespace {

TEST(SlotMap, FindsKeysInsertedInAnyOrder) {
  std::array<SlotMap::Item, 5> items;
  SlotMap map(items);
  const std::uint16_t keys[] = {0x210, 0x180, 0x7FF, 0x200, 0x001};
  for (std::uint8_t slot = 0; slot < 5; ++slot) map.insert(keys[slot], slot);
  for (std::uint8_t slot = 0; slot < 5; ++slot) EXPECT_EQ(map.find(keys[slot]), slot);
  for (const std::uint16_t absent : std::to_array<std::uint16_t>({0x000, 0x002, 0x1FF, 0x201, 0x7FE})) {
    EXPECT_EQ(map.find(absent), SlotMap::kNone) << absent;
  }
}

TEST(SlotMap, PrefersTheFirstOfEqualKeys) {
  std::array<SlotMap::Item, 2> items;
  SlotMap map(items);
  map.insert(7, 1);
  map.insert(7, 0);
  EXPECT_EQ(map.find(7), 1u);
}

// Each search leaves its result as the first guess of the next.
TEST(SlotMap, FindsEveryKeyAfterAnyOther) {
  std::array<SlotMap::Item, 6> items;
  SlotMap map(items);
  const std::uint16_t keys[] = {3, 7, 7, 9, 9, 20};
  for (std::uint8_t slot = 0; slot < 6; ++slot) map.insert(keys[slot], slot);
  const std::pair<std::uint16_t, std::size_t> expected[] = {
      {2, SlotMap::kNone}, {3, 0}, {7, 1}, {8, SlotMap::kNone}, {9, 3}, {20, 5}, {21, SlotMap::kNone}};
  for (const auto& [first, first_slot] : expected) {
    for (const auto& [second, second_slot] : expected) {
      EXPECT_EQ(map.find(first), first_slot);
      EXPECT_EQ(map.find(second), second_slot) << second << " after " << first;
    }
  }
}

TEST(SlotMap, ClearsItsGuessWithItsKeys) {
  std::array<SlotMap::Item, 4> items;
  SlotMap map(items);
  for (std::uint8_t slot = 0; slot < 4; ++slot) map.insert(slot, slot);
  EXPECT_EQ(map.find(2), 2u);
  map.clear();
  map.insert(3, 7);
  EXPECT_EQ(map.find(3), 7u);
  EXPECT_EQ(map.find(2), SlotMap::kNone);
  map.insert(1, 8);
  EXPECT_EQ(map.find(1), 8u);
  EXPECT_EQ(map.find(3), 7u);
}

TEST(SlotMap, StaysWithinItsMemory) {
  std::array<SlotMap::Item, 1> items;
  SlotMap map(items);
  map.insert(7, 0);
  map.insert(3, 1);
  EXPECT_EQ(map.find(7), 0u);
  EXPECT_EQ(map.find(3), SlotMap::kNone);
  map.clear();
  EXPECT_EQ(map.find(7), SlotMap::kNone);
}

}  // namespace
}  // namespace koboshi::canopen
