#include "cli/run_and_report.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/file/standard_streams.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/world/options.h"
#include "simulation/disturbance/world_ranges.h"
#include "simulation/host/qemu_host.h"
#include "simulation/observe/event_log.h"
#include "simulation/scenario/paths.h"
#include "tools/run/run.h"
#include "tools/teleop/page_keys.h"
#include "tools/teleop/teleop.h"

namespace koboshi::cli {
namespace {

// By the value of --record, a rate in hertz.
const std::map<std::string, std::uint64_t>& recording_periods_us() {
  static const std::map<std::string, std::uint64_t> kPeriods{{"no", 0}, {"100", 10'000}, {"500", 2'000}};
  return kPeriods;
}

// Shows the progress of a run on a terminal, and nothing in a pipe.
class ProgressBar {
 public:
  void show(const tools::RunProgress& progress) {
    if (!terminal_) return;
    const int percent = static_cast<int>(100.0 * progress.simulated_s / progress.duration_s);
    if (percent == percent_) return;
    percent_ = percent;
    const int filled = percent * kWidth / 100;
    print_error("\r[{:#<{}}{:<{}}] {:7.2f} s of {:.2f} s, {:.1f} x real time ", "", filled, "",
                kWidth - filled, progress.simulated_s, progress.duration_s,
                progress.simulated_s / progress.wall_s);
    if (percent == 100) print_error("\n");
  }

 private:
  static constexpr int kWidth = 40;
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  int percent_ = -1;
};

void report(const tools::RunResult& result, const std::filesystem::path& out) {
  const simulation::RunSummary& summary = result.summary;
  // The last event is the verdict.
  const auto but_the_last = std::span(summary.events).first(summary.events.size() - 1);
  fmt::print("{}{} after {:.2f} s: {}, bus load {:.0f} %, state {}\nresults in {}\n",
             simulation::events_text(but_the_last), result.failure ? "ended early" : "done",
             summary.duration_s, count_text(summary.solver_warnings, "solver warning"),
             100.0 * summary.can_bus_load, summary.state_hash, out.string());
  std::fflush(stdout);  // before what follows on standard error
  warn_of_losses(result.live);
  if (result.plot_warning) print_error("koboshi: {}\n", *result.plot_warning);
  if (result.failure) print_error("koboshi: {}\n", *result.failure);
  fmt::print("{}\n", summary.verdict);
}

// Why the keys of a page have no effect on this run; empty if they have one.
std::string refusal_of_keys(const tools::RunOptions& options) {
  if (options.live.transport.real_bus) return "Keys are refused: this run is on a real bus (--real-bus).";
  if (!options.scenario.teleop) return "This run takes no keys: --set teleop=true lets a page drive.";
  return {};
}

// The operator needs a terminal or a page, and a run in real time.
void give_operator(tools::RunOptions& options, tools::KeyQueue& keys) {
  const bool takes_page_keys = options.view != nullptr && refusal_of_keys(options).empty();
  const tools::Teleop::Seats seats{tools::Terminal::is_there(), options.view,
                                   takes_page_keys ? &keys : nullptr};
  if (!seats.terminal && !takes_page_keys) {
    throw InputError(options.scenario.file, 0, "teleop: true, but no terminal on standard input and output",
                     "one, whose keys drive the robot, or --view, or --set teleop=false");
  }
  options.live.realtime = true;
  options.make_operator = [seats](simulation::Simulation& simulation, const simulation::RunRecorder& recorder,
                                  const tools::LiveLink& live) {
    return std::make_unique<tools::Teleop>(simulation, recorder, live, seats);
  };
}

// scenarios/board.yaml lasts for a day, for `koboshi board`, which runs in real time.
void warn_of_duration(const tools::RunOptions& options) {
  constexpr double kLong_s = 3600.0;
  constexpr double kSecondsPerHour = 3600.0;
  const double duration_s = 1e-6 * static_cast<double>(options.scenario.duration_us);
  if (options.live.realtime || duration_s <= kLong_s) return;
  warn(fmt::format("the scenario lasts {:.0f} s, {:.1f} h of simulated time; --duration sets another time",
                   duration_s, duration_s / kSecondsPerHour));
}

}  // namespace

void add_run_options(CLI::App& command, RunArguments& arguments) {
  command.add_option("--out", arguments.out,
                     "Folder of the results (default: runs/ and the name of the file)");
  command.add_option("--seed", arguments.seed, "Seed of all random numbers of the run");
  command
      .add_option("--stepper", arguments.stepper,
                  "lumped: exact contacts, in joint coordinates (default); world: the reference, slow;\n"
                  "mujoco: the second engine")
      ->check(CLI::IsMember(sim_board::stepper_names()));
  command
      .add_option("--world", arguments.world,
                  "Draw errors of the robot and the floor within the ranges of this world, by the seed\n"
                  "(docs/reference/worlds.md)")
      ->check(CLI::IsMember(simulation::world_names()));
  command
      .add_option("--set", arguments.sets,
                  "Override a key of the scenario: physics.step_ms=0.5; may be repeated")
      ->allow_extra_args(false);
  command
      .add_option(
          "--plant", arguments.plant,
          "Give the simulated robot another value than the firmware's model has: left_shank.mass=80g;\n"
          "may be repeated; keys are those of koboshi model get")
      ->allow_extra_args(false);
  command
      .add_option("--record", arguments.record,
                  "Samples per second of the recording run.mcap: 100 (default), 500 or no recording")
      ->check(CLI::IsMember({"no", "100", "500"}));
  add_view_options(command, arguments.view);
}

std::vector<Override> scenario_overrides(const RunArguments& arguments) {
  std::vector<Override> overrides =
      overrides_of(arguments.sets, {{"seed", arguments.seed, "--seed"},
                                    {"duration_s", arguments.duration, "--duration"},
                                    {"physics.stepper", arguments.stepper, "--stepper"},
                                    {"world", arguments.world, "--world"},
                                    simulation::robot_override(arguments.robot)});
  for (const std::string& setting : arguments.plant) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == setting.size())
      throw InputError("--plant", 0, one_line(setting), "KEY=VALUE, such as left_shank.mass=80g");
    overrides.push_back(
        text_override("plant." + setting.substr(0, equals), setting.substr(equals + 1), "--plant"));
  }
  return overrides;
}

