#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tools/dictionary/network.h"

namespace koboshi::tools {

// The same signal, with the limits of its size.
Signal integer_signal(Signal signal);

// The messages of CiA 301 that no PDO mapping describes.
Message nmt_message(const std::string& master);
Message sync_message(const std::string& producer, std::uint32_t cycle_time_ms);
// The controller's tells in its manufacturer's bytes what its behaviour (0x2001) had come to.
Message emergency_message(std::uint8_t node_id, const std::string& node, const std::string& receiver,
                          bool controller);
Message heartbeat_message(std::uint8_t node_id, const std::string& node, const std::string& receiver,
                          std::uint32_t period_ms);
// Request and answer. What follows the four bytes of the address depends on the command.
std::array<Message, 2> sdo_messages(std::uint8_t node_id, const std::string& node, const std::string& client);

}  // namespace koboshi::tools
