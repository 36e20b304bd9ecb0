#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "sim_board/can/bus.h"
#include "sim_board/can/observer.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/scenario.h"
#include "studio/run/inbox.h"
#include "studio/run/snapshot_store.h"
#include "tools/run/pacer.h"
#include "view/capture/run_recording.h"

namespace koboshi::studio {

// An operator's input to a running simulation. It takes effect at the next millisecond.
using Input = std::variant<simulation::Command, simulation::Push, simulation::ParameterSetting,
                           simulation::Fault, simulation::ObjectRequest>;

// A node on the bus and its CAN controller.
struct NodeStatus {
  std::uint8_t node_id = 0;
  hal::CanStatus can{};
  sim_board::NodeCounters counters{};
  bool powered = true;
};

// State of a session.
struct SessionStatus {
  enum class State { kPaused, kRunning, kFailed };

  State state = State::kPaused;
  std::uint64_t time_us = 0;
  std::uint64_t duration_us = 0;  // of the scenario; a run may go on
  simulation::Telemetry said{};   // by the controller
  std::size_t snapshots = 0;
  std::size_t snapshot_bytes = 0;
  std::uint64_t snapshot_interval_us = 0;
  std::vector<NodeStatus> nodes{};  // updated ten times per simulated second
  double bus_load = 0.0;            // 0..1, over the last tenth of a second
  std::string message{};  // the last refused input or the error that stopped the run, one line; empty: none
};

// A simulation in a thread of its own, recorded from its start and rewindable to any moment. Functions return
// at once unless they say otherwise; the thread obeys in the order of the calls. The thread never waits for
// the caller.
//
// The same inputs at the same times give the same bits, also after rewinds.
class Session final : private sim_board::BusObserver {
 public:
  static constexpr double kUnpaced = 0.0;

  struct Options {
    std::size_t snapshot_budget_bytes = SnapshotStore::kDefaultBudget_bytes;
    tools::WallClock wall{};
  };

  // Reads and compiles the scenario's files; the run is paused at its start. Throws what
  // simulation::Simulation throws.
  explicit Session(const simulation::Scenario& scenario) : Session(scenario, Options()) {}
  Session(const simulation::Scenario& scenario, Options options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const simulation::Scenario& scenario() const { return scenario_; }
  // A recording without its samples, events, pushes and frames.
  const view::Recording& head() const { return head_; }
  const sim_board::RobotDescription& robot() const { return robot_; }

  // A run pauses by itself once, at the end of the scenario.
  void start();
  void pause();
  // Pauses and advances.
  void step(std::uint64_t milliseconds);
  // Simulated seconds per second of the wall clock, at most 100; kUnpaced: as fast as possible.
  void set_speed(double speed);
  // Returns to this moment, forgetting everything after it, also the inputs at that moment. The run goes on
  // from there as it did before, with other inputs. A later moment than the present changes nothing.
  void rewind(std::uint64_t time_us);
  // Input that a scenario could not contain changes nothing and sets the message.
  void give(Input input);

  [[nodiscard]] Batch take() { return inbox_.take(); }
  [[nodiscard]] SessionStatus status() const;
  // Returns when all earlier calls are obeyed and recorded.
  void wait();
  // Waits. Hash of all frames and of the state of the world at each tick, so far (RunRecorder::state_hash).
  [[nodiscard]] std::uint64_t state_hash();
  // Waits. Results of the run so far.
  [[nodiscard]] simulation::RunSummary summary();
  // Waits. The run so far, including the inputs, as a scenario.
  [[nodiscard]] simulation::Scenario played();

 private:
  using Job = std::function<void()>;
  // An input with the time at which it was given.
  struct GivenInput {
    std::uint64_t time_us;
    Input input;
  };

  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;
  void enqueue(Job job);
  // Enqueues a job and returns when it is done.
  void enqueue_and_wait(const Job& job);

  // In the thread.
  void run(const std::stop_token& stop);
  void obey(const Job& job);
  void advance();
  void pace();
  void apply(const Input& input);
  void begin_recording();
  void return_to(std::uint64_t time_us);
  void replay_to(std::uint64_t time_us);
  void publish();
  void publish_bus();
  void publish_events();

  const simulation::Scenario scenario_;
  const Options options_;
  Inbox inbox_;

  // State that only the thread uses once it runs:
  simulation::Simulation simulation_;
  std::optional<view::RunRecording> recording_;
  simulation::RunRecorder recorder_;
  SnapshotStore snapshots_;
  std::vector<GivenInput> inputs_;
  std::vector<view::Event> events_;  // as published
  sim_board::BusUsage usage_;        // at the last update of the nodes
  std::uint64_t samples_ = 0;        // recorded, also those that a rewind has taken back
  SessionStatus now_;
  double speed_ = 1.0;
  std::optional<tools::Pacer> pacer_;

  const view::Recording head_;
  const sim_board::RobotDescription robot_;

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::vector<Job> jobs_;
  SessionStatus status_;

  std::jthread thread_;  // last member: it uses the others
};

}  // namespace koboshi::studio
