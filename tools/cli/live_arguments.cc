#include "tools/cli/live_arguments.h"

#include <fmt/core.h>

#include <cstdio>

namespace koboshi::tools {

void add_live_options(CLI::App& command, LiveOptions& options) {
  command.add_option("--can", options.can,
                     "Joins the simulated bus to others: none (default), socketcan:vcan0,\n"
                     "udp:239.74.163.2:43113 (python-can's udp_multicast), slcan (on a pseudo-terminal),\n"
                     "log:FILE (as candump -L)");
  command.add_flag("--realtime", options.realtime,
                   "Goes by the clock on the wall; always so with socketcan, udp and slcan");
  command
      .add_option("--speed", options.speed,
                  "Simulated seconds in one of that clock (default: 1); less for a machine that is too slow")
      ->check(CLI::Range(0.01, 100.0));
  command.add_flag(
      "--real-bus", options.real_bus,
      "Allows an interface that is neither vcan nor vxcan. What is sent there may move real servos");
}

void tell_where(const LiveLink& link) {
  if (link.transport() == nullptr) return;
  fmt::print("CAN bus on {}\n", link.transport()->place());
  std::fflush(stdout);
}

void warn(const std::string& text) { fmt::print(stderr, "koboshi: warning: {}\n", text); }

void tell_overruns(std::uint64_t overruns, std::uint64_t largest_delay_us) {
  if (overruns == 0) return;
  fmt::print(stderr, "koboshi: {} times more than {} ms behind the clock, {} ms at most\n", overruns,
             Pacer::kTolerance_us / 1000, largest_delay_us / 1000);
}

void tell_lost(std::uint64_t frames) {
  if (frames > 0) fmt::print(stderr, "koboshi: {} frames found no room outside\n", frames);
}

void tell_troubles(const nlohmann::ordered_json& report) {
  if (report.contains("overruns")) tell_overruns(report["overruns"], report["largest_delay_us"]);
  if (!report.contains("can")) return;
  const auto& can = report["can"];
  tell_lost(can["frames_lost"]);
  const std::uint64_t refused = can["frames_refused"];
  const std::uint64_t dropped = can["frames_dropped"];
  const std::uint64_t sent_late = can["frames_sent_late"];
  const std::uint64_t received_late = can["frames_received_late"];
  if (refused + dropped > 0)
    fmt::print(stderr,
               "koboshi: {} frames from outside were lost: {} found no room on the bus, {} came too fast\n",
               refused + dropped, refused, dropped);
  if (sent_late + received_late > 0)
    fmt::print(stderr, "koboshi: frames more than {} ms late: {} of {} sent, {} of {} received\n",
               LiveLink::kLate_us / 1000, sent_late, can["frames_sent"].get<std::uint64_t>(), received_late,
               can["frames_received"].get<std::uint64_t>());
}

}  // namespace koboshi::tools
