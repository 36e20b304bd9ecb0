// koboshi can lss: node ids and bit rates of nodes by Layer Setting Services.

#include <fmt/core.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "base/file/standard_streams.h"
#include "bus/can/frame_text.h"
#include "bus/can/lss_master.h"
#include "bus/can/scan.h"
#include "bus/can/sdo_transfer.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "firmware/canopen/frame.h"

namespace koboshi::cli {
namespace {

using canopen::LssSlave;

struct LssArguments {
  std::string value;  // of the command: a node id, a bit rate, a state
  std::string address;
  std::string node;
  bool store = false;
  int delay_ms = 0;
  int timeout_ms = 500;
  bus::SdoChannel channel = bus::SdoChannel::kAutomatic;  // for the identity of --node
  CanOptions can;
};
constexpr std::uint64_t kHolderTimeout_us = 500'000;  // until a node id counts as free
using LssPointer = std::shared_ptr<LssArguments>;

bus::LssAddress identity_of(sim_board::Transport& transport, std::uint8_t node, bus::SdoChannel channel) {
  bus::SdoTransfer sdo = bus::open_sdo(transport, node, channel);
  bus::LssAddress address{};
  for (std::size_t i = 0; i < address.size(); ++i) {
    const auto data = sdo.read({0x1018, static_cast<std::uint8_t>(i + 1)});
    if (data.size() != 4) throw std::runtime_error("its identity object is incomplete");
    address[i] = canopen::load_u32(data.data());
  }
  return address;
}

// An LSS master, with the slaves that a command concerns in configuration. At the end they go to waiting.
class Session {
 public:
  Session(const LssArguments& arguments, bool stays = false)
      : transport_(open_can(arguments.can)),
        master_(*transport_, 1000u * static_cast<unsigned>(arguments.timeout_ms)),
        stays_(stays) {
    master_.switch_globally(LssSlave::State::kWaiting);
  }
  ~Session() {
    try {
      if (!stays_) master_.switch_globally(LssSlave::State::kWaiting);
    } catch (const std::exception&) {  // the error that ends the command is reported
    }
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // One slave by --address or --node; without them all, which suits a bus with one slave.
  void select(const LssArguments& arguments) {
    if (arguments.address.empty() && arguments.node.empty())
      return master_.switch_globally(LssSlave::State::kConfiguration);
    const bus::LssAddress address =
        arguments.address.empty() ? identity_of(*transport_, parse_node(arguments.node), arguments.channel)
                                  : bus::parse_lss_address(arguments.address);
    if (!master_.switch_selectively(address))
      throw std::runtime_error(fmt::format("no LSS slave {} answers", bus::lss_address_text(address)));
  }

  // Throws std::runtime_error if a node has this id already: two nodes with one id block each other's
  // services.
  void require_free(std::uint8_t node_id) {
    if (const std::optional<std::string> holder = holder_of(node_id))
      throw std::runtime_error(fmt::format("{}: nothing is assigned to a slave without a node id", *holder));
  }
  // Describes the node that has this id; nothing without one.
  std::optional<std::string> holder_of(std::uint8_t node_id) {
    const auto node = bus::find_node(*transport_, node_id, kHolderTimeout_us);
    if (!node) return std::nullopt;
    const auto number = [&](std::size_t part) { return node->identity[part].value_or(0); };
    return fmt::format("node id {} is in use by {}{}", node_id, node->name.empty() ? "a node" : node->name,
                       node->identity[0]
                           ? ", " + bus::lss_address_text({number(0), number(1), number(2), number(3)})
                           : std::string());
  }

  bus::LssMaster& master() { return master_; }

 private:
  std::unique_ptr<sim_board::Transport> transport_;
  bus::LssMaster master_;
  bool stays_;
};

std::string id_text(std::uint8_t node_id) {
  return node_id == canopen::kUnconfiguredNodeId ? "no node id" : fmt::format("node {}", node_id);
}

void inquire(const LssArguments& arguments) {
  Session session(arguments);
  session.select(arguments);
  const bus::LssAddress address = session.master().inquire_address();
  fmt::print("{}  {}\n", bus::lss_address_text(address), id_text(session.master().inquire_node_id()));
}

// Finds slaves without a node id, one after the other: each stays in configuration until all are found.
int find(const LssArguments& arguments) {
  int next = arguments.value.empty() ? 0 : parse_node(arguments.value);
  Session session(arguments);
  int found = 0;
  while (const auto address = session.master().fastscan()) {
    ++found;
    if (next == 0) {
      fmt::print("{}\n", bus::lss_address_text(*address));
      continue;
    }
    if (next > canopen::kMaxNodeId) throw std::runtime_error("there are more slaves than node ids up to 127");
    // Alone in configuration, or the others would take the same node id.
    session.master().switch_globally(LssSlave::State::kWaiting);
    session.require_free(static_cast<std::uint8_t>(next));
    if (!session.master().switch_selectively(*address))
      throw std::runtime_error(fmt::format("no LSS slave {} answers", bus::lss_address_text(*address)));
    session.master().configure_node_id(static_cast<std::uint8_t>(next));
    if (arguments.store) session.master().store();
    fmt::print("{}  node {}{}\n", bus::lss_address_text(*address), next, arguments.store ? ", stored" : "");
    ++next;
    session.master().switch_globally(LssSlave::State::kWaiting);
  }
  if (found == 0) print_error("koboshi: no LSS slave without a node id\n");
  return found > 0 ? 0 : 1;
}

// A change of all slaves that are in configuration would give several nodes one id.
void require_one(bus::LssMaster& master) { static_cast<void>(master.inquire_address()); }

void set_node(const LssArguments& arguments) {
  const std::uint8_t id =
      arguments.value == "none" ? canopen::kUnconfiguredNodeId : parse_node(arguments.value);
  Session session(arguments);
  session.select(arguments);
  require_one(session.master());
  const std::uint8_t present = session.master().inquire_node_id();
  if (id != canopen::kUnconfiguredNodeId && id != present) {
    if (present == canopen::kUnconfiguredNodeId) session.require_free(id);  // it takes the id at once
    if (const auto holder = session.holder_of(id))
      warn(*holder + "; give that node another one before the reset");
  }
  session.master().configure_node_id(id);
  if (arguments.store) session.master().store();
  fmt::print("{} from the next reset on{}\n", id_text(id), arguments.store ? ", stored" : "");
}

void set_bit_rate(const LssArguments& arguments) {
  // The table of CiA 305; selector 5 is reserved.
  static const std::map<std::string, std::uint8_t> kSelectors{{"1000", 0}, {"800", 1}, {"500", 2}, {"250", 3},
                                                              {"125", 4},  {"50", 6},  {"20", 7},  {"10", 8}};
  const auto selector = kSelectors.find(arguments.value);
  if (selector == kSelectors.end())
    throw std::invalid_argument(fmt::format(
        "found the bit rate '{}', expected 1000, 800, 500, 250, 125, 50, 20 or 10 kbit/s", arguments.value));
  Session session(arguments);
  session.select(arguments);
  session.master().configure_bit_timing(selector->second);
  if (arguments.store) session.master().store();
  if (arguments.delay_ms > 0)
    session.master().activate_bit_timing(static_cast<std::uint16_t>(arguments.delay_ms));
  fmt::print("{} kbit/s{}{}\n", arguments.value, arguments.store ? ", stored" : "",
             arguments.delay_ms > 0 ? fmt::format(", in effect after {} ms", arguments.delay_ms) : "");
}

void store(const LssArguments& arguments) {
  Session session(arguments);
  session.select(arguments);
  session.master().store();
  fmt::print("stored\n");
}

void switch_state(const LssArguments& arguments) {
  Session session(arguments, true);
  if (arguments.value == "configuration") session.select(arguments);
}

CLI::App* add(CLI::App& lss, const char* name, const char* text, const LssPointer& arguments,
              bool with_target) {
  CLI::App* command = lss.add_subcommand(name, text);
  if (with_target) {
    CLI::Option* address =
        command
            ->add_option("--address", arguments->address,
                         "Select the slave with this identity; VENDOR:PRODUCT:REVISION:SERIAL, hexadecimal")
            ->type_name("ADDRESS")
            ->check(taken_by(bus::parse_lss_address));
    command
        ->add_option("--node", arguments->node,
                     "Select the slave with this node id, whose identity is read by SDO first\n"
                     "(default: the only slave on the bus)")
        ->type_name("NODE")
        ->check(taken_by(parse_node))
        ->excludes(address);
    add_sdo_options(*command, arguments->channel);
  }
  command
      ->add_option("--timeout", arguments->timeout_ms,
                   "Milliseconds to wait for an answer (default: 500); a tenth at each bit of fastscan")
      ->check(CLI::Range(1, 10'000))
      ->type_name("MS");
  add_can_options(*command, arguments->can);
  return command;
}

void add_store(CLI::App& command, const LssPointer& arguments) {
  command.add_flag("--store", arguments->store, "Store the setting in the slave");
}

}  // namespace

void add_can_lss_command(CLI::App& can, Invocation& invocation) {
  CLI::App* lss =
      can.add_subcommand("lss", "Find nodes and set their node ids and bit rates by LSS (CiA 305)");
  lss->require_subcommand(1);
  lss->footer(
      R"(A slave is in the state waiting or configuration. Each command puts the slave that --address or --node selects,
or all slaves, into configuration, and all into waiting at its end, except `switch`.
A new node id takes effect when the node is reset: koboshi can nmt reset-communication NODE. A slave without a node id
takes it at once; it is refused an id that a node on the bus has.

Examples:
  koboshi can lss find --can socketcan:vcan0
  koboshi can lss find --assign 40 --store --can socketcan:vcan0
  koboshi can lss inquire --node 16 --can socketcan:vcan0
  koboshi can lss set-node 40 --node 16 --store --can socketcan:vcan0
)");
  const auto arguments = std::make_shared<LssArguments>();

  CLI::App* find_command =
      add(*lss, "find", "Find the slaves without a node id, by fastscan", arguments, false);
  find_command->add_option("--assign", arguments->value, "Give them the node ids from this one on")
      ->type_name("NODE");
  add_store(*find_command, arguments);
  find_command->callback([arguments, &invocation] { invocation.exit_status = find(*arguments); });

  add(*lss, "inquire", "Show identity and node id of a slave", arguments, true)->callback([arguments] {
    inquire(*arguments);
  });

  CLI::App* set_command = add(*lss, "set-node", "Set the node id of a slave", arguments, true);
  set_command->add_option("ID", arguments->value, "1 to 127, decimal, or none")->required();
  add_store(*set_command, arguments);
  set_command->callback([arguments] { set_node(*arguments); });

  CLI::App* rate_command = add(*lss, "bit-rate", "Set the bit rate of a slave, or of all", arguments, true);
  rate_command->add_option("KBIT", arguments->value, "1000, 800, 500, 250, 125, 50, 20 or 10 kbit/s")
      ->required();
  rate_command
      ->add_option("--activate", arguments->delay_ms, "Switch to it after this delay, in milliseconds")
      ->check(CLI::Range(1, 65'535))
      ->type_name("MS");
  add_store(*rate_command, arguments);
  rate_command->callback([arguments] { set_bit_rate(*arguments); });

  add(*lss, "store", "Store node id and bit rate in a slave", arguments, true)->callback([arguments] {
    store(*arguments);
  });

  CLI::App* switch_command =
      add(*lss, "switch", "Put slaves into a state, and leave them in it", arguments, true);
  switch_command->add_option("STATE", arguments->value, "waiting or configuration")
      ->required()
      ->check(CLI::IsMember({"waiting", "configuration"}));
  switch_command->callback([arguments] { switch_state(*arguments); });
}

}  // namespace koboshi::cli
