#include <gtest/gtest.h>

#include "tests/unit/firmware/policy/sample_policy.h"

namespace koboshi::policy {
namespace {

// The Cortex-M4 must give the same (tests/target/policy_test.py).
TEST(SameBits, OfPolicies) {
  static test::SamplePolicies samples;
  for (std::size_t i = 0; i < test::kSampleShapes.size(); ++i) ASSERT_TRUE(samples.open(i)) << i;
  EXPECT_EQ(test::digest_of(samples), test::kSampleDigest);
}

}  // namespace
}  // namespace koboshi::policy
