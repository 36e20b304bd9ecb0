#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "bus/dictionary/network.h"

namespace koboshi::bus {

// Returns the signal with the limits of its size.
Signal integer_signal(Signal signal);

// The messages of CiA 301 that no PDO mapping describes.
Message nmt_message(const std::string& master);
Message sync_message(const std::string& producer, std::uint32_t cycle_time_ms);
// The manufacturer's bytes of the controller's message hold the state of its behaviour (0x2001).
Message emergency_message(std::uint8_t node_id, const std::string& node, const std::string& receiver,
                          bool controller);
Message heartbeat_message(std::uint8_t node_id, const std::string& node, const std::string& receiver,
                          std::uint32_t period_ms);
// Request and response. The meaning of the last four bytes depends on the command.
std::array<Message, 2> sdo_messages(std::uint8_t node_id, const std::string& node, const std::string& client);

}  // namespace koboshi::bus
