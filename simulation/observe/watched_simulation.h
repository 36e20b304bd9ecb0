#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim_board/can/observer.h"
#include "sim_board/scenario/scenario.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/simulation.h"

namespace koboshi::simulation {

// A frame as it stood on the bus.
struct BusFrame {
  std::uint64_t end_us = 0;  // after the last bit of EOF
  hal::CanFrame frame;
};

// A simulation together with what observes it: telemetry, ground truth, events, verdict, and, if wanted, the
// frames of its bus. What a program that only wants to run a robot needs.
class WatchedSimulation final : private sim::BusObserver {
 public:
  // Throws as Simulation does.
  explicit WatchedSimulation(const sim::Scenario& scenario, const HostFactory& make_host = in_process());
  WatchedSimulation(const WatchedSimulation&) = delete;
  WatchedSimulation& operator=(const WatchedSimulation&) = delete;

  // Steps by so many milliseconds, past the scenario's duration too. Throws sim::WorldBlewUp,
  // sim::SdoFailed, and what the host throws.
  void step(std::size_t milliseconds);

  // Begins anew with another seed (Simulation::reset), and observes from there.
  void reset(std::uint64_t seed);
  // As of Simulation, with what is observed. Kept frames are not in a snapshot: none remain after `restore`.
  Snapshot snapshot() { return simulation_.snapshot(); }
  void restore(const Snapshot& snapshot);

  Simulation& simulation() { return simulation_; }
  const Simulation& simulation() const { return simulation_; }
  const RunRecorder& recorder() const { return *recorder_; }
  std::uint64_t now_us() const { return simulation_.board().now_us(); }

  // Frames are kept from now on, or no longer. They are not kept at first.
  void keep_frames(bool keep) { keeps_frames_ = keep; }
  // The frames that were kept since the last call, in the order in which they ended.
  std::vector<BusFrame> take_frames();

 private:
  void observe();
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;

  Simulation simulation_;
  std::optional<RunRecorder> recorder_;
  bool keeps_frames_ = false;
  std::vector<BusFrame> frames_;
};

}  // namespace koboshi::simulation
