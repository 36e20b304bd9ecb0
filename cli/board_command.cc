#include "cli/commands.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/dictionary/network.h"
#include "cli/options.h"
#include "simulation/assembly/board_without_controller.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"
#include "view/capture/run_recording.h"

namespace koboshi::cli {
namespace {

struct BoardArguments {
  std::filesystem::path scenario = "scenarios/board.yaml";
  std::vector<std::string> sets;
  std::string robot;
  std::string duration;
  tools::LiveOptions live;
  ViewOptions view;
};

void play_board(const BoardArguments& arguments) {
  const auto overrides = overrides_of(arguments.sets, {{"duration_s", arguments.duration, "--duration"},
                                                       simulation::robot_override(arguments.robot)});
  tools::LiveOptions live_options = arguments.live;
  const auto view = open_view(arguments.view, live_options);
  tools::LiveLink live(live_options, warn);
  simulation::BoardWithoutController bare(simulation::read_scenario(
      simulation::find_input(simulation::InputKind::kScenario, arguments.scenario), overrides));
  sim_board::SimBoard& board = bare.board();
  std::optional<view::RunRecording> recording;
  if (view) {
    view->set_keys({.refusal = "A board without controller takes no keys."});
    recording.emplace(bare, *view);
    board.electronics().bus().set_observer(&*recording);
    view->start(view::recording_head(bare), bus::make_network(bare.robot()));
  }
  live.attach(board.electronics().bus());
  print_bus_address(live);
  print_view_address(view.get());
  while (!bare.finished() && !live.interrupted()) {
    live.before(board.now_us());
    bare.advance();
    if (recording) {
      recording->record();
      view->set_dropped(recording->dropped());
    }
    live.after(board.now_us());
  }
  if (recording) {
    board.electronics().bus().set_observer(nullptr);
    recording->close({});
    view->close();
  }
  const sim_board::BusUsage usage = board.electronics().bus().usage();
  fmt::print("{:.2f} s, {} frames, bus load {:.0f} %\n", 1e-6 * static_cast<double>(board.now_us()),
             usage.frames, 100.0 * sim_board::bus_load({}, usage));
  warn_of_losses(live.report());
}

}  // namespace

void add_board_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<BoardArguments>();
  CLI::App* command =
      program.add_subcommand("board", "Simulate the robot without its controller, for any CANopen master");
  command->footer(
      R"(The robot hangs on a stand; its drives (CiA 402) and sensors are nodes on a CAN bus. The simulation ends after
the scenario's duration, or by Ctrl-C or SIGTERM; the exit status is 0 in each case.

Examples:
  koboshi board --can socketcan:vcan0
  koboshi board --can udp:239.74.163.2:43113 --duration 60
  koboshi board --can socketcan:vcan0 --view
)");
  command->add_option(
      "SCENARIO", arguments->scenario,
      "File or name of a scenario without commands, motions and gait (default: scenarios/board.yaml)");
  add_robot_option(*command, arguments->robot);
  command->add_option("--duration", arguments->duration, "Simulated seconds");
  command->add_option("--set", arguments->sets, "Override a key of the scenario; may be repeated")
      ->allow_extra_args(false);
  add_live_options(*command, arguments->live);
  add_view_options(*command, arguments->view);
  command->callback([arguments] { play_board(*arguments); });
}

}  // namespace koboshi::cli
