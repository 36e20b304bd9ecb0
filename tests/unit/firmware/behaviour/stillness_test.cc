#include "firmware/behaviour/stillness.h"

#include <gtest/gtest.h>

namespace koboshi::behaviour {
namespace {

using namespace fixed::literals;

TEST(StillnessTest, IsAWhileWithoutATurnAboutAnyAxis) {
  Stillness stillness;
  for (int i = 1; i < Stillness::kCycles; ++i) EXPECT_FALSE(stillness.update({}));
  EXPECT_TRUE(stillness.update({0.14_rad_per_s, -0.14_rad_per_s, 0.14_rad_per_s}));
  EXPECT_TRUE(stillness.update({}));
}

TEST(StillnessTest, BeginsAnewWithEachTurn) {
  const Stillness::Rates turns[] = {
      {0.16_rad_per_s, {}, {}}, {{}, -0.16_rad_per_s, {}}, {{}, {}, 0.16_rad_per_s}};
  for (const auto& turn : turns) {
    Stillness stillness;
    for (int i = 0; i < Stillness::kCycles; ++i) static_cast<void>(stillness.update({}));
    EXPECT_FALSE(stillness.update(turn));
    for (int i = 1; i < Stillness::kCycles; ++i) EXPECT_FALSE(stillness.update({}));
    EXPECT_TRUE(stillness.update({}));
  }
}

TEST(StillnessTest, LastsAsLongAsItIsStill) {
  Stillness stillness;
  for (int i = 0; i < 1'000; ++i) EXPECT_EQ(stillness.update({}), i + 1 >= Stillness::kCycles);
  stillness.restart();
  EXPECT_FALSE(stillness.update({}));
}

}  // namespace
}  // namespace koboshi::behaviour
