#include "cli/commands.h"

#include <fmt/core.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bus/can/frame_text.h"
#include "bus/can/source.h"
#include "cli/options.h"
#include "firmware/canopen/frame.h"

namespace koboshi::cli {
namespace {

using canopen::NmtCommand;

void add_send(CLI::App& can) {
  struct Arguments {
    std::vector<std::string> frames;
    CanOptions can;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      can.add_subcommand("send", fmt::format("Send frames: {}, 000#0110, 123#R", bus::kSampleFrame));
  command->add_option("FRAME", arguments->frames, "ID#DATA in hexadecimal, as for cansend")->required();
  add_can_options(*command, arguments->can);
  command->callback([arguments] {
    std::vector<hal::CanFrame> frames;
    for (const std::string& text : arguments->frames) frames.push_back(bus::parse_frame(text));
    const auto transport = open_can(arguments->can);
    for (const hal::CanFrame& frame : frames) bus::send_surely(*transport, frame);
  });
}

// A node id, or 0 for all nodes (CiA 301, 7.2.8.3.1).
std::uint8_t parse_addressed(const std::string& text) {
  return text == "all" ? std::uint8_t{0} : parse_node(text);
}

void add_nmt(CLI::App& can) {
  struct Arguments {
    std::string order;
    std::string node;
    CanOptions can;
  };
  static const std::map<std::string, NmtCommand> kOrders{
      {"start", NmtCommand::kStart},
      {"stop", NmtCommand::kStop},
      {"pre-operational", NmtCommand::kEnterPreOperational},
      {"reset", NmtCommand::kResetNode},
      {"reset-communication", NmtCommand::kResetCommunication}};
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = can.add_subcommand("nmt", "Change the NMT state of a node, or of all nodes");
  std::vector<std::string> names;
  for (const auto& [name, order] : kOrders) names.push_back(name);
  command
      ->add_option("COMMAND", arguments->order, "start, stop, pre-operational, reset or reset-communication")
      ->required()
      ->check(CLI::IsMember(names));
  command->add_option("NODE", arguments->node, "1 to 127, decimal, or all")
      ->required()
      ->check(taken_by(parse_addressed));
  add_can_options(*command, arguments->can);
  command->callback([arguments] {
    const canopen::NmtMessage message{kOrders.at(arguments->order), parse_addressed(arguments->node)};
    bus::send_surely(*open_can(arguments->can), canopen::encode(message));
  });
}

}  // namespace

void add_can_command(CLI::App& program, Invocation& invocation) {
  CLI::App* can = program.add_subcommand("can", "Watch a CAN bus and talk to it");
  can->require_subcommand(1);
  can->footer(fmt::format(
      R"(Numbers: identifiers, indices, sub-indices and data are hexadecimal, as candump writes them;
nodes and values are decimal. The prefix 0x means hexadecimal everywhere; an ambiguous number is
refused (sub-index 10: write 0x10 or 0xA).

Examples:
  koboshi can dump runs/walk                        the log of a run, decoded
  koboshi can dump --can socketcan:vcan0 --node 16
  koboshi can send {:<32} tells the controller to enable the drives
  koboshi can sdo read 1 1008
  koboshi can nmt start all
  koboshi can scan --can socketcan:vcan0
  koboshi can lss find --can socketcan:vcan0
  koboshi can dcf 16 docs/reference/drive.eds --can socketcan:vcan0
  koboshi can stats runs/walk
  koboshi can export runs/walk --out walk.asc
  koboshi can replay runs/walk/can.log --can udp:239.74.163.2:43113
)",
      bus::kSampleFrame));
  add_can_dump_command(*can, invocation);
  add_send(*can);
  add_can_sdo_command(*can, invocation);
  add_nmt(*can);
  add_can_scan_command(*can, invocation);
  add_can_lss_command(*can, invocation);
  add_can_dcf_command(*can, invocation);
  add_can_log_commands(*can, invocation);
}

}  // namespace koboshi::cli
