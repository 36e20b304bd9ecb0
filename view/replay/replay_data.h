#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "bus/can/describe.h"
#include "bus/dictionary/network.h"
#include "view/recording/recording.h"

namespace koboshi::view {

// Poses in the page differ by at most half of these from the recorded ones: less than a pixel when the robot
// fills a large screen.
inline constexpr double kPositionQuantum_m = 1e-5;
inline constexpr double kQuaternionQuantum = 2e-5;
inline constexpr double kForceQuantum_N = 1e-3;

// The data of a replay page: the length of a JSON header (32 bits, little-endian), the header, and the
// columns that it describes (column_pack.h). `other`, a second run for comparison, may be null. The network
// decodes the PDOs; without messages they are shown as bytes.
std::string replay_data(const Recording& recording, const Recording* other, const bus::Network& network);

// Parts of it.
nlohmann::ordered_json event_json(const Event& event);
nlohmann::ordered_json push_json(const Push& push);
const char* kind_text(bus::FrameKind kind);

}  // namespace koboshi::view
