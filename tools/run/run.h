#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "sim_board/record/summary.h"
#include "sim_board/scenario/scenario.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/simulation.h"
#include "tools/run/live_link.h"

namespace koboshi::tools {

// Takes part in a run as long as it lives.
class RunOperator {
 public:
  virtual ~RunOperator() = default;

  // After each tick of the simulation, which it may command. False ends the run.
  virtual bool tick() = 0;
};

// All of them outlive the operator.
using OperatorFactory = std::function<std::unique_ptr<RunOperator>(
    simulation::Simulation&, const simulation::RunRecorder&, const LiveLink&)>;

struct RunOptions {
  sim::Scenario scenario;
  std::filesystem::path out;                                     // the folder of the results
  simulation::HostFactory make_host = simulation::in_process();  // where the firmware runs
  simulation::RobotChange change{};                              // of the robot in the world
  LiveOptions live{};
  std::function<void(const LiveLink&)> ready{};  // told when the bus can be reached from outside
  LiveLink::Warn warn{};                         // while it runs; nobody is told, without
  OperatorFactory make_operator{};               // nobody, without
};

// How far a run has come, told now and then.
struct RunProgress {
  double simulated_s = 0.0;
  double duration_s = 0.0;
  double wall_s = 0.0;
};

struct RunResult {
  sim::RunSummary summary;
  std::optional<std::string>
      failure;  // what ended the run before its time, such as a world that blew up or a firmware that faulted
  nlohmann::ordered_json live;              // LiveLink::report
  std::optional<std::string> plot_warning;  // why there are no figures
};

// `koboshi run`: plays a scenario, as fast as it goes or by the clock on the wall, and leaves trace.csv,
// can.log, events.txt, timing.json and figures in the folder; after an operator also played.yaml; and last
// summary.json, which says that the run came to its end and all files are complete. The folder is locked
// meanwhile. Bad input throws sim::InputError before anything is written. A run that fails half-way keeps
// what it has recorded, as do one that cannot write any more, which throws sim::WriteError, and one that
// SIGINT or SIGTERM ended, which throws Interrupted; a run by the clock on the wall ends by these signals in
// the ordinary way.
RunResult run(const RunOptions& options, const std::function<void(const RunProgress&)>& progress);

}  // namespace koboshi::tools
