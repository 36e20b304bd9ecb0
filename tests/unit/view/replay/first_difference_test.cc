#include "view/replay/first_difference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/walking_recording.h"

namespace koboshi::view {
namespace {

using testing::HasSubstr;

class FirstDifferenceTest : public testing::Test {
 protected:
  std::string text() const { return first_difference(a_, b_).value().text; }
  std::uint64_t time_us() const { return first_difference(a_, b_).value().time_us; }

  Recording a_ = walking_recording({.duration_s = 0.5});
  Recording b_ = a_;
};

TEST_F(FirstDifferenceTest, EqualRunsHaveNone) {
  // Not-a-numbers count as equal.
  ASSERT_TRUE(std::isnan(a_.samples[0].values[6]));
  EXPECT_FALSE(first_difference(a_, b_));
}

TEST_F(FirstDifferenceTest, NamesTheSignalAndCountsTheOthers) {
  float& value = b_.samples[7].values[1];
  value = std::nextafter(value, 1.0F);
  b_.samples[7].values[2] += 1.0F;
  b_.samples[9].values[0] += 1.0F;
  EXPECT_EQ(time_us(), 80'000U);
  EXPECT_THAT(text(), HasSubstr("true_com_x is "));
  EXPECT_THAT(text(), HasSubstr("and 1 other signal."));
}

TEST_F(FirstDifferenceTest, SignalsAreComparedByName) {
  std::swap(b_.signals[1], b_.signals[2]);
  for (Sample& sample : b_.samples) std::swap(sample.values[1], sample.values[2]);
  EXPECT_FALSE(first_difference(a_, b_));
}

TEST_F(FirstDifferenceTest, NamesTheLinkIfOnlyAPoseDiffers) {
  b_.samples[3].links[2].p_WL_m.x() += 1e-6F;
  EXPECT_EQ(time_us(), 40'000U);
  EXPECT_EQ(text(), "The pose of left_leg differs.");
}

TEST_F(FirstDifferenceTest, AnEarlierFrameComesFirst) {
  b_.samples[3].links[2].p_WL_m.x() += 1e-6F;
  b_.frames[5].frame.data[0] ^= 1;
  EXPECT_EQ(time_us(), a_.frames[5].end_us);
  EXPECT_THAT(text(), HasSubstr(" on the bus has different data."));
}

TEST_F(FirstDifferenceTest, AnEndIsADifference) {
  b_.samples.pop_back();
  EXPECT_EQ(time_us(), a_.samples.back().time_us);
  EXPECT_EQ(text(), "The second run has ended.");
}

}  // namespace
}  // namespace koboshi::view
