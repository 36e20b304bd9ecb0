#include "tools/target/target_report.h"

#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "base/text/error.h"

namespace koboshi::tools {
namespace {

TEST(Distribution, FindsThe99thPercentile) {
  std::vector<std::uint64_t> values(200);
  std::iota(values.rbegin(), values.rend(), std::uint64_t{1});
  const Distribution found = distribution(values);
  EXPECT_EQ(found.p99, 198u);
  EXPECT_EQ(found.max, 200u);
  EXPECT_DOUBLE_EQ(found.mean, 100.5);
}

TEST(Distribution, OfOneValueIsThatValue) {
  const Distribution found = distribution({7});
  EXPECT_EQ(found.p99, 7u);
  EXPECT_EQ(found.max, 7u);
  EXPECT_DOUBLE_EQ(found.mean, 7.0);
}

TEST(Distribution, RejectsAnEmptySample) {
  EXPECT_THROW(static_cast<void>(distribution({})), std::invalid_argument);
}

TEST(TargetReport, RequiresTheDescriptionOfTheImage) {
  EXPECT_THROW(static_cast<void>(measure_target({}, "no/such.elf")), InputError);
}

}  // namespace
}  // namespace koboshi::tools
