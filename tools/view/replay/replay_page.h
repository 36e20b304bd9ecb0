#pragma once

#include <filesystem>
#include <string>

#include "tools/dictionary/network.h"
#include "tools/view/recording/recording.h"

namespace koboshi::view {

// Returns the replay page of a run: one HTML file that needs neither server nor network. It consists of the
// sources in page/, three.js, and the run's data (replay_data.h), compressed by gzip. `other`, a second run
// for comparison, may be null.
std::string replay_page(const Recording& recording, const Recording* other, const tools::Network& network);

// Writes the page atomically. Throws sim::WriteError.
void write_replay_page(const Recording& recording, const Recording* other, const tools::Network& network,
                       const std::filesystem::path& file);

}  // namespace koboshi::view
