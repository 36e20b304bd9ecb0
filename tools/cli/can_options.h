#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "sim_board/can/transport/transport.h"
#include "tools/can/source.h"

namespace koboshi::tools {

// Which bus a command speaks to.
struct CanOptions {
  std::string can = "socketcan:vcan0";
  bool real_bus = false;
};

// --can and --real-bus; not beside `log`, the command's option of a log, if it has one. `options` must
// outlive the command.
void add_can_options(CLI::App& command, CanOptions& options, CLI::Option* log = nullptr);

// The transport of these options. Throws std::invalid_argument for one that joins nobody, and what
// sim::open_transport throws.
std::unique_ptr<sim::Transport> open_can(const CanOptions& options);

// Frames from a log where one is named, else from the bus.
struct OpenedSource {
  std::unique_ptr<sim::Transport> transport;  // null for a log
  std::unique_ptr<FrameSource> source;
};
OpenedSource open_source(const std::filesystem::path& log, const CanOptions& options);

// 1 to 127. Throws std::invalid_argument.
std::uint8_t parse_node(const std::string& text);

}  // namespace koboshi::tools
