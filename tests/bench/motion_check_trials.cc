// Compares the verdict of `koboshi motion check` with simulated falls of random slow motions:
//   motion_check_trials FIRST_SEED COUNT STEPPER [THREADS [STEP_MS]]
// prints a line for each motion and the table of docs/experiment/motion-check.md. STEPPER is one of
// world, lumped, quick, mujoco, or none: then nothing is simulated. STEP_MS is the time step of the
// physics, 1 by default.

#include <fmt/core.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "sim_board/scenario/reader.h"
#include "simulation/motion/diagnostic.h"
#include "simulation/observe/watched_simulation.h"
#include "tests/support/random_motion.h"
#include "tests/support/temporary_folder.h"
#include "tools/motion/check/check.h"

namespace koboshi {
namespace {

// The physics of the simulated trials.
struct Physics {
  std::string stepper;
  double step_ms = 1.0;
};

struct Trial {
  tools::Balance balance = tools::Balance::kNotJudged;
  double margin_mm = 0.0;
  bool detected = false;  // by the check's fall detector
  bool refused = false;   // for another error than balance
  bool fell = false;
};

constexpr double kAfter_s = 2.0;  // a robot that tips slowly falls within this time

bool falls(const std::filesystem::path& motion, const Physics& physics, double duration_s) {
  const std::filesystem::path scenario = motion.parent_path() / (motion.stem().string() + "_scenario.yaml");
  const double end_s = test::kTrialPlay_s + duration_s + kAfter_s;
  std::ofstream(scenario) << test::trial_scenario(motion, physics.stepper, end_s, physics.step_ms);
  simulation::WatchedSimulation run(sim::read_scenario(scenario));
  const auto end_us = static_cast<std::uint64_t>(1e6 * end_s);
  while (run.now_us() < end_us && !run.recorder().fell()) run.step(10);
  const simulation::EventLog& events = run.recorder().events();
  if (events.verdict().find("refused") != std::string::npos) throw std::runtime_error(events.verdict());
  return run.recorder().fell() || events.falls() > 0 || !events.stands();
}

Trial run_trial(tools::MotionChecker& checker, const std::filesystem::path& folder, std::uint64_t seed,
                const Physics& physics) {
  const std::filesystem::path file = folder / fmt::format("trial_{}.yaml", seed);
  std::ofstream(file) << test::random_motion(seed);
  Trial trial;
  tools::MotionReport report;
  try {
    report = checker.check(file);
  } catch (const simulation::MotionError&) {  // a target out of reach
    trial.refused = true;
    return trial;
  }
  trial.balance = report.balance;
  trial.margin_mm = 1e3 * report.least_margin_m;
  for (const simulation::Diagnostic& diagnostic : report.diagnostics) {
    trial.detected = trial.detected || diagnostic.code == "C009";
    trial.refused = trial.refused || (diagnostic.severity == simulation::Severity::kError &&
                                      diagnostic.code != "C006" && diagnostic.code != "C009");
  }
  if (!trial.refused && physics.stepper != "none") trial.fell = falls(file, physics, report.duration_s);
  return trial;
}

int run(std::uint64_t first_seed, int count, const Physics& physics, int threads) {
  const test::TemporaryFolder folder;
  std::vector<Trial> trials(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  std::vector<std::thread> workers;
  for (int i = 0; i < threads; ++i) {
    workers.emplace_back([&] {
      tools::MotionChecker checker(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
      for (int n = next++; n < count; n = next++) {
        const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(n);
        trials[static_cast<std::size_t>(n)] = run_trial(checker, folder.path, seed, physics);
      }
    });
  }
  for (std::thread& worker : workers) worker.join();
  std::array<std::array<int, 2>, 4> counts{};
  int refused = 0;
  for (std::size_t n = 0; n < trials.size(); ++n) {
    const Trial& trial = trials[n];
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
  const koboshi::Physics physics{.stepper = argv[3], .step_ms = argc > 5 ? std::atof(argv[5]) : 1.0};
  return koboshi::run(std::strtoull(argv[1], nullptr, 10), std::atoi(argv[2]), physics,
                      argc > 4 ? std::atoi(argv[4]) : 1);
}
