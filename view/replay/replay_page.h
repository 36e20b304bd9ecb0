#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "bus/dictionary/network.h"
#include "view/recording/recording.h"

namespace koboshi::view {

// The network with which a recording's frames are decoded: `network`, or the recorded nodes without their
// messages if `network` is that of another robot.
bus::Network network_of(const Recording& recording, bus::Network network);

// Returns the replay page of a run: one HTML file that needs neither server nor network. It consists of the
// sources in page/, three.js, and the run's data (replay_data.h), compressed by gzip. `other`, a second run
// for comparison, may be null.
std::string replay_page(const Recording& recording, const Recording* other, const bus::Network& network);

// Writes the page atomically. Throws WriteError.
void write_replay_page(const Recording& recording, const Recording* other, const bus::Network& network,
                       const std::filesystem::path& file);

// Returns the same page without data: it reads a running simulation from the stream beside its address.
std::string live_page(const std::string& title, std::uint16_t port);

// The Content-Security-Policy of that page: as the replay page, and its own stream.
std::string live_page_policy(std::uint16_t port);

}  // namespace koboshi::view
