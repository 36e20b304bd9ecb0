#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "base/text/error.h"
#include "base/text/text.h"
#include "bus/can/configuration.h"
#include "bus/can/device_file.h"
#include "bus/can/sdo_transfer.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "firmware/canopen/frame.h"

namespace koboshi::cli {
namespace {

struct DcfArguments {
  std::string node;
  std::filesystem::path file;
  bool write = false;
  bus::SdoChannel channel = bus::SdoChannel::kAutomatic;
  CanOptions can;
};

// Refuses to write the file of another device into a node.
void check_device(bus::SdoTransfer& sdo, const DcfArguments& arguments, const bus::DeviceFile& file) {
  const auto check = [&](std::uint8_t subindex, const char* what,
                         const std::optional<std::uint32_t>& wanted) {
    if (!wanted || *wanted == 0) return;
    const auto data = sdo.read({0x1018, subindex});
    const std::uint32_t found = data.size() == 4 ? canopen::load_u32(data.data()) : 0;
    if (found != *wanted)
      throw std::runtime_error(fmt::format("{} is for {} {:08X}, but node {} has {:08X}; nothing is written",
                                           arguments.file.string(), what, *wanted, arguments.node, found));
  };
  check(1, "vendor", file.vendor_id);
  check(2, "product", file.product_code);
}

int run_dcf(const DcfArguments& arguments) {
  const std::uint8_t node = parse_node(arguments.node);
  const bus::DeviceFile file = bus::read_device_file(arguments.file, node);
  if (arguments.write && !file.is_dcf)
    throw InputError(arguments.file, 0, "no ParameterValue", "a DCF, whose ParameterValues --write writes");
  const auto transport = open_can(arguments.can);
  bus::SdoTransfer sdo = bus::open_sdo(*transport, node, arguments.channel);
  if (file.node_id && *file.node_id != node)
    warn(fmt::format("{} is for node {}", arguments.file.string(), *file.node_id));
  if (arguments.write) check_device(sdo, arguments, file);
  const bus::ConfigurationReport report =
      arguments.write ? bus::write_configuration(sdo, file) : bus::compare_configuration(sdo, file);
  for (const std::string& difference : report.differences) fmt::print("{}\n", difference);
  if (arguments.write) fmt::print("{} written\n", count_text(report.written, "value"));
  fmt::print("{} of {} compared as in {}{}\n", report.differences.empty() ? "all" : "not all",
             count_text(report.compared, "object"), arguments.file.string(),
             report.differences.empty()
                 ? ""
                 : fmt::format(": {}", count_text(report.differences.size(), "difference")));
  return report.differences.empty() ? 0 : 1;
}

}  // namespace

void add_can_dcf_command(CLI::App& can, Invocation& invocation) {
  auto arguments = std::make_shared<DcfArguments>();
  CLI::App* command =
      can.add_subcommand("dcf", "Compare a node with a DCF or EDS file, or write a DCF into it");
  command->footer(
      R"(Compares the objects of a node with the ParameterValues of a device configuration file (DCF), or with the
DefaultValues of an electronic data sheet (EDS), CiA 306-1. With --write, it first writes the ParameterValues that the
node has not yet; a PDO is disabled while it changes. Exit status: 0 all objects are as in the file; 1 some differ, or
the file is for another device; 2 bad file.

Example:
  koboshi can dcf 16 docs/reference/drive.eds --can socketcan:vcan0
)");
  command->add_option("NODE", arguments->node, "1 to 127, decimal")->required();
  command->add_option("FILE", arguments->file, "A DCF or EDS file")->required();
  command->add_flag("--write", arguments->write,
                    "Write the ParameterValues of the DCF before the comparison");
  add_sdo_options(*command, arguments->channel);
  add_can_options(*command, arguments->can);
  command->callback([arguments, &invocation] { invocation.exit_status = run_dcf(*arguments); });
}

}  // namespace koboshi::cli
