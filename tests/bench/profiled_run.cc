// One recorded run of a scenario, for a profiler: the loop of `koboshi run` without the program around it,
// whose libraries valgrind cannot start. tools/dev/profile.py reads the profile.
//
//   profiled_run SCENARIO STEPPER FROM_SECONDS SIMULATED_SECONDS OUTPUT_FOLDER
//
// Profile and recording begin at FROM_SECONDS, because a walk begins with seconds on a stand.

#include <fmt/core.h>

#include <cstdint>
#include <cstdlib>
#include <exception>

#include "base/file/output_folder.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/reader.h"

namespace {

using namespace koboshi;

// The functions whose cost is profiled. Neither may be inlined: callgrind counts by their names.
[[gnu::noinline]] void profiled_advance(simulation::Simulation& simulation) { simulation.advance(); }
[[gnu::noinline]] void profiled_record(simulation::RunRecorder& recorder) { recorder.record(); }

std::uint64_t play(const simulation::Scenario& scenario, std::uint64_t from_us, const char* folder) {
  simulation::Simulation simulation(scenario);
  while (simulation.board().now_us() < from_us) simulation.advance();
  const OutputFolder out(folder);
  simulation::Recorder files(folder, simulation::RunRecorder::columns(simulation.robot()),
                             simulation::WhenFull::kWait);
  simulation::RunRecorder recorder(simulation, &files);
  while (!simulation.finished()) {
    profiled_advance(simulation);
    profiled_record(recorder);
  }
  files.close();
  return recorder.state_hash();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    fmt::print(stderr, "usage: profiled_run SCENARIO STEPPER FROM_SECONDS SIMULATED_SECONDS OUTPUT_FOLDER\n");
    return 2;
  }
  try {
    simulation::Scenario scenario = simulation::read_scenario(argv[1]);
    const auto stepper = sim_board::stepper_named(argv[2]);
    if (!stepper) throw std::runtime_error(fmt::format("no stepper is named {}", argv[2]));
    scenario.physics.stepper = *stepper;
    const double from_s = std::atof(argv[3]);
    scenario.duration_us = static_cast<std::uint64_t>(1e6 * (from_s + std::atof(argv[4])));
    fmt::print("state {:016x}\n", play(scenario, static_cast<std::uint64_t>(1e6 * from_s), argv[5]));
  } catch (const std::exception& error) {
    fmt::print(stderr, "profiled_run: {}\n", error.what());
    return 2;
  }
}
