#include "firmware/canopen/slot_map.h"

#include <gtest/gtest.h>

#include <array>

namespace koboshi::canopen {
namespace {

TEST(SlotMap, FindsWhatWasInsertedInAnyOrder) {
  std::array<SlotMap::Item, 5> items;
  SlotMap map(items);
  const std::uint16_t keys[] = {0x210, 0x180, 0x7FF, 0x200, 0x001};
  for (std::uint8_t slot = 0; slot < 5; ++slot) map.insert(keys[slot], slot);
  for (std::uint8_t slot = 0; slot < 5; ++slot) EXPECT_EQ(map.find(keys[slot]), slot);
  for (const std::uint16_t absent : std::to_array<std::uint16_t>({0x000, 0x002, 0x1FF, 0x201, 0x7FE})) {
    EXPECT_EQ(map.find(absent), SlotMap::kNone) << absent;
  }
}

TEST(SlotMap, LetsTheFirstOfEqualKeysWin) {
  std::array<SlotMap::Item, 2> items;
  SlotMap map(items);
  map.insert(7, 1);
  map.insert(7, 0);
  EXPECT_EQ(map.find(7), 1u);
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
