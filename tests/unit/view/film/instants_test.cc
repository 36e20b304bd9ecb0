#include "view/film/instants.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace koboshi::view {
namespace {

using testing::ElementsAre;

TEST(FilmTimes, AreFramesOfTheIntervalWithoutItsEnd) {
  EXPECT_THAT(film_times_us({1'000'000, 1'100'000}, 50.0, 1.0),
              ElementsAre(1'000'000, 1'020'000, 1'040'000, 1'060'000, 1'080'000));
  EXPECT_THAT(film_times_us({0, 100'000}, 50.0, 2.0), ElementsAre(0, 40'000, 80'000));
  EXPECT_THAT(film_times_us({500, 500}, 30.0, 1.0), ElementsAre(500)) << "at least one frame";
}

TEST(FilmTimes, DoNotDrift) { EXPECT_EQ(film_times_us({0, 100'000'000}, 30.0, 1.0).size(), 3000U); }

TEST(StripTimes, IncludeBothEnds) {
  EXPECT_THAT(strip_times_us({1'000'000, 3'000'000}, 3), ElementsAre(1'000'000, 2'000'000, 3'000'000));
  EXPECT_THAT(strip_times_us({1'000'000, 3'000'000}, 1), ElementsAre(1'000'000));
}

TEST(StripLayout, PutsPicturesSideBySide) {
  const StripLayout layout = strip_layout(4, 400, 440, true);
  EXPECT_EQ(layout.left_px(0), 0);
  EXPECT_EQ(layout.left_px(1), 400 + layout.gap_px);
  EXPECT_EQ(layout.left_px(3) + 400, layout.width_px);
  EXPECT_GT(layout.gap_px, 0);
  EXPECT_GT(layout.baseline_px, 440.0);
  EXPECT_LT(layout.baseline_px, layout.height_px);
  EXPECT_EQ(strip_layout(4, 400, 440, false).height_px, 440);
}

}  // namespace
}  // namespace koboshi::view
