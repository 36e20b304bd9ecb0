#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sim_board/can/observer.h"
#include "simulation/assembly/board_without_controller.h"
#include "simulation/assembly/simulation.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/record/background_writer.h"
#include "simulation/record/summary.h"
#include "view/recording/listener.h"
#include "view/recording/recording_file.h"

namespace koboshi::view {

// The recording of a simulation without its samples, events, pushes and frames.
[[nodiscard]] Recording recording_head(const simulation::Simulation& simulation);
[[nodiscard]] Recording recording_head(const simulation::BoardWithoutController& board);

// Records a simulation into run.mcap, or for a listener, or both. It observes from outside: frames as the
// listener of a RunRecorder, and after each millisecond the world, the row of the trace, events and pushes. A
// step copies a few kilobytes into a ring; a thread makes messages of them, compresses and writes them. Times
// are those of the simulation, so the same run gives the same bytes.
class RunRecording final : public sim_board::BusObserver {
 public:
  struct Options {
    // Time between samples, a divisor of a tick. Samples between two ticks have the values of the trace at
    // the tick before, but the true joint positions of their own.
    std::uint64_t period_us = sim_board::SimBoard::kTick_us;
    simulation::WhenFull when_full = simulation::WhenFull::kWait;
    // Receives the samples at ticks and everything else, in the thread that writes. May be null; outlives
    // this object.
    RecordingListener* listener = nullptr;
  };

  // Without the name of a file, records for the listener only. The simulation must outlive this object.
  // Throws WriteError.
  RunRecording(const std::filesystem::path& file, const simulation::Simulation& simulation,
               const Options& options);
  // Records a board without controller for a listener, and drops what it is too slow for. Its signals are
  // the true place of the base link and the true joint positions.
  RunRecording(const simulation::BoardWithoutController& board, RecordingListener& listener);

  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;
  // Records a millisecond, after `recorder` has; it must write a trace. Throws WriteError after a failed
  // write.
  void record(const simulation::RunRecorder& recorder);
  // Records a millisecond of a board without controller.
  void record();
  // Completes the file. `events` are those of the whole run. Throws WriteError.
  void close(std::span<const simulation::RunEvent> events);

  // Number of samples, frames, events and pushes lost because the ring was full.
  std::uint64_t dropped() const { return writer_.dropped(); }
  // Sentences about meshes of the robot that cannot be shown.
  const std::vector<std::string>& mesh_faults() const { return mesh_faults_; }

 private:
  struct TrueJoint {
    int joint;
    std::size_t signal;  // its position's column
  };

  // `head` is a recording without its samples, events, pushes and frames.
  RunRecording(const std::filesystem::path& file, const Recording& head, const sim_board::SimBoard& board,
               const sim_board::RobotDescription& robot,
               std::function<const std::vector<simulation::Push>&()> pushes, const Options& options);

  void record_true_joints();
  void record_sample(std::uint64_t now_us);
  void record_events(std::uint64_t until_us, std::span<const simulation::RunEvent> events);
  void record_pushes(std::uint64_t now_us);
  void write(const simulation::Ring::Record& record);
  void write_sample(std::span<const std::byte> bytes);
  void add(const Event& event);

  std::vector<std::string> mesh_faults_;
  const sim_board::SimBoard& board_;
  const sim_board::RobotDescription& robot_;
  const std::function<const std::vector<simulation::Push>&()> pushes_;
  const std::uint64_t period_us_;
  std::vector<TrueJoint> true_joints_;
  std::vector<float> values_;                   // of the last tick
  std::size_t next_event_ = 0;                  // of EventLog::so_far
  std::vector<simulation::RunEvent> recorded_;  // events, without their fields
  std::size_t next_push_ = 0;

  // State that only the thread uses:
  std::vector<Pose> links_;
  std::vector<ContactForce> contacts_;
  std::vector<float> sample_values_;

  std::optional<RecordingFile> file_;
  RecordingListener* const listener_;
  simulation::BackgroundWriter writer_;  // last member: its thread uses the others
};

}  // namespace koboshi::view
