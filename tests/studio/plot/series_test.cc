#include "studio/plot/series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/seed.h"

namespace koboshi::studio {
namespace {

constexpr float kGap = std::numeric_limits<float>::quiet_NaN();

struct Reference {
  std::vector<std::uint64_t> times_us{};
  std::vector<float> values{};

  Extent extent(std::size_t first, std::size_t last) const {
    Extent extent;
    for (std::size_t i = first; i < last; ++i)
      if (std::isfinite(values[i])) extent.add({values[i], values[i]});
    return extent;
  }
  std::size_t count_before(double time_us) const {
    std::size_t count = 0;
    while (count < times_us.size() && static_cast<double>(times_us[count]) < time_us) ++count;
    return count;
  }
};

TEST(SampleTimes, CountsSamplesUntilATime) {
  SampleTimes times;
  for (const std::uint64_t time_us : {10U, 20U, 40U}) times.append(time_us);
  EXPECT_EQ(times.count_until(9), 0U);
  EXPECT_EQ(times.count_until(10), 1U);
  EXPECT_EQ(times.count_until(39), 2U);
  EXPECT_EQ(times.count_until(1'000), 3U);
  times.truncate(1);
  EXPECT_EQ(times.count_until(1'000), 1U);
}

TEST(SampleTimesDeathTest, RejectsTimesThatDoNotIncrease) {
  EXPECT_DEATH(
      {
        SampleTimes times;
        times.append(10);
        times.append(10);
      },
      "");
}

TEST(Series, HasNoExtentInAGap) {
  Series series;
  for (int i = 0; i < 100; ++i) series.append(kGap);
  std::size_t nodes = 0;
  EXPECT_TRUE(series.extent(0, 100, nodes).empty());
  EXPECT_TRUE(series.extent(50, 50, nodes).empty());
}

// Appends, truncations and queries in any order, against a search through all samples.
TEST(Series, AgreesWithBruteForce) {
  std::mt19937 random(test::kSeed);
  const auto below = [&random](std::size_t bound) { return std::size_t{random()} % bound; };
  for (int trial = 0; trial < 40; ++trial) {
    SampleTimes times;
    Series series;
    Reference reference;
    for (int step = 0; step < 30; ++step) {
      std::uint64_t time_us = reference.times_us.empty() ? below(1'000) : reference.times_us.back();
      for (std::size_t i = below(400); i > 0; --i) {
        time_us += 1 + below(20);
        const float value = below(8) == 0 ? kGap : static_cast<float>(below(2'000)) - 1'000.0F;
        times.append(time_us);
        series.append(value);
        reference.times_us.push_back(time_us);
        reference.values.push_back(value);
      }
      if (below(4) == 0) {
        const std::size_t size = below(reference.values.size() + 1);
        times.truncate(size);
        series.truncate(size);
        reference.times_us.resize(size);
        reference.values.resize(size);
      }
      const std::size_t first = below(reference.values.size() + 1);
      const std::size_t last = first + below(reference.values.size() - first + 1);
      std::size_t nodes = 0;
      ASSERT_EQ(series.extent(first, last, nodes), reference.extent(first, last));
      ASSERT_LE(nodes, Series::max_nodes(last - first));

      std::vector<Column> columns(1 + below(20));
      const double from_us = static_cast<double>(below(80'000)) - 10'000.5;
      const double to_us = from_us + 1.0 + static_cast<double>(below(90'000));
      summarise(times, series, from_us, to_us, columns);
      const double duration_us = (to_us - from_us) / static_cast<double>(columns.size());
      std::size_t begin = reference.count_before(from_us);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const std::size_t end = reference.count_before(from_us + static_cast<double>(i + 1) * duration_us);
        ASSERT_EQ(columns[i].samples, end - begin);
        ASSERT_EQ(columns[i].extent, reference.extent(begin, end));
        if (begin < end) {
          const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
          ASSERT_TRUE(same(columns[i].first, reference.values[begin]));
          ASSERT_TRUE(same(columns[i].last, reference.values[end - 1]));
        }
        begin = end;
      }
    }
  }
}

// An hour at 1 kHz: the whole, a minute and a second take about the same work.
TEST(Series, ReadsFewNodesOfAnHour) {
  constexpr std::size_t kSamples = 3'600'000;
  constexpr std::size_t kColumns = 1280;
  SampleTimes times;
  Series series;
  for (std::size_t i = 0; i < kSamples; ++i) {
    times.append(1'000 * i);
    series.append(static_cast<float>(i % 1'000));
  }
  std::vector<Column> columns(kColumns);
  for (const double duration_us : {3'600e6, 60e6, 1e6}) {
    const std::size_t nodes = summarise(times, series, 10.0, duration_us, columns);
    const auto per_column = static_cast<std::size_t>(duration_us * 1e-3) / kColumns + 1;
    const auto probes = static_cast<std::size_t>(2.0 * std::log2(static_cast<double>(per_column))) + 4;
    EXPECT_LE(nodes, kColumns * (Series::max_nodes(per_column) + probes) + 64) << duration_us;
    EXPECT_LT(nodes, 100 * kColumns) << duration_us;
  }
  EXPECT_LE(columns[kColumns / 2].samples, 1U);
}

}  // namespace
}  // namespace koboshi::studio
