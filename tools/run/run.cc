#include "tools/run/run.h"

#include <chrono>

#include <fmt/core.h>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "bus/dictionary/network.h"
#include "simulation/observe/run_recorder.h"
#include "simulation/scenario/events_text.h"
#include "tools/run/run_figures.h"
#include "tools/run/walk_figures.h"
#include "view/capture/run_recording.h"

namespace koboshi::tools {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Times that depend on the machine, for a file of their own.
nlohmann::ordered_json timing_json(const sim_board::SimBoard& board, double wall_s, std::uint64_t dropped,
                                   std::uint64_t recording_dropped, const LiveLink& live) {
  const double simulated_s = 1e-6 * static_cast<double>(board.now_us());
  const sim_board::TimeShares& shares = board.time_shares();
  const double parts_s =
      shares.bus_s + shares.drives_s + shares.firmware_s + shares.physics_s + shares.sensors_s;
  return {{"real_time_factor", simulated_s / wall_s},
          {"wall_s", wall_s},
          {"shares",
           {{"physics", shares.physics_s / wall_s},
            {"bus", shares.bus_s / wall_s},
            {"drives", shares.drives_s / wall_s},
            {"firmware", shares.firmware_s / wall_s},
            {"sensors", shares.sensors_s / wall_s},
            {"recording_and_rest", 1.0 - parts_s / wall_s}}},
          {"records_dropped", dropped},
          {"recording_dropped", recording_dropped},
          {"live", live.report()}};
}

// The reason of an early end; empty at the end of the scenario, or when the operator ends the run.
struct Ending {
  std::optional<std::string> failure{};  // the error
  std::optional<int> signal{};
};

Ending play(simulation::Simulation& simulation, simulation::RunRecorder& recorder,
            view::RunRecording* recording, view::LiveView* view, LiveLink& live, ShownTrace& trace,
            const OperatorFactory& make_operator, const std::function<void(const RunProgress&)>& progress) {
  constexpr std::uint64_t kTick_us = sim_board::SimBoard::kTick_us;
  const auto start = Clock::now();
  const double duration_s = 1e-6 * static_cast<double>(simulation.scenario().duration_us);
  try {
    const auto run_operator = make_operator ? make_operator(simulation, recorder, live) : nullptr;
    while (!simulation.finished()) {
      if (const auto signal = live.interrupted()) return {.signal = signal};
      live.before(simulation.board().now_us());
      simulation.advance();
      const std::uint64_t now_us = simulation.board().now_us();
      recorder.record();
      if (recording != nullptr) recording->record(recorder);
      live.after(now_us);
      if (now_us % kTick_us != 0) continue;
      trace.add(now_us, recorder.row());
      if (view != nullptr) view->set_dropped(recording->dropped());
      if (run_operator && !run_operator->tick()) break;
      if (progress) progress({1e-6 * static_cast<double>(now_us), duration_s, seconds_since(start)});
    }
  } catch (const WriteError&) {
    throw;
  } catch (const std::runtime_error& error) {
    return {.failure = error.what()};
  }
  return {};
}

// Returns which figures are left out, and why; empty: none.
[[nodiscard]] std::string draw_figures(const simulation::Simulation& simulation, const Columns& trace,
                                       const std::filesystem::path& folder) {
  const simulation::Scenario played = simulation.played();
  draw_run_figures(played, trace, folder);
  const simulation::GaitPlan* plan = simulation.gait_plan();
  return draw_walk_figures(trace, simulation.robot(), plan ? plan->cycle_s() : commanded_cycle_s(played),
                           folder);
}

void add_ending(const Ending& ending, const simulation::Simulation& simulation, simulation::EventLog& events,
                bool is_live) {
  const std::uint64_t now_us = simulation.board().now_us();
  if (ending.failure) events.add(now_us, "error", "An error ends the run: " + *ending.failure + ".");
  if (!ending.signal) return;
  events.add(now_us, "interrupted", is_live ? "The user ends the run." : "The run is interrupted.",
             {{"signal", *ending.signal}});
}

// Also as events, so that the recording says it.
void report_mesh_faults(const view::RunRecording& recording, simulation::EventLog& events,
                        const std::function<void(const std::string&)>& warn) {
  for (const std::string& fault : recording.mesh_faults()) {
    events.add(0, "mesh", fault);
    if (warn) warn(fault);
  }
}

std::string how_far(const simulation::Simulation& simulation, const std::filesystem::path& folder) {
  return fmt::format("interrupted at {:.2f} s of {:.2f} s; what was recorded is in {}, without summary.json",
                     1e-6 * static_cast<double>(simulation.board().now_us()),
                     1e-6 * static_cast<double>(simulation.scenario().duration_us), folder.string());
}

}  // namespace

RunResult run(const RunOptions& options, const std::function<void(const RunProgress&)>& progress) {
  check_output_folder(options.out);
  LiveLink live(options.live, options.warn);
  simulation::Simulation simulation(options.scenario, options.make_host, options.change);
  const OutputFolder folder(options.out);

  const auto columns = simulation::RunRecorder::columns(simulation.robot());
  ShownTrace trace(columns, simulation.robot());
  const auto when_full = live.is_live() ? simulation::WhenFull::kDrop : simulation::WhenFull::kWait;
  simulation::Recorder files(options.out, columns, when_full);
  std::optional<view::RunRecording> recording;
  if (options.recording_period_us > 0) {
    recording.emplace(options.out / "run.mcap", simulation,
                      view::RunRecording::Options{options.recording_period_us, when_full, options.view});
  } else if (options.view != nullptr) {
    recording.emplace(std::filesystem::path(), simulation,
                      view::RunRecording::Options{.when_full = when_full, .listener = options.view});
  }
  view::RunRecording* const recording_or_none = recording ? &*recording : nullptr;
  simulation::RunRecorder recorder(simulation, &files, recording_or_none);
  if (recording) report_mesh_faults(*recording, recorder.events(), options.warn);
  if (options.view != nullptr) {
    options.view->start(view::recording_head(simulation), bus::make_network(simulation.robot()));
  }
  live.attach(simulation.board().electronics().bus());
  if (options.ready) options.ready(live);
  const auto start = Clock::now();
  RunResult result;
  const Ending ending = play(simulation, recorder, recording_or_none, options.view, live, trace,
                             options.make_operator, progress);
  result.failure = ending.failure;
  const double wall_s = seconds_since(start);
  result.live = live.report();
  files.close();

  add_ending(ending, simulation, recorder.events(), live.is_live());
  result.summary = recorder.summary();
  if (recording) recording->close(result.summary.events);
  if (options.view != nullptr) options.view->close();
  write_whole_file(options.out / "events.txt", simulation::events_text(result.summary.events));
  simulation::write_json(
      options.out / "timing.json",
      timing_json(simulation.board(), wall_s, files.dropped(), recording ? recording->dropped() : 0, live));
  if (options.make_operator) {
    write_whole_file(options.out / "played.yaml", simulation::played_text(simulation.played(), options.out));
  }
  if (ending.signal && !live.is_live()) throw Interrupted(*ending.signal, how_far(simulation, options.out));
  live.release_signals();
  try {
    const std::string left_out = draw_figures(simulation, trace.columns(), options.out);
    if (!left_out.empty()) result.plot_warning = left_out;
  } catch (const PlotError& error) {
    result.plot_warning = "no figures: " + std::string(error.what());
  }
  if (!result.failure)
    simulation::write_json(options.out / "summary.json", simulation::to_json(result.summary));
  return result;
}

}  // namespace koboshi::tools
