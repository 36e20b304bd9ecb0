#include "simulation/observe/statistics.h"

#include <gtest/gtest.h>

namespace koboshi::simulation {
namespace {

TEST(Percentile, InterpolatesLinearly) {
  EXPECT_EQ(percentile({3.0, 1.0, 2.0}, 0.0), 1.0);
  EXPECT_EQ(percentile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(percentile({3.0, 1.0, 2.0}, 1.0), 3.0);
  EXPECT_DOUBLE_EQ(percentile({0.0, 10.0}, 0.05), 0.5);
  EXPECT_EQ(percentile({7.0}, 0.05), 7.0);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

TEST(RootMeanSquare, IsNaNOfAnEmptySeries) {
  RootMeanSquare error;
  EXPECT_TRUE(std::isnan(error.value()));
  error.add(9.0);
  error.add(16.0);
  EXPECT_DOUBLE_EQ(error.value(), std::sqrt(12.5));
}

}  // namespace
}  // namespace koboshi::simulation
