// Compares the verdict of `koboshi motion check` with simulated falls of random slow motions:
//   motion_check_trials FIRST_SEED COUNT STEPPER [THREADS [STEP_MS]]
// prints a line for each motion and the table of docs/experiment/motion-check.md. STEPPER is one of
// world, lumped, mujoco, or none: then nothing is simulated. STEP_MS is the time step of the
// physics, 1 by default.

#include <fmt/core.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/motion_trial.h"
#include "tests/support/temporary_folder.h"
#include "tools/motion_check/check.h"

namespace koboshi {
namespace {

int run(std::uint64_t first_seed, int count, const test::Physics& physics, int threads) {
  const test::TemporaryFolder folder;
  std::vector<test::Trial> trials(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  std::vector<std::thread> workers;
  for (int i = 0; i < threads; ++i) {
    workers.emplace_back([&] {
      tools::MotionChecker checker(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
      for (int n = next++; n < count; n = next++) {
        const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(n);
        trials[static_cast<std::size_t>(n)] = test::run_trial(checker, folder.path, seed, physics);
      }
    });
  }
  for (std::thread& worker : workers) worker.join();
  std::array<std::array<int, 2>, 4> counts{};
  int refused = 0;
  for (std::size_t n = 0; n < trials.size(); ++n) {
    const test::Trial& trial = trials[n];
    const auto called = trial.detected ? tools::Balance::kUnstable : trial.balance;
    if (trial.refused) {
      ++refused;
      continue;
    }
    ++counts[static_cast<std::size_t>(called)][trial.fell ? 1 : 0];
    fmt::print("{} {} margin {:.1f} mm{}: {}\n", first_seed + n,
               tools::kBalanceNames[static_cast<std::size_t>(called)], trial.margin_mm,
               trial.detected ? ", fall detector" : "", trial.fell ? "fell" : "stood");
  }
  fmt::print("\n| called | motions | stood | fell |\n| --- | --- | --- | --- |\n");
  for (const std::size_t called : {1U, 2U, 3U})
    fmt::print("| {} | {} | {} | {} |\n", tools::kBalanceNames[called], counts[called][0] + counts[called][1],
               counts[called][0], counts[called][1]);
  fmt::print("{} more were refused for reach, speed, torque or collision\n", refused);
  return 0;
}

}  // namespace
}  // namespace koboshi

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "motion_check_trials FIRST_SEED COUNT STEPPER [THREADS [STEP_MS]]\n");
    return 2;
  }
  const koboshi::test::Physics physics{.stepper = argv[3], .step_ms = argc > 5 ? std::atof(argv[5]) : 1.0};
  return koboshi::run(std::strtoull(argv[1], nullptr, 10), std::atoi(argv[2]), physics,
                      argc > 4 ? std::atoi(argv[4]) : 1);
}
