#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "sim_board/can/observer.h"
#include "sim_board/record/background_writer.h"
#include "sim_board/record/summary.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/simulation.h"
#include "tools/view/recording/recording_file.h"

namespace koboshi::view {

// Records a simulation into run.mcap. It observes from outside: frames as the listener of a RunRecorder, and
// after each millisecond the world, the row of the trace, events and pushes. A step copies a few kilobytes
// into a ring; a thread makes messages of them, compresses and writes them. Times are those of the
// simulation, so the same run gives the same bytes.
class RunRecording final : public sim::BusObserver {
 public:
  struct Options {
    // Time between samples, a divisor of a tick. Samples between two ticks have the values of the trace at
    // the tick before, but the true joint positions of their own.
    std::uint64_t period_us = sim::SimBoard::kTick_us;
    sim::WhenFull when_full = sim::WhenFull::kWait;
  };

  // The simulation must outlive this object. Throws sim::WriteError.
  RunRecording(const std::filesystem::path& file, const simulation::Simulation& simulation,
               const Options& options);

  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t end_us) override;
  // Records a millisecond, after `recorder` has; it must write a trace. Throws sim::WriteError after a failed
  // write.
  void record(const simulation::RunRecorder& recorder);
  // Completes the file. `events` are those of the whole run. Throws sim::WriteError.
  void close(std::span<const sim::RunEvent> events);

  // Number of samples, frames, events and pushes lost because the ring was full.
  std::uint64_t dropped() const { return writer_.dropped(); }

 private:
  // `head` is a recording without its samples, events, pushes and frames.
  RunRecording(const std::filesystem::path& file, const simulation::Simulation& simulation,
               const Options& options, const Recording& head);

  struct TrueJoint {
    int joint;
    std::size_t signal;  // its position's column
  };

  void record_sample(std::uint64_t now_us, std::span<const sim::TraceValue> row, bool is_tick);
  void record_events(std::uint64_t until_us, std::span<const sim::RunEvent> events);
  void record_pushes(std::uint64_t now_us);
  void write(const sim::Ring::Record& record);
  void write_sample(std::span<const std::byte> bytes);

  const simulation::Simulation& simulation_;
  const std::uint64_t period_us_;
  std::vector<TrueJoint> true_joints_;
  std::vector<float> values_;            // of the last tick
  std::size_t next_event_ = 0;           // of EventLog::so_far
  std::vector<sim::RunEvent> recorded_;  // events, without their fields
  std::size_t next_push_ = 0;

  // Of the thread.
  std::vector<Pose> links_;
  std::vector<ContactForce> contacts_;
  std::vector<float> sample_values_;

  RecordingFile file_;
  sim::BackgroundWriter writer_;  // last member: its thread uses the others
};

}  // namespace koboshi::view
