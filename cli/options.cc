#include "cli/options.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <stdexcept>

#include <fmt/core.h>

#include "base/file/standard_streams.h"
#include "bus/can/frame_text.h"
#include "firmware/canopen/frame.h"
#include "sim_board/description/load.h"
#include "simulation/scenario/paths.h"
#include "tools/run/transport_options.h"

namespace koboshi::cli {
namespace {

constexpr const char* kRobot = "robots/koboshi/robot.sdf";

const std::map<std::string, sim_board::CandumpReader::Times> kTimes{
    {"auto", sim_board::CandumpReader::Times::kRecognised},
    {"absolute", sim_board::CandumpReader::Times::kAbsolute},
    {"delta", sim_board::CandumpReader::Times::kDifferences}};

}  // namespace

bus::Network network_of(const std::filesystem::path& robot) {
  const std::filesystem::path file = robot.empty()
                                         ? simulation::find_referenced({}, kRobot)
                                         : simulation::find_input(simulation::InputKind::kRobot, robot);
  return file.empty() ? bus::Network{} : bus::make_network(sim_board::load_robot(file));
}

std::vector<Override> overrides_of(std::span<const std::string> sets, const std::vector<Override>& options) {
  std::vector<Override> all;
  std::ranges::transform(sets, std::back_inserter(all), parse_override);
  std::ranges::copy_if(options, std::back_inserter(all),
                       [](const Override& option) { return !option.value.empty(); });
  return all;
}

void add_robot_option(CLI::App& command, std::string& robot) {
  const auto is_given = [](const std::string& value) {
    return value.find_first_not_of(' ') == std::string::npos ? "found an empty name, expected a robot" : "";
  };
  command.add_option("--robot", robot, "A robot's folder, file or name instead of the scenario's robot")
      ->check(is_given);
}

void add_can_options(CLI::App& command, CanOptions& options, CLI::Option* log) {
  CLI::Option* can = command.add_option(
      "--can", options.can,
      "The bus: socketcan:vcan0 (default) or udp:239.74.163.2:43113 (python-can's udp_multicast)");
  const auto transport = tools::add_transport_options(command, options.transport);
  if (log == nullptr) return;
  can->excludes(log);
  for (CLI::Option* option : transport) option->excludes(log);
}

std::unique_ptr<sim_board::Transport> open_can(const CanOptions& options) {
  auto transport = sim_board::open_transport(options.can, options.transport);
  if (!transport || !transport->is_live() || options.can == "slcan")
    throw std::invalid_argument("found --can " + options.can +
                                ", expected socketcan:INTERFACE or udp:GROUP:PORT");
  return transport;
}

void add_sdo_options(CLI::App& command, bus::SdoChannel& channel) {
  CLI::Option* first = command.add_flag_callback(
      "--first", [&channel] { channel = bus::SdoChannel::kFirst; },
      "Use a drive's first SDO channel (0x1200), which is the controller's");
  command
      .add_flag_callback(
          "--second", [&channel] { channel = bus::SdoChannel::kSecond; },
          "Use a drive's second SDO channel (0x1201) only (default: the second; the first if there is no "
          "answer)")
      ->excludes(first);
}

CLI::Option* add_log_options(CLI::App& command, bus::LogChoice& log, const std::string& help) {
  CLI::Option* place = command.add_option("LOG", log.place, help);
  command
      .add_option("--bus", log.interface,
                  "Read only the frames of this interface: a log of candump may hold several buses")
      ->type_name("NAME")
      ->needs(place);
  command
      .add_option_function<std::string>(
          "--times", [&log](const std::string& name) { log.times = kTimes.at(name); },
          "How to read the log's times: absolute, as they are (candump -t a, A and z); delta, as\n"
          "differences (-t d); auto (default): as differences if they begin at zero and then decrease\n"
          "or repeat, which a warning says, and which is not recognised from a pipe")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "absolute", "delta"}))
      ->needs(place);
  return place;
}

OpenedSource open_source(const bus::LogChoice& log, const CanOptions& options, tools::Interrupt& interrupt) {
  const bus::WaitForInput wait = [&interrupt](int descriptor, std::uint64_t timeout_us) {
    std::fflush(stdout);
    return interrupt.wait_for_input(descriptor, timeout_us);
  };
  if (!log.place.empty()) return {nullptr, bus::open_log(log, wait)};
  CanOptions listening = options;
  listening.transport.real_bus = true;  // what only listens moves no servo
  auto transport = open_can(listening);
  auto source = bus::listen_to(*transport, wait);
  return {std::move(transport), std::move(source)};
}

