#include "lab/tune/lost_trials.h"

#include <gtest/gtest.h>

namespace koboshi::lab {
namespace {

TEST(LostTrials, SaysNothingWhereNoneWasLost) {
  LostTrials trials;
  trials.add({});
  EXPECT_EQ(trials.text(), "");
}

TEST(LostTrials, CountsTheReasonsAndKeepsTheFirstError) {
  LostTrials trials;
  trials.add({});
  trials.add({.outcome = Outcome::kFell});
  trials.add({.outcome = Outcome::kEnergyGuard, .error = "the world gained energy\nat 0.1 s"});
  trials.add({.outcome = Outcome::kEnergyGuard, .error = "again"});
  trials.add({.outcome = Outcome::kFailed, .error = "lost"});
  EXPECT_EQ(trials.text(),
            "4 of 5 trials were lost: 1 falls, 2 energy guard, 1 failed; the first error: the world gained "
            "energy at 0.1 s\n");
}

}  // namespace
}  // namespace koboshi::lab
