#pragma once

#include <functional>
#include <string>

#include "firmware/canopen/dictionary.h"
#include "hal/port/can.h"

namespace koboshi::tools {

enum class FrameKind { kNmt, kSync, kEmergency, kTime, kPdo, kSdo, kHeartbeat, kOther };

// Returns the kind of an identifier by the predefined connection set (CiA 301, 7.3.5) and the second SDO
// channels of the drives.
FrameKind kind_of(const hal::CanFrame& frame);
// Returns the node that a frame belongs to; 0 for frames to all nodes.
int node_of(const hal::CanFrame& frame);

// Returns the name of a node's object; empty if it is unknown.
using ObjectNames = std::function<std::string(int node, canopen::ObjectAddress address)>;

// Describes an NMT, SYNC, EMCY, heartbeat or SDO frame; the objects of SDO frames have their names if `names`
// is given. Empty for a PDO and for frames that are not CANopen.
std::string describe(const hal::CanFrame& frame, const ObjectNames& names = {});

}  // namespace koboshi::tools
