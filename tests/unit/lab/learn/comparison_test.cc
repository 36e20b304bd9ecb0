#include "lab/learn/comparison.h"

#include <gtest/gtest.h>

namespace koboshi::lab {
namespace {

TEST(SignTest, IsTheBinomialTailOnBothSides) {
  EXPECT_NEAR(sign_test(5, 0), 2.0 / 32.0, 1e-12);
  EXPECT_NEAR(sign_test(0, 5), 2.0 / 32.0, 1e-12);
  EXPECT_NEAR(sign_test(1, 7), 2.0 * (8.0 + 1.0) / 256.0, 1e-12);
}

TEST(SignTest, OfEqualCountsIsOne) {
  EXPECT_EQ(sign_test(0, 0), 1.0);
  EXPECT_EQ(sign_test(4, 4), 1.0);
}

TEST(Comparison, PlaysBothControllersInEachActivityOnlyWithAPolicy) {
  ComparisonOptions options;
  options.scenario = KOBOSHI_SOURCE_DIR "/scenarios/go.yaml";
  options.activities = {"push-half", "walk-full"};
  options.impulses_N_s_per_kg = {0.3, 0.4};
  const Experiment experiment = make_comparison(options);
  ASSERT_EQ(experiment.cells.size(), 3u);
  EXPECT_EQ(experiment.cells[0].name, "push-half-0.3-engine");
  EXPECT_EQ(experiment.cells[2].name, "walk-full---engine");
}

}  // namespace
}  // namespace koboshi::lab
