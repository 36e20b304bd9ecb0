// The validations of `koboshi validate` in their short form: the simulated physics agrees with theory.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "lab/validate/report.h"

namespace koboshi::tools {

void PrintTo(const lab::Validation& validation, std::ostream* out) { *out << validation.name; }

namespace {

class Physics : public testing::TestWithParam<lab::Validation> {};

TEST_P(Physics, AgreesWithTheory) {
  const lab::ValidationSetup setup{.short_form = true,
                                   .scenario = KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml"};
  const lab::ValidationResult result = lab::play(GetParam(), setup);
  ASSERT_FALSE(result.findings.checks.empty());
  double largest_error = 0.0;
  for (const lab::Check& check : result.findings.checks) {
    EXPECT_TRUE(check.passed()) << check.quantity << ": theory " << check.theory << ", simulated "
                                << check.simulated << ", tolerance " << check.tolerance << " " << check.unit;
    largest_error = std::max(largest_error, std::abs(check.error()));
  }
  // No simulation is exact: without any error, a theory would be compared with itself.
  EXPECT_GT(largest_error, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Validate, Physics, testing::ValuesIn(lab::all_validations()),
                         [](const testing::TestParamInfo<lab::Validation>& tested) {
                           std::string name = tested.param.name;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace koboshi::tools
