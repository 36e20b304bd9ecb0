#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/run_and_report.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"

namespace koboshi::cli {
namespace {

struct ScenarioArguments {
  std::filesystem::path scenario;
  RunArguments run;
};

}  // namespace

void add_run_command(CLI::App& program, Invocation& invocation) {
  auto arguments = std::make_shared<ScenarioArguments>();
  CLI::App* command = program.add_subcommand("run", "Play a scenario: firmware and robot in lockstep");
  command->footer(
      R"(Runs as fast as possible; the same scenario and seed give the same bytes. The folder of the results holds
  trace.csv     firmware state and ground truth, every 10 ms
  can.log       every frame on the bus, in the format of candump -L
  run.mcap      the whole run, for koboshi replay and other viewers (docs/reference/recording.md)
  events.txt    events with their times and reasons
  summary.json  the outcome; timing.json: the computing time on this machine
  *.png, *.svg  figures

A robot that falls is a result, with exit status 0: `fell` in summary.json tells it. Status 1: an error ended the run.
In real time, Ctrl-C and SIGTERM are the normal end, with all results and status 0 or 1; else an interruption,
with status 130 or 143.

Examples:
  koboshi run walk
  koboshi run scenarios/walk.yaml --seed 7 --set ground.friction=0.4 --out runs/slippery
  koboshi run scenarios/teleop.yaml --realtime
  koboshi run scenarios/teleop.yaml --realtime --view
)");
  command
      ->add_option("SCENARIO", arguments->scenario,
                   "A scenario's file or name, docs/reference/scenario-format.md")
      ->required();
  add_run_options(*command, arguments->run);
  add_robot_option(*command, arguments->run.robot);
  command->add_option("--duration", arguments->run.duration, "Simulated seconds");
  command
      ->add_option("--controller", arguments->run.controller,
                   "Where the firmware runs: in-process (default); qemu: on a Cortex-M4")
      ->check(CLI::IsMember({"in-process", "qemu"}));
  command->add_option("--image", arguments->run.image,
                      "The image for --controller qemu (default: the one that ./run target builds)");
  command->add_option("--storage", arguments->run.storage,
                      "File that keeps the flash between runs: saved parameters and motions (default: none)");
  add_live_options(*command, arguments->run.live);
  command->callback([arguments, &invocation] {
    const auto file = simulation::find_input(simulation::InputKind::kScenario, arguments->scenario);
    invocation.exit_status =
        run_and_report(arguments->run, simulation::read_scenario(file, scenario_overrides(arguments->run)));
  });
}

}  // namespace koboshi::cli
