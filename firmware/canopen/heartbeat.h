#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "firmware/canopen/slot_map.h"

namespace koboshi::canopen {

enum class HeartbeatEventKind : std::uint8_t {
  kFirstSeen,     // the first heartbeat since monitoring began, since a loss, or since a boot-up
  kStateChanged,  // another state than in the last heartbeat
  kBootedUp,      // the boot-up message: the node has restarted
  kLost,          // no heartbeat for the consumer time
};

struct HeartbeatEvent {
  std::uint8_t node_id = 0;
  HeartbeatEventKind kind = HeartbeatEventKind::kFirstSeen;
  NmtState state = NmtState::kInitialising;  // as last heard

  friend bool operator==(const HeartbeatEvent&, const HeartbeatEvent&) = default;
};

// One entry of 0x1016, and what was heard of its node.
struct HeartbeatConsumer {
  std::uint8_t node_id = 0;
  bool alive = false;  // heard, and not silent for longer than time_ms since
  bool lost = false;   // was silent for longer, and not heard since
  NmtState state = NmtState::kInitialising;
  std::uint16_t time_ms = 0;  // 0: not monitored
  std::uint64_t deadline_us = 0;
};

// The heartbeat consumers of a node (CiA 301, 7.2.8.3.2.2 and object 0x1016). Monitoring of a node starts
// with its first heartbeat, so that a node that is never heard is never lost. It continues over a boot-up
// message: a node that restarts and then is silent is lost. It ends with the loss, and when 0x1016 is
// written.
class HeartbeatMonitor {
 public:
  HeartbeatMonitor(std::span<HeartbeatConsumer> consumers, std::span<SlotMap::Item> slots)
      : consumers_(consumers), slots_(slots) {}

  // Number of consumers.
  std::size_t size() const { return consumers_.size(); }
  // Object 0x1016, sub-indices 1..n: node id in bits 16..23, time in ms in bits 0..15. kSubindexDoesNotExist
  // beyond n. Writing sub-index 0: kWriteOfReadOnly; a node id above 127: kInvalidValue; a node that another
  // sub-index monitors: kParameterIncompatibility.
  AbortCode read(std::uint8_t subindex, ObjectValue& value) const;
  AbortCode write(std::uint8_t subindex, std::uint32_t value);
  // Ends the monitoring of all nodes.
  void clear();
  // Suspends the monitoring of a node until its next heartbeat.
  void await(std::uint8_t node_id);
  // Restarts all consumer times, when heartbeats cannot get through.
  void postpone(std::uint64_t now_us);
  // Whether a node will be lost by `time_us` unless it is heard before.
  bool expects_by(std::uint64_t time_us) { return time_us >= earliest_us_ && find_earliest() <= time_us; }

  // Takes a heartbeat. True, and `event` set, when it is an event.
  bool on_heartbeat(const Heartbeat& heartbeat, std::uint64_t now_us, HeartbeatEvent& event);
  // True, and `event` set, when a node has been lost; to be called again until false.
  bool check(std::uint64_t now_us, HeartbeatEvent& event) { return due(now_us) && find_lost(now_us, event); }
  // Whether `check` has anything to look at.
  bool due(std::uint64_t now_us) const { return now_us >= earliest_us_; }

  // The state of a node; null if it is not monitored.
  const HeartbeatConsumer* find(std::uint8_t node_id) const;
  // Calls visit(node id) for each node that is monitored.
  template <typename Visit>
  void for_each_node(Visit visit) const {
    for (const HeartbeatConsumer& consumer : consumers_) {
      if (monitors(consumer)) visit(consumer.node_id);
    }
  }
  // True while some node is lost.
  bool any_lost() const;

 private:
  static bool monitors(const HeartbeatConsumer& consumer) {
    return consumer.node_id != 0 && consumer.time_ms != 0;
  }
  bool find_lost(std::uint64_t now_us, HeartbeatEvent& event);
  std::uint64_t find_earliest();
  void update_slots();

  std::span<HeartbeatConsumer> consumers_;
  SlotMap slots_;
  std::uint64_t earliest_us_ = 0;  // no node's deadline lies before
};

}  // namespace koboshi::canopen