int run_and_report(const RunArguments& arguments, simulation::Scenario scenario) {
  tools::RunOptions options;
  options.scenario = std::move(scenario);
  options.out =
      arguments.out.empty() ? std::filesystem::path("runs") / options.scenario.file.stem() : arguments.out;
  warn_of_left_out(options.scenario);
  options.make_host = simulation::in_process(arguments.storage);
  if (arguments.controller != "qemu" && !arguments.image.empty())
    throw InputError("--image", 0, "--controller " + arguments.controller, "--controller qemu");
  if (arguments.controller == "qemu") {
    if (!arguments.storage.empty())
      throw InputError("--storage", 0, "--controller qemu", "--controller in-process");
    options.make_host =
        simulation::in_qemu(arguments.image.empty() ? simulation::default_image() : arguments.image);
  }
  options.recording_period_us = recording_periods_us().at(arguments.record);
  options.live = arguments.live;
  tools::KeyQueue keys;  // outlives the view
  const auto view = open_view(arguments.view, options.live);
  options.view = view.get();
  if (view) {
    view::PageKeys offered = tools::page_keys(keys);
    offered.refusal = refusal_of_keys(options);
    view->set_keys(std::move(offered));
  }
  options.ready = [&](const tools::LiveLink& link) {
    print_bus_address(link);
    print_view_address(view.get());
  };
  options.warn = warn;
  std::function<void(const tools::RunProgress&)> show =
      [bar = ProgressBar()](const tools::RunProgress& progress) mutable { bar.show(progress); };
  if (options.scenario.teleop) {
    give_operator(options, keys);
    if (tools::Terminal::is_there()) {
      show = {};  // the operator has the screen
      options.warn = {};
    }
  }
  warn_of_duration(options);
  const tools::RunResult result = tools::run(options, show);
  report(result, options.out);
  return result.failure ? 1 : 0;
}

}  // namespace koboshi::cli
