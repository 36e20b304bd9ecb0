#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/canopen/pdo.h"
#include "firmware/canopen/transmit_queue.h"

namespace koboshi::canopen {

// A PDO that a node sends.
struct Tpdo {
  PdoRecord record{PdoDirection::kTransmit};
  // An event waits for the end of the inhibit time, for room in the queue, or for the SYNC.
  bool requested = false;
  bool watched = false;         // a change of a value is an event
  bool counting = false;        // the SYNC with the start value has come, if there is one
  std::uint8_t sync_count = 0;  // SYNCs since the last transmission
  std::uint64_t inhibited_until_us = 0;
  std::uint64_t event_due_us = 0;
  std::array<std::uint8_t, 8> seen{};  // its data when they were looked at last, if they are watched
};

// When each TPDO is due, by its transmission type (CiA 301, 7.2.2.3): at every n-th SYNC, counted from the
// one with the start value, at the SYNC after an event, or at the event itself and when the event timer has
// run out, but never sooner than the inhibit time allows.
//
// Of the first `watched` PDOs every change of a mapped value is an event, and so is that operational begins:
// nobody has been told of the values then. Of the others only their owner knows of events.
class TpdoSet {
 public:
  // Values of `dictionary` go to `queue`; all must outlive the set.
  TpdoSet(std::span<Tpdo> pdos, std::size_t watched, const Dictionary& dictionary, TransmitQueue& queue)
      : pdos_(pdos), watched_(watched), dictionary_(dictionary), queue_(queue) {}

  std::size_t size() const { return pdos_.size(); }
  Tpdo& operator[](std::size_t number) { return pdos_[number]; }
  const Tpdo& operator[](std::size_t number) const { return pdos_[number]; }

  // Whether one of them has this identifier. O(n).
  bool sends(std::uint16_t identifier) const;
  // To be called when record `number` has changed: what waited is dropped, its SYNCs are counted anew.
  void on_changed(std::size_t number);
  // The node has become operational: counters and event timers begin anew.
  void start(std::uint64_t now_us);
  // An event: something in PDO `number` is worth telling.
  void request(std::size_t number, std::uint64_t now_us);
  // `counter` of the SYNC, 1..240; 0 when it carries none.
  void on_sync(std::uint8_t counter, std::uint64_t now_us);
  void process(std::uint64_t now_us) {
    if (watched_end_ != 0) watch();
    if (now_us >= due_us_) send_due(now_us);
  }

 private:
  static void forget(Tpdo& pdo);
  void watch();  // as telemetry is configured after a reset there is nothing to watch
  static bool is_due(Tpdo& pdo, std::uint8_t counter);
  void send_due(std::uint64_t now_us);
  void send(Tpdo& pdo, std::uint64_t now_us);

  std::span<Tpdo> pdos_;
  std::size_t watched_;
  const Dictionary& dictionary_;
  TransmitQueue& queue_;
  std::uint64_t due_us_ = 0;         // nothing is to be sent before
  std::size_t synchronous_end_ = 0;  // behind the last that goes with SYNC
  std::size_t watched_end_ = 0;      // behind the last whose values are watched
};

}  // namespace koboshi::canopen
