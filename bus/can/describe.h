#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "firmware/canopen/dictionary.h"
#include "hal/port/can.h"
#include "sim_board/can/foreign_frame.h"

namespace koboshi::bus {

enum class FrameKind { kNmt, kSync, kEmergency, kTime, kPdo, kSdo, kHeartbeat, kLss, kOther };

// Returns the kind of an identifier by the predefined connection set (CiA 301, 7.3.5), the second SDO
// channels of the drives, and LSS (CiA 305).
FrameKind kind_of(const hal::CanFrame& frame);
// Returns the node that a frame belongs to; 0 for frames to all nodes.
int node_of(const hal::CanFrame& frame);

// Returns the name of a node's object; empty if it is unknown.
using ObjectNames = std::function<std::string(int node, canopen::ObjectAddress address)>;

// Describes an NMT, SYNC, EMCY, heartbeat, SDO or LSS frame; the objects of SDO frames have their names if
// `names` is given. `is_segment`: the frame is a segment of an SDO block, as SdoBlocks::follow returns. Empty
// for a PDO and for frames that are not CANopen.
std::string describe(const hal::CanFrame& frame, const ObjectNames& names = {}, bool is_segment = false);
// Describes a frame with an identifier of LSS (CiA 305).
std::string describe_lss(const hal::CanFrame& frame);

// Describes a foreign frame by its format: `29-bit identifier`, `CAN FD, bit rate switch`. An error frame is
// decoded (linux/can/error.h).
std::string describe(const sim_board::ForeignFrame& frame);

// Counts the frames that no decoder of CANopen reads: foreign frames, and remote frames.
class ForeignCount {
 public:
  void add(const sim_board::BusFrame& frame);
  bool empty() const;
  // `3 with 29-bit identifiers, 1 error frame`.
  std::string text() const;

 private:
  std::array<std::uint64_t, 5> counts_{};
};

}  // namespace koboshi::bus
