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

void tell_overruns(const nlohmann::ordered_json& report) {
  if (report.contains("overruns") && report["overruns"] > 0) {
    fmt::print(stderr, "koboshi: {} times more than {} ms behind the clock, {} ms at most\n",
               report["overruns"].get<std::uint64_t>(), Pacer::kTolerance_us / 1000,
               report["largest_delay_us"].get<std::uint64_t>() / 1000);
  }
  if (report.contains("can") && report["can"]["frames_lost"] > 0) {
    fmt::print(stderr, "koboshi: {} frames found no room outside\n",
               report["can"]["frames_lost"].get<std::uint64_t>());
  }
}

}  // namespace koboshi::tools
