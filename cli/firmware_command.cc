#include "cli/commands.h"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "cli/options.h"
#include "sim_board/board/sim_board.h"
#include "simulation/assembly/prepared_scenario.h"
#include "simulation/host/firmware_process.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"
#include "tools/run/interrupt.h"
#include "tools/run/pacer.h"

namespace koboshi::cli {
namespace {

struct FirmwareArguments {
  std::filesystem::path scenario;
  std::string robot;
  double duration_s = 86400.0;
  double speed = 1.0;
  std::filesystem::path storage;
  CanOptions can;
};

void run_firmware(const FirmwareArguments& arguments) {
  const simulation::Scenario scenario =
      simulation::read_scenario(simulation::find_input(simulation::InputKind::kScenario, arguments.scenario),
                                overrides_of({}, {simulation::robot_override(arguments.robot)}));
  warn_of_left_out(scenario);
  const simulation::PreparedScenario prepared = simulation::prepare(scenario);
  const auto transport = open_can(arguments.can);
  tools::Interrupt interrupt;
  simulation::FirmwareProcess firmware(prepared.storage_contents, *transport, arguments.storage);
  fmt::print("firmware on {}\n", transport->place());
  std::fflush(stdout);
  const auto end_us = static_cast<std::uint64_t>(1e6 * arguments.duration_s);
  tools::Pacer pacer(0, arguments.speed, tools::interruptible(interrupt));
  bool warned = false;
  for (std::uint64_t now_us = 0; now_us < end_us; now_us += sim_board::SimBoard::kService_us) {
    pacer.wait_for(now_us);
    if (now_us % sim_board::SimBoard::kTick_us == 0 && interrupt.requested()) break;
    firmware.service(now_us);
    if (firmware.has_given_way())
      throw std::runtime_error(transport->place() +
                               ": another controller is on this bus, and a bus has one controller");
    if (firmware.found_second_master() && !std::exchange(warned, true))
      warn("another controller is on the bus: the drives are left to it until command 6, reset");
  }
  warn_of_overruns(pacer.overruns(), pacer.largest_delay_us());
  warn_of_lost_frames(firmware.frames_lost());
}

}  // namespace

void add_firmware_command(CLI::App& program, Invocation&) {
  auto arguments = std::make_shared<FirmwareArguments>();
  CLI::App* command =
      program.add_subcommand("firmware", "Run the controller's firmware as a process on a CAN bus");
  command->footer(
      R"(Drives and sensors are nodes of the same bus: those of `koboshi board`, or real ones. The controller boots
limp and waits for commands over the bus (docs/guide/live-bus.md). It ends after --duration, or by Ctrl-C or
SIGTERM, with status 0 in each case; and with status 1 if another controller, such as that of `koboshi run`, is
on the bus already.

Examples:
  koboshi board --can socketcan:vcan0 &
  koboshi firmware scenarios/squat.yaml --can socketcan:vcan0
)");
  command
      ->add_option("SCENARIO", arguments->scenario,
                   "File or name of the scenario whose robot and motions go into the storage; its other keys "
                   "have no effect")
      ->required();
  add_robot_option(*command, arguments->robot);
  command->add_option("--duration", arguments->duration_s, "Seconds (default: until Ctrl-C)")
      ->check(CLI::Range(0.001, 86400.0));
  command
      ->add_option(
          "--speed", arguments->speed,
          "Firmware seconds per second of real time (default: 1), for a simulated board that is slowed down")
      ->check(CLI::Range(0.01, 100.0));
  command->add_option("--storage", arguments->storage,
                      "File that keeps the flash between runs: saved parameters and motions (default: none)");
  add_can_options(*command, arguments->can);
  command->callback([arguments] { run_firmware(*arguments); });
}

}  // namespace koboshi::cli
