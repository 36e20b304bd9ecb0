// Plays each motion of docs/reference/motions.md in ten worlds in each of two engines, and compares the
// number of successes with that of the page.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "sim_board/engine/mujoco/has_mujoco.h"
#include "tests/closed_loop/motion_library/library_trial.h"

namespace koboshi::test {
namespace {

constexpr std::uint64_t kWorlds = 10;

// The successes that the page's table states: "| nod | ... | 10 | 10 |", lumped and MuJoCo.
int stated(const std::string& trial, const std::string& stepper) {
  std::ifstream file(KOBOSHI_SOURCE_DIR "/docs/reference/motions.md");
  const std::regex row("\\| `?" + trial + "`? \\|.*\\| (\\d+) \\| (\\d+) \\|");
  std::string line;
  while (std::getline(file, line)) {
    std::smatch match;
    if (std::regex_match(line, match, row)) return std::stoi(match[stepper == "lumped" ? 1 : 2]);
  }
  ADD_FAILURE() << "the page has no row of " << trial;
  return 0;
}

class MotionLibraryInWorlds : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Motions, MotionLibraryInWorlds, testing::ValuesIn(library_trials()),
                         [](const auto& info) { return info.param; });

TEST_P(MotionLibraryInWorlds, SucceedsAsOftenAsThePageSays) {
  for (const std::string stepper : {"lumped", "mujoco"}) {
    if (stepper == "mujoco" && !sim_board::has_mujoco()) continue;
    int successes = 0;
    std::string failures;
    for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
      const LibraryOutcome outcome = play_library_trial(GetParam(), stepper, "mild", seed);
      if (outcome.failure.empty()) {
        ++successes;
      } else {
        failures += fmt::format("\nworld {}: {}", seed, outcome.failure);
      }
      if (std::getenv("KOBOSHI_MEASURED") != nullptr)
        fmt::print("{} {} {}: {} {}\n", GetParam(), stepper, seed, outcome.measured, outcome.failure);
    }
    EXPECT_EQ(successes, stated(GetParam(), stepper)) << stepper << failures;
  }
}

}  // namespace
}  // namespace koboshi::test
