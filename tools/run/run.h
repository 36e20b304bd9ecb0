#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/scenario.h"
#include "tools/run/live_link.h"
#include "view/live/live_view.h"

namespace koboshi::tools {

// An operator who commands a running simulation.
class RunOperator {
 public:
  virtual ~RunOperator() = default;

  // Called after each tick of the simulation. Returns false to end the run.
  virtual bool tick() = 0;
};

// All of them outlive the operator.
using OperatorFactory = std::function<std::unique_ptr<RunOperator>(
    simulation::Simulation&, const simulation::RunRecorder&, const LiveLink&)>;

struct RunOptions {
  simulation::Scenario scenario;
  std::filesystem::path out;                                     // the folder of the results
  simulation::HostFactory make_host = simulation::in_process();  // where the firmware runs
  simulation::RobotChange change{};                              // of the robot in the world
  LiveOptions live{};
  std::function<void(const LiveLink&)> ready{};  // called when the bus can be reached from outside
  LiveLink::Warn warn{};                         // receives warnings while it runs; may be empty
  OperatorFactory make_operator{};               // may be empty
  // Time between the samples of the recording, run.mcap; a divisor of a tick. Zero: no recording.
  std::uint64_t recording_period_us = 0;
  // Shows the run in browsers; may be null, and outlives the run, which starts and closes it.
  view::LiveView* view = nullptr;
};

// Progress of a run.
struct RunProgress {
  double simulated_s = 0.0;
  double duration_s = 0.0;
  double wall_s = 0.0;
};

struct RunResult {
  simulation::RunSummary summary;
  // The error that ended the run early, such as a simulation that diverged or a fault of the firmware.
  std::optional<std::string> failure;
  nlohmann::ordered_json live;              // LiveLink::report
  std::optional<std::string> plot_warning;  // which figures are missing, and why
};

// `koboshi run`: plays a scenario, as fast as possible or in real time. Writes trace.csv, can.log,
// events.txt, timing.json, figures and, if asked for, run.mcap into the folder, after an operator also
// played.yaml, and last summary.json, whose presence means that all files are complete. Locks the folder
// meanwhile. Throws InputError for bad input, before anything is written. A run that ends early keeps
// its records: after an error, after WriteError, and after SIGINT or SIGTERM, which throw Interrupted.
// In real time these signals end the run normally.
RunResult run(const RunOptions& options, const std::function<void(const RunProgress&)>& progress);

}  // namespace koboshi::tools