void print_remarks(bus::FrameSource& source) {
  const std::vector<std::string> remarks = source.take_remarks();
  if (!remarks.empty()) std::fflush(stdout);
  for (const std::string& remark : remarks) warn(remark);
}

std::uint8_t parse_node(const std::string& text) {
  const auto node = static_cast<std::uint8_t>(bus::parse_number(text, "the node", canopen::kMaxNodeId));
  if (node == 0) throw std::invalid_argument("found node 0, expected 1 to 127");
  return node;
}

void add_live_options(CLI::App& command, tools::LiveOptions& options) {
  command.add_option("--can", options.can,
                     "Connect the simulated bus to: none (default), socketcan:vcan0,\n"
                     "udp:239.74.163.2:43113 (python-can's udp_multicast), slcan (on a pseudo-terminal),\n"
                     "log:FILE (in the format of candump -L)");
  command.add_flag("--realtime", options.realtime,
                   "Run in real time; implied by --view, socketcan, udp and slcan");
  command
      .add_option("--speed", options.speed,
                  "Simulated seconds per second of real time (default: 1); less on a slow machine")
      ->check(CLI::Range(0.01, 100.0));
  static_cast<void>(tools::add_transport_options(command, options.transport));
}

void add_view_options(CLI::App& command, ViewOptions& options) {
  CLI::Option* view =
      command.add_flag("--view", options.view,
                       "Show the simulation in a browser of this machine, and print the page's address");
  command.add_option("--view-port", options.port, "Port of that address on 127.0.0.1 (default: a free one)")
      ->needs(view)
      ->check(CLI::Range(1, 65535));
}

std::unique_ptr<view::LiveView> open_view(const ViewOptions& options, tools::LiveOptions& live) {
  if (!options.view) return nullptr;
  live.realtime = true;
  return std::make_unique<view::LiveView>(options.port);
}

void print_view_address(const view::LiveView* view) {
  if (view == nullptr) return;
  fmt::print("live view on {}\n", view->address());
  std::fflush(stdout);
}

void print_bus_address(const tools::LiveLink& link) {
  if (link.transport() == nullptr) return;
  fmt::print("CAN bus on {}\n", link.transport()->place());
  std::fflush(stdout);
}

void warn(const std::string& text) { print_error("koboshi: warning: {}\n", text); }

void warn_of_left_out(const simulation::Scenario& scenario) {
  if (const std::string text = simulation::left_out_text(scenario); !text.empty()) warn(text);
}

void warn_of_meshes(const view::Recording& recording) {
  for (const view::Event& event : recording.events)
    if (event.kind == "mesh") warn(event.text);
}

void warn_of_overruns(std::uint64_t overruns, std::uint64_t largest_delay_us) {
  if (overruns == 0) return;
  print_error("koboshi: {} times more than {} ms behind the clock, {} ms at most\n", overruns,
              tools::Pacer::kTolerance_us / 1000, largest_delay_us / 1000);
}

void warn_of_lost_frames(std::uint64_t frames) {
  if (frames > 0) print_error("koboshi: {} frames found no room outside\n", frames);
}

void warn_of_losses(const nlohmann::ordered_json& report) {
  if (report.contains("overruns")) warn_of_overruns(report["overruns"], report["largest_delay_us"]);
  if (!report.contains("can")) return;
  const auto& can = report["can"];
  warn_of_lost_frames(can["frames_lost"]);
  const std::uint64_t refused = can["frames_refused"];
  const std::uint64_t dropped = can["frames_dropped"];
  const std::uint64_t sent_late = can["frames_sent_late"];
  const std::uint64_t received_late = can["frames_received_late"];
  if (refused + dropped > 0)
    print_error("koboshi: {} frames from outside were lost: {} found no room on the bus, {} came too fast\n",
                refused + dropped, refused, dropped);
  if (sent_late + received_late > 0)
    print_error("koboshi: frames more than {} ms late: {} of {} sent, {} of {} received\n",
                tools::LiveLink::kLate_us / 1000, sent_late, can["frames_sent"].get<std::uint64_t>(),
                received_late, can["frames_received"].get<std::uint64_t>());
}

}  // namespace koboshi::cli
