#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim_board/can/observer.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/event_log.h"
#include "simulation/observe/ground_truth.h"
#include "simulation/observe/self_contact.h"
#include "simulation/observe/telemetry.h"
#include "simulation/observe/trace_table.h"
#include "simulation/observe/walk_observer.h"
#include "simulation/record/recorder.h"
#include "simulation/record/state_hash.h"
#include "simulation/record/summary.h"

namespace koboshi::simulation {

// Observes a simulation: every frame of its bus, and at each tick the state of firmware and world. Computes
// the state hash and the summary and, with a recorder, writes trace.csv and can.log.
class RunRecorder final : private sim_board::BusObserver, private Companion {
 public:
  enum class Rows {
    kForFiles,  // with a recorder
    kAlways,
  };

  // `recorder` and `listener` may be null. The listener receives every frame after this object. All arguments
  // must outlive this object.
  RunRecorder(Simulation& simulation, Recorder* recorder, sim_board::BusObserver* listener = nullptr,
              Rows rows = Rows::kForFiles);
  ~RunRecorder() {
    simulation_.board().electronics().bus().set_observer(nullptr);
    simulation_.detach(*this);
  }
  RunRecorder(const RunRecorder&) = delete;
  RunRecorder& operator=(const RunRecorder&) = delete;

  // Columns of trace.csv for this robot.
  static std::vector<TraceColumn> columns(const sim_board::RobotDescription& robot);

  // Observes a millisecond of the simulation, and a tick if there was one. Call it after each millisecond.
  void record();
  // Observes only the tick. In a walk this omits the check of the ankle sensors.
  void record_tick();
  // From the next tick on, makes rows or, without a recorder, makes none.
  void make_rows(bool make);
  // The last tick's row of the trace, in the order of columns(). Empty before the first tick, and without
  // rows.
  std::span<const TraceValue> row() const { return row_; }
  RunSummary summary() const;
  // Hash of all frames and of the state of the world at each tick, so far.
  std::uint64_t state_hash() const { return hash_.value(); }
  // Returns whether the trunk's lean has exceeded kFallen_rad.
  bool fell() const { return fell_; }

  const Telemetry& telemetry() const { return telemetry_.now(); }
  const GroundTruth& truth() const { return *truth_now_; }
  const WalkObserver& walk() const { return *walk_; }
  const EventLog& events() const { return events_; }
  EventLog& events() { return events_; }

 private:
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;
  void archive(sim_board::StateArchive& archive) override;
  void hash_state();
  void judge();
  void watch_self_contacts();
  void make_row();

  Simulation& simulation_;
  Recorder* recorder_;
  sim_board::BusObserver* listener_;
  TelemetryReader telemetry_;
  TruthObserver truth_;
  EventLog events_;
  SelfContacts self_contacts_;
  std::optional<WalkObserver> walk_;
  const GroundTruth* truth_now_ = nullptr;
  StateHash hash_;
  std::vector<TraceFields> trace_;  // empty without rows
  std::vector<TraceValue> row_;
  bool fell_ = false;
  double base_height_error_m_ = 0.0;  // maximum while the robot stands or moves on its feet
  double foot_slip_m_ = 0.0;
};

}  // namespace koboshi::simulation
