#include "firmware/behaviour/rest_detector.h"

#include <gtest/gtest.h>

#include "firmware/fixed/literals.h"

namespace koboshi::behaviour {
namespace {

using namespace fixed::literals;

TEST(RestDetectorTest, NeedsATimeWithoutRotationAboutAnyAxis) {
  RestDetector rest;
  for (int i = 1; i < RestDetector::kCycles; ++i) EXPECT_FALSE(rest.update({}));
  EXPECT_TRUE(rest.update({0.14_rad_per_s, -0.14_rad_per_s, 0.14_rad_per_s}));
  EXPECT_TRUE(rest.update({}));
}

TEST(RestDetectorTest, RestartsWithEachRotation) {
  const RestDetector::Rates turns[] = {
      {0.16_rad_per_s, {}, {}}, {{}, -0.16_rad_per_s, {}}, {{}, {}, 0.16_rad_per_s}};
  for (const auto& turn : turns) {
    RestDetector rest;
    for (int i = 0; i < RestDetector::kCycles; ++i) static_cast<void>(rest.update({}));
    EXPECT_FALSE(rest.update(turn));
    for (int i = 1; i < RestDetector::kCycles; ++i) EXPECT_FALSE(rest.update({}));
    EXPECT_TRUE(rest.update({}));
  }
}

TEST(RestDetectorTest, LastsAsLongAsTheRobotRests) {
  RestDetector rest;
  for (int i = 0; i < 1'000; ++i) EXPECT_EQ(rest.update({}), i + 1 >= RestDetector::kCycles);
  rest.restart();
  EXPECT_FALSE(rest.update({}));
}

}  // namespace
}  // namespace koboshi::behaviour
