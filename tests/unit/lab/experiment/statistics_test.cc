#include "lab/experiment/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

namespace koboshi::lab {
namespace {

TEST(MeanEstimate, MatchesAWorkedExample) {
  // Mean 5, deviation sqrt(2.5); Student's t for 4 degrees of freedom, 97.5 %, is 2.7764451 in any table.
  const std::array values{3.0, 4.0, 5.0, 6.0, 7.0};
  const MeanEstimate estimate = estimate_mean(values);
  EXPECT_EQ(estimate.count, 5u);
  EXPECT_DOUBLE_EQ(estimate.mean, 5.0);
  EXPECT_DOUBLE_EQ(estimate.standard_deviation, std::sqrt(2.5));
  EXPECT_NEAR(estimate.confidence_95.half_width(), 2.7764451 * std::sqrt(2.5 / 5.0), 1e-7);
  EXPECT_NEAR(estimate.confidence_95.low, 5.0 - 1.9632431, 1e-6);
}

TEST(MeanEstimate, NeedsOneValueForAMeanAndTwoForAnInterval) {
  EXPECT_TRUE(std::isnan(estimate_mean({}).mean));
  const std::array one{2.5};
  EXPECT_EQ(estimate_mean(one).mean, 2.5);
  EXPECT_TRUE(std::isnan(estimate_mean(one).confidence_95.high));
}

TEST(MeanEstimate, OfEqualValuesHasNoWidth) {
  const std::vector<double> values(20, 0.25);
  EXPECT_EQ(estimate_mean(values).confidence_95, (Interval{0.25, 0.25}));
}

TEST(ShareEstimate, MatchesTheIntervalsOfNewcombe) {
  // R. G. Newcombe, "Two-sided confidence intervals for the single proportion", 1998, table I, method 3.
  struct Printed {
    std::size_t events, count;
    Interval interval;
  };
  for (const Printed& printed : {Printed{81, 263, {0.2553, 0.3662}}, Printed{15, 148, {0.0624, 0.1605}},
                                 Printed{0, 20, {0.0000, 0.1611}}, Printed{1, 29, {0.0061, 0.1718}}}) {
    const ShareEstimate estimate = estimate_share(printed.events, printed.count);
    EXPECT_NEAR(estimate.confidence_95.low, printed.interval.low, 5e-5) << printed.events;
    EXPECT_NEAR(estimate.confidence_95.high, printed.interval.high, 5e-5) << printed.events;
  }
}

TEST(ShareEstimate, IsSymmetric) {
  const ShareEstimate few = estimate_share(3, 40);
  const ShareEstimate many = estimate_share(37, 40);
  EXPECT_NEAR(few.confidence_95.low, 1.0 - many.confidence_95.high, 1e-15);
  EXPECT_EQ(estimate_share(20, 20).confidence_95.high, 1.0);
  EXPECT_EQ(estimate_share(0, 20).confidence_95.low, 0.0);
}

TEST(ShareEstimate, IsNaNWithoutTrials) {
  EXPECT_EQ(estimate_share(0, 0).confidence_95, (Interval{0.0, 1.0}));
}

// The ranks of published tables for the median (Conover, table A3): 2 and 9 of 10, 6 and 15 of 20, 40 and 61
// of 100.
TEST(Quantile, HasTheIntervalOfTheBinomialLaw) {
  for (const auto& [count, low, high] : {std::tuple{10, 2, 9}, {20, 6, 15}, {100, 40, 61}}) {
    std::vector<double> values(static_cast<std::size_t>(count));
    std::iota(values.begin(), values.end(), 1.0);
    const QuantileEstimate estimate = estimate_quantile(values, 0.5);
    EXPECT_EQ(estimate.confidence_95.low, low) << count;
    EXPECT_EQ(estimate.confidence_95.high, high) << count;
  }
}

TEST(Quantile, IsReachedByAllButAFraction) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const QuantileEstimate estimate = estimate_quantile(values, 0.05);
  EXPECT_EQ(estimate.value, 6.0) << "95 values are 6 or more";
  EXPECT_LT(estimate.confidence_95.low, 6.0);
  EXPECT_GT(estimate.confidence_95.high, 6.0);
  EXPECT_LE(estimate.confidence_95.high, 12.0);
  EXPECT_EQ(estimate_quantile(std::vector<double>{3.0, 2.0}, 0.05).value, 2.0) << "of few, all";
  EXPECT_TRUE(std::isnan(estimate_quantile({}, 0.05).value));
}

}  // namespace
}  // namespace koboshi::lab
