#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/run/live_link.h"

namespace koboshi::tools {

// --can, --realtime, --real-bus, for commands that simulate. `options` must outlive the command.
void add_live_options(CLI::App& command, LiveOptions& options);

// One line with the place where others find the bus.
void tell_where(const LiveLink& link);
// One line for overruns and frames that found no room, of LiveLink::report; none when there were none.
void tell_overruns(const nlohmann::ordered_json& report);

}  // namespace koboshi::tools
