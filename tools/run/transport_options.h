#pragma once

#include <CLI/CLI.hpp>
#include <array>

#include "sim_board/can/transport/transport.h"

namespace koboshi::tools {

// Adds --real-bus, --ttl and --interface to a command with the option --can. `options` must outlive the
// command.
inline std::array<CLI::Option*, 3> add_transport_options(CLI::App& command,
                                                         sim_board::TransportOptions& options) {
  return {
      command.add_flag("--real-bus", options.real_bus,
                       "Allow an interface other than vcan and vxcan. Frames that are sent there may move "
                       "real servos"),
      command
          .add_option("--ttl", options.ttl,
                      "Time to live of UDP datagrams: 0 for this machine (default), 1 for the network\n"
                      "segment, where every program can then command the robot")
          ->type_name("N")
          ->check(CLI::Range(0, 255).description("0 to 255")),
      command
          .add_option("--interface", options.interface,
                      "Network interface for UDP (default: the one that the routing table chooses)")
          ->type_name("NAME")};
}

}  // namespace koboshi::tools
