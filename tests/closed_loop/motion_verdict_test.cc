// The verdict of `koboshi motion check` against the simulation: a short form of the comparison in
// docs/experiment/motion-check.md, which needs hundreds of motions.

#include <gtest/gtest.h>

#include <cstdint>

#include "tests/support/motion_trial.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::test {
namespace {

TEST(MotionVerdict, HoldsForMotionsThatAreNotClose) {
  const TemporaryFolder folder;
  tools::MotionChecker checker(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  int stable = 0;
  int unstable = 0;
  for (std::uint64_t seed = 20'026; seed <= 20'035; ++seed) {
    const Trial trial = run_trial(checker, folder.path, seed, {.stepper = "lumped"});
    if (trial.refused) continue;
    const bool called_unstable = trial.detected || trial.balance == tools::Balance::kUnstable;
    if (!called_unstable && trial.balance != tools::Balance::kStable) continue;
    ++(called_unstable ? unstable : stable);
    EXPECT_EQ(trial.fell, called_unstable) << "seed " << seed << ", margin " << trial.margin_mm << " mm";
  }
  EXPECT_GE(stable, 4);
  EXPECT_GE(unstable, 4);
}

}  // namespace
}  // namespace koboshi::test
