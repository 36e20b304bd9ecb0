#include "firmware/fixed/contract.h"

#include <gtest/gtest.h>

namespace koboshi::fixed {
namespace {

TEST(Contract, PassesWhenItHolds) { KOBOSHI_ASSERT(1 + 1 == 2); }

TEST(ContractDeathTest, EndsTheProgramWhenItIsViolated) {
  volatile int count = 3;
  EXPECT_DEATH(KOBOSHI_ASSERT(count < 3), "count < 3");
}

}  // namespace
}  // namespace koboshi::fixed
