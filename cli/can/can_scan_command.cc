#include <fmt/core.h>

#include <memory>

#include "base/file/standard_streams.h"
#include "bus/can/scan.h"
#include "cli/commands.h"
#include "cli/options.h"

namespace koboshi::cli {

void add_can_scan_command(CLI::App& can, Invocation& invocation) {
  struct Arguments {
    double listen_s = 1.0;
    bus::SdoChannel channel = bus::SdoChannel::kAutomatic;
    CanOptions can;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = can.add_subcommand("scan", "Find the nodes of a bus and show their identities");
  command->footer(
      R"(Reads the device type (1000) of the ids 1 to 127 by SDO, listens for heartbeats, and reads identity (1018) and
name (1008) of the nodes that answer. Drives are asked on their second SDO channel, which a controller on the bus does
not use, and then on the first if they do not answer. All that have not answered are asked twice; after each time it
listens for --duration, and on while further nodes are found, up to five times as long. If no node is found, it asks up
to five times, and says what passed on the bus. Exit status: 0 nodes were found; 1 none.

Example:
  koboshi can scan --can socketcan:vcan0
)");
  command
      ->add_option("--duration", arguments->listen_s,
                   "Seconds to listen for heartbeats and late answers (default: 1)")
      ->check(CLI::Range(0.05, 60.0))
      ->type_name("SECONDS");
  add_sdo_options(*command, arguments->channel);
  add_can_options(*command, arguments->can);
  command->callback([arguments, &invocation] {
    const auto transport = open_can(arguments->can);
    const bus::ScanResult result = bus::scan_bus(
        *transport,
        {.listen_us = static_cast<std::uint64_t>(1e6 * arguments->listen_s), .channel = arguments->channel});
    if (result.nodes.empty()) {
      print_error(
          "koboshi: no node of {} answers or sends heartbeats; {}{}\n", transport->place(),
          bus::sighting_text(result),
          result.frames > 0 ? ": if they are of CANopen nodes, a longer --duration may find them" : "");
    } else {
      fmt::print("{}", bus::scan_table(result));
    }
    if (result.unconfigured) fmt::print("nodes without a node id answer LSS: koboshi can lss find\n");
    invocation.exit_status = result.nodes.empty() && !result.unconfigured ? 1 : 0;
  });
}

}  // namespace koboshi::cli
