// The motions of docs/reference/motions.md reach what their page promises.

#include <gtest/gtest.h>

#include "tests/closed_loop/motion_library/library_trial.h"

namespace koboshi::test {
namespace {

class MotionLibrary : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Motions, MotionLibrary, testing::ValuesIn(library_trials()),
                         [](const auto& info) { return info.param; });

// The longer form, ten worlds in two engines, is motion_library_worlds.cc.
TEST_P(MotionLibrary, MeetsItsCriterion) {
  const LibraryOutcome outcome = play_library_trial(GetParam(), "lumped", "mild", 1);
  EXPECT_EQ(outcome.failure, "") << outcome.measured;
}

}  // namespace
}  // namespace koboshi::test
