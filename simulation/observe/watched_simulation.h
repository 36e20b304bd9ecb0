#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sim_board/can/observer.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// A frame on the bus.
struct BusFrame {
  std::uint64_t end_us = 0;  // end of the last bit of EOF
  hal::CanFrame frame;
};

// A simulation with its observers: telemetry, ground truth, events, verdict and, on request, the frames of
// its bus. Sufficient for programs that only run a robot.
class WatchedSimulation final : private sim_board::BusObserver {
 public:
  // Throws as Simulation does.
  explicit WatchedSimulation(const Scenario& scenario, const HostFactory& make_host = in_process());
  WatchedSimulation(std::shared_ptr<const PreparedScenario> prepared, std::uint64_t seed);
  WatchedSimulation(const WatchedSimulation&) = delete;
  WatchedSimulation& operator=(const WatchedSimulation&) = delete;

  // Advances by this many milliseconds, also beyond the scenario's duration. Throws sim_board::WorldBlewUp,
  // SdoFailed, and what the host throws.
  void step(std::size_t milliseconds);

  // Restarts simulation and observers with another seed (Simulation::reset).
  void reset(std::uint64_t seed);
  // As in Simulation, including the observers. Kept frames are not part of a snapshot: `restore` discards
  // them.
  Snapshot snapshot() { return simulation_.snapshot(); }
  void restore(const Snapshot& snapshot);

  Simulation& simulation() { return simulation_; }
  const Simulation& simulation() const { return simulation_; }
  const RunRecorder& recorder() const { return *recorder_; }
  std::uint64_t now_us() const { return simulation_.board().now_us(); }

  // Switches the keeping of rows of the trace on or off. Initially off; a reset switches it off. Discards
  // rows kept so far.
  void keep_rows(bool keep);
  // Returns the rows kept since the last call, one for each tick: the time in seconds and the cells of
  // RunRecorder::columns().
  std::vector<double> take_rows();
  // Switches the keeping of frames on or off. Initially off.
  void keep_frames(bool keep) { keeps_frames_ = keep; }
  // Returns the frames kept since the last call, in order of their end.
  std::vector<BusFrame> take_frames();

 private:
  void observe();
  void keep_row();
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;

  Simulation simulation_;
  std::optional<RunRecorder> recorder_;
  bool keeps_rows_ = false;
  std::vector<double> rows_;
  bool keeps_frames_ = false;
  std::vector<BusFrame> frames_;
};

}  // namespace koboshi::simulation
