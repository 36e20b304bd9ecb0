#pragma once

#include <string>

#include "hal/port/can.h"

namespace koboshi::tools {

enum class FrameKind { kNmt, kSync, kEmergency, kTime, kPdo, kSdo, kHeartbeat, kOther };

// What the predefined connection set (CiA 301, 7.3.5), and the second SDO channels of the drives, make of an
// identifier.
FrameKind kind_of(const hal::CanFrame& frame);
// The node that an identifier belongs to; 0 for those of all.
int node_of(const hal::CanFrame& frame);

// A frame in words, without knowledge of any dictionary: NMT, SYNC, EMCY, heartbeat and SDO; empty for a PDO
// and for what is none of CANopen's.
std::string describe(const hal::CanFrame& frame);

}  // namespace koboshi::tools
