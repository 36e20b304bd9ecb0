#include "tests/support/motion_trial.h"

#include <fmt/core.h>

#include <fstream>
#include <stdexcept>

#include "simulation/motion_language/parse/diagnostic.h"
#include "simulation/observe/watched_simulation.h"
#include "simulation/scenario/reader.h"
#include "tests/support/random_motion.h"

namespace koboshi::test {
namespace {

constexpr double kAfter_s = 2.0;  // a robot that tips slowly falls within this time

bool falls(const std::filesystem::path& motion, const Physics& physics, double duration_s) {
  const std::filesystem::path scenario = motion.parent_path() / (motion.stem().string() + "_scenario.yaml");
  const double end_s = kTrialPlay_s + duration_s + kAfter_s;
  std::ofstream(scenario) << trial_scenario(motion, physics.stepper, end_s, physics.step_ms);
  simulation::WatchedSimulation run(simulation::read_scenario(scenario));
  const auto end_us = static_cast<std::uint64_t>(1e6 * end_s);
  while (run.now_us() < end_us && !run.recorder().fell()) run.step(10);
  const simulation::EventLog& events = run.recorder().events();
  if (events.verdict().find("refused") != std::string::npos) throw std::runtime_error(events.verdict());
  return run.recorder().fell() || events.falls() > 0 || !events.stands();
}

}  // namespace

Trial run_trial(tools::MotionChecker& checker, const std::filesystem::path& folder, std::uint64_t seed,
                const Physics& physics) {
  const std::filesystem::path file = folder / fmt::format("trial_{}.yaml", seed);
  std::ofstream(file) << random_motion(seed);
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

}  // namespace koboshi::test
