#pragma once

#include <cstdint>

namespace koboshi::canopen {

// States of a node, with the values that its heartbeat carries (CiA 301, 7.3.2.2). kInitialising appears as
// the boot-up message.
enum class NmtState : std::uint8_t {
  kInitialising = 0,
  kStopped = 4,
  kOperational = 5,
  kPreOperational = 127
};

// Commands of the NMT master (CiA 301, 7.2.8.2.1).
enum class NmtCommand : std::uint8_t {
  kStart = 1,
  kStop = 2,
  kEnterPreOperational = 128,
  kResetNode = 129,
  kResetCommunication = 130,
};

// Which services a state permits (CiA 301, 7.3.2.2.5).
constexpr bool permits_pdo(NmtState state) { return state == NmtState::kOperational; }
constexpr bool permits_sdo(NmtState state) {
  return state == NmtState::kOperational || state == NmtState::kPreOperational;
}
constexpr bool permits_sync(NmtState state) { return permits_sdo(state); }
constexpr bool permits_time(NmtState state) { return permits_sdo(state); }
constexpr bool permits_emergency(NmtState state) { return permits_sdo(state); }

}  // namespace koboshi::canopen
