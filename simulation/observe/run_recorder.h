#pragma once

#include <optional>
#include <vector>

#include "sim_board/can/observer.h"
#include "sim_board/record/recorder.h"
#include "sim_board/record/state_hash.h"
#include "sim_board/record/summary.h"
#include "simulation/observe/event_log.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/telemetry.h"
#include "simulation/observe/walk_observer.h"
#include "simulation/scenario/simulation.h"

namespace koboshi::simulation {

// Watches a simulation: every frame of its bus, and once a tick the state of firmware and world. Makes of it
// the state hash, the summary and, if given a recorder, trace.csv and can.log.
class RunRecorder final : private sim::BusObserver, private Companion {
 public:
  // `recorder` may be null, and so may `listener`, which hears every frame after this has. All must outlive
  // this.
  RunRecorder(Simulation& simulation, sim::Recorder* recorder, sim::BusObserver* listener = nullptr);
  ~RunRecorder() {
    simulation_.board().bus().set_observer(nullptr);
    simulation_.detach(*this);
  }
  RunRecorder(const RunRecorder&) = delete;
  RunRecorder& operator=(const RunRecorder&) = delete;

  // The columns of trace.csv for this robot.
  static std::vector<sim::TraceColumn> columns(const sim::RobotDescription& robot);

  // After each millisecond of the simulation: what is observed then, and after each tick the tick.
  void record();
  // A tick alone; of a walk, the check of the ankle sensors is missing then.
  void record_tick();
  sim::RunSummary summary() const;
  // Of all frames, and of the world at each tick, so far.
  std::uint64_t state_hash() const { return hash_.value(); }
  // Whether the trunk has leaned further than a robot comes back from.
  bool fell() const { return fell_; }

  const Telemetry& telemetry() const { return telemetry_.now(); }
  const GroundTruth& truth() const { return *truth_now_; }
  const WalkObserver& walk() const { return *walk_; }
  const EventLog& events() const { return events_; }
  EventLog& events() { return events_; }

 private:
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;
  void archive(sim::StateArchive& archive) override;
  void hash_state();
  void judge();
  void write_row();
  void add_feet_to_row();
  void add_zmp_to_row();

  Simulation& simulation_;
  sim::Recorder* recorder_;
  sim::BusObserver* listener_;
  TelemetryReader telemetry_;
  TruthObserver truth_;
  EventLog events_;
  std::optional<WalkObserver> walk_;
  const GroundTruth* truth_now_ = nullptr;
  sim::StateHash hash_;
  std::vector<sim::TraceValue> row_;
  bool fell_ = false;
  double base_height_error_m_ = 0.0;  // largest, while the robot stands or moves on its own feet
  double foot_slip_m_ = 0.0;
};

}  // namespace koboshi::simulation
