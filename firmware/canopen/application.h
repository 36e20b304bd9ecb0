#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/abort_code.h"
#include "firmware/canopen/domain.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/heartbeat.h"
#include "firmware/canopen/nmt.h"
#include "firmware/canopen/object.h"

namespace koboshi::canopen {

// What "save" to 0x1010 and "load" to 0x1011 are about, by sub-index (CiA 301, 7.5.2.13).
enum class ParameterGroup : std::uint8_t {
  kAll = 1,
  kCommunication = 2,  // 0x1000 to 0x1FFF
  kApplication = 3,    // 0x6000 to 0x9FFF
  kManufacturer = 4,   // 0x2000 to 0x5FFF
};

// The bits of NodeDescription::stored_groups.
constexpr std::uint8_t group_bit(ParameterGroup group) {
  return static_cast<std::uint8_t>(1u << (static_cast<unsigned>(group) - 1));
}

inline constexpr std::uint8_t kAllGroups =
    group_bit(ParameterGroup::kAll) | group_bit(ParameterGroup::kCommunication) |
    group_bit(ParameterGroup::kApplication) | group_bit(ParameterGroup::kManufacturer);

// What a node tells its owner, from within the node's calls. An owner overrides what it cares for; it may
// call the node back.
class NodeApplication {
 public:
  // An SDO client (or write_object) is about to change a value of the owner's table; kNone lets it pass.
  // `value` is sign-extended if the object is signed. Length, access and limits have been checked already.
  virtual AbortCode on_write(ObjectAddress, std::uint32_t /*value*/) { return AbortCode::kNone; }
  // The bytes behind a DOMAIN row of the owner's table; null: not now, the client sees 060A 0023. They must
  // outlive the node. The node never has two transfers of one domain at a time.
  virtual Domain* domain(ObjectAddress) { return nullptr; }
  // Store the parameters of a group so that they survive a restart, or let those of the factory have effect
  // after the next reset. NodeDescription::stored_groups says which the owner can. While it says kBusy the
  // client waits, and the owner is asked again, until all is done (CiA 301, 7.5.2.13).
  virtual AbortCode on_store(ParameterGroup) { return AbortCode::kCannotTransfer; }
  virtual AbortCode on_restore(ParameterGroup) { return AbortCode::kCannotTransfer; }
  // kResetNode (also at start) or kResetCommunication: communication parameters have their defaults again;
  // now is the time to change them with write_object. On kResetNode the owner's own values go back to theirs.
  virtual void on_reset(NmtCommand /*reset*/) {}
  // Whether the node goes on to operational by itself after a reset, as an NMT master or a self-starting
  // device does (CiA 302-2, object 0x1F80). Asked at its end.
  virtual bool starts_itself() { return false; }
  virtual void on_state(NmtState) {}
  // A SYNC, in pre-operational and operational. Synchronous RPDOs have taken effect; synchronous TPDOs are
  // packed afterwards.
  virtual void on_sync(std::uint64_t /*now_us*/) {}
  // RPDO `number` (from 0) has taken effect.
  virtual void on_rpdo(std::size_t /*number*/) {}
  virtual void on_heartbeat(const HeartbeatEvent&) {}
  // Another node's emergency message.
  virtual void on_emergency(const Emergency&) {}
  // Another node has sent what only this one may: its heartbeat, its emergency message, one of its TPDOs, or
  // SYNC while it is the producer. It has the same id, or is a second master.
  virtual void on_impostor(std::uint16_t /*identifier*/) {}

 protected:
  ~NodeApplication() = default;
};

}  // namespace koboshi::canopen
