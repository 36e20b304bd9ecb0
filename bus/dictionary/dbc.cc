#include "bus/dictionary/formats.h"

#include <iterator>

#include <fmt/core.h>
#include <fmt/format.h>

namespace koboshi::bus {
namespace {

using Text = std::back_insert_iterator<std::string>;

constexpr std::string_view kNobody = "Vector__XXX";

void add_head(std::string& dbc, const Network& network) {
  dbc += "VERSION \"\"\n\nNS_ :\n\tCM_\n\tBA_DEF_\n\tBA_\n\tVAL_\n\tBA_DEF_DEF_\n\nBS_:\n\nBU_:";
  for (const NetworkNode& node : network.nodes) dbc += " " + node.name;
  dbc += "\n";
}

void add_signal(std::string& dbc, const Signal& signal) {
  fmt::format_to(Text(dbc), " SG_ {} : {}|{}@1{} ({},0) [{:.15g}|{:.15g}] \"{}\" ", signal.name,
                 signal.start_bit, signal.size_bits, signal.is_signed ? '-' : '+', signal.factor,
                 static_cast<double>(signal.low_raw) * signal.factor,
                 static_cast<double>(signal.high_raw) * signal.factor, signal.unit);
  dbc += signal.receivers.empty() ? kNobody : fmt::format("{}", fmt::join(signal.receivers, ","));
  dbc += "\n";
}

void add_messages(std::string& dbc, const Network& network) {
  for (const Message& message : network.messages) {
    fmt::format_to(Text(dbc), "\nBO_ {} {}: {} {}\n", message.identifier, message.name, message.size_bytes,
                   message.sender);
    for (const Signal& signal : message.signals) add_signal(dbc, signal);
  }
}

void add_comments(std::string& dbc, const Network& network) {
  dbc +=
      "\nCM_ \"Written by `koboshi dictionary write`: what is on the bus of the default robot in "
      "operation.\";\n";
  for (const Message& message : network.messages) {
    if (!message.comment.empty()) {
      fmt::format_to(Text(dbc), "CM_ BO_ {} \"{}\";\n", message.identifier, message.comment);
    }
    for (const Signal& signal : message.signals) {
      if (signal.comment.empty()) continue;
      fmt::format_to(Text(dbc), "CM_ SG_ {} {} \"{}\";\n", message.identifier, signal.name, signal.comment);
    }
  }
}

void add_attributes(std::string& dbc, const Network& network) {
  dbc +=
      "\nBA_DEF_ \"BusType\" STRING;\n"
      "BA_DEF_ BU_ \"NodeId\" INT 0 127;\n"
      "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\n"
      "BA_DEF_DEF_ \"BusType\" \"CAN\";\n"
      "BA_DEF_DEF_ \"NodeId\" 0;\n"
      "BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n"
      "BA_ \"BusType\" \"CAN\";\n";
  for (const NetworkNode& node : network.nodes) {
    if (node.node_id != 0) fmt::format_to(Text(dbc), "BA_ \"NodeId\" BU_ {} {};\n", node.name, node.node_id);
  }
  for (const Message& message : network.messages) {
    if (message.cycle_time_ms == 0) continue;
    fmt::format_to(Text(dbc), "BA_ \"GenMsgCycleTime\" BO_ {} {};\n", message.identifier,
                   message.cycle_time_ms);
  }
}

void add_values(std::string& dbc, const Network& network) {
  dbc += "\n";
  for (const Message& message : network.messages) {
    for (const Signal& signal : message.signals) {
      if (signal.values.empty()) continue;
      fmt::format_to(Text(dbc), "VAL_ {} {}", message.identifier, signal.name);
      for (const canopen::ValueName& value : signal.values) {
        fmt::format_to(Text(dbc), " {} \"{}\"", value.value, value.name);
      }
      dbc += " ;\n";
    }
  }
}

}  // namespace

std::string dbc_text(const Network& network) {
  std::string dbc;
  add_head(dbc, network);
  add_messages(dbc, network);
  add_comments(dbc, network);
  add_attributes(dbc, network);
  add_values(dbc, network);
  return dbc;
}

}  // namespace koboshi::bus
