#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/run/live_link.h"

namespace koboshi::tools {

// --can, --realtime, --real-bus, for commands that simulate. `options` must outlive the command.
void add_live_options(CLI::App& command, LiveOptions& options);

// One line with the place where others find the bus.
void tell_where(const LiveLink& link);
// LiveLink::Warn on standard error.
void warn(const std::string& text);
// One line, none when there were none: times that the clock on the wall was ahead, and frames that found no
// room.
void tell_overruns(std::uint64_t overruns, std::uint64_t largest_delay_us);
void tell_lost(std::uint64_t frames);
// Both, and the other frames that were lost or late, of LiveLink::report.
void tell_troubles(const nlohmann::ordered_json& report);

}  // namespace koboshi::tools
