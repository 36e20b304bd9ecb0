#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "bus/can/sdo_transfer.h"
#include "bus/can/source.h"
#include "bus/dictionary/network.h"
#include "sim_board/can/transport/transport.h"
#include "simulation/scenario/scenario.h"
#include "tools/run/interrupt.h"
#include "tools/run/live_link.h"
#include "view/live/live_view.h"
#include "view/recording/recording.h"

namespace koboshi::cli {

// Options that several commands share. The structs must outlive the command that they are added to.

// The overrides of a file's keys: each KEY=VALUE of --set, then those of `options` that have a value. Throws
// InputError.
std::vector<Override> overrides_of(std::span<const std::string> sets, const std::vector<Override>& options);

// Adds --robot, which plays scenarios with another robot than theirs (simulation::robot_override).
void add_robot_option(CLI::App& command, std::string& robot);

// The bus that a command listens to or sends on.
struct CanOptions {
  std::string can = "socketcan:vcan0";
  sim_board::TransportOptions transport{};
};

// Adds --can, --real-bus, --ttl and --interface. They exclude `log`, the option of a command that can read a
// log instead.
void add_can_options(CLI::App& command, CanOptions& options, CLI::Option* log = nullptr);

// Opens the bus of these options. Throws std::invalid_argument for a transport that no other program can
// join, and what sim_board::open_transport throws.
std::unique_ptr<sim_board::Transport> open_can(const CanOptions& options);

inline constexpr const char* kLogHelp = "A log of candump -L, the folder of a run, or - for standard input";
inline constexpr const char* kLogOrBusHelp =
    "A log of candump -L, the folder of a run, or - for standard input\n(default: the live bus)";

// Adds --first and --second, which choose the SDO channel of a drive. `channel` must outlive the command.
void add_sdo_options(CLI::App& command, bus::SdoChannel& channel);

// Adds LOG, and with it --bus and --times. Returns the option of LOG.
CLI::Option* add_log_options(CLI::App& command, bus::LogChoice& log, const std::string& help);

// Frames from a log, if one is named, else from the bus.
struct OpenedSource {
  std::unique_ptr<sim_board::Transport> transport;  // null for a log
  std::unique_ptr<bus::FrameSource> source;
};
// Signals end the waits; standard output is flushed before each.
OpenedSource open_source(const bus::LogChoice& log, const CanOptions& options, tools::Interrupt& interrupt);
// Prints on standard error what the user should know about the part of a log that was read since the last
// call.
void print_remarks(bus::FrameSource& source);

// The messages on the bus of a robot's file; without one, of Koboshi from the repository of this folder or of
// the program, and empty if there is none.
bus::Network network_of(const std::filesystem::path& robot);

// A node id, 1 to 127. Throws std::invalid_argument.
std::uint8_t parse_node(const std::string& text);

// Lets an option take only what the parser takes, so that a bad argument is refused before a bus is opened.
// The message is the parser's.
template <typename Parser>
CLI::Validator taken_by(Parser parse) {
  return CLI::Validator(
      [parse](std::string& text) -> std::string {
        try {
          static_cast<void>(parse(text));
          return {};
        } catch (const std::invalid_argument& error) {
          return error.what();
        }
      },
      "");
}

// Adds --can, --realtime, --speed, --real-bus, --ttl and --interface of a simulation.
void add_live_options(CLI::App& command, tools::LiveOptions& options);

// Adds --view and --view-port.
struct ViewOptions {
  bool view = false;
  std::uint16_t port = 0;  // 0: a free one
};
void add_view_options(CLI::App& command, ViewOptions& options);

// Opens the live view, which runs in real time; null without --view. With --real-bus its pages may not drive.
std::unique_ptr<view::LiveView> open_view(const ViewOptions& options, tools::LiveOptions& live);

// Prints the address of the pages, if there is a live view.
void print_view_address(const view::LiveView* view);

// Prints the address of the bus, if the simulation is joined to one.
void print_bus_address(const tools::LiveLink& link);

// Prints a warning on standard error, while the simulation runs.
void warn(const std::string& text);
// Warns of what the robot of a scenario does not have and the run leaves out (simulation::left_out_text).
void warn_of_left_out(const simulation::Scenario& scenario);
// Repeats what a run has recorded about meshes that it could not show.
void warn_of_meshes(const view::Recording& recording);
// The same after the run, from LiveLink::report: frames lost or late, overruns. Prints nothing if all went
// well.
void warn_of_losses(const nlohmann::ordered_json& report);
// Parts of it, for a command that has no LiveLink.
void warn_of_overruns(std::uint64_t overruns, std::uint64_t largest_delay_us);
void warn_of_lost_frames(std::uint64_t frames);

}  // namespace koboshi::cli
