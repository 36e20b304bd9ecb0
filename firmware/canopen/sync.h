#pragma once

#include <cstdint>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "hal/port/can.h"

namespace koboshi::canopen {

// When a beat that was due at `due_us` is due next. Late by a period and more, it starts anew instead of
// catching up.
constexpr std::uint64_t next_beat(std::uint64_t due_us, std::uint64_t period_us, std::uint64_t now_us) {
  const std::uint64_t next_us = due_us + period_us;
  return next_us > now_us ? next_us : now_us + period_us;
}

// SYNC, produced and consumed (CiA 301, 7.2.5), with the objects 0x1005 COB-ID, 0x1006 communication cycle
// period, 0x1007 synchronous window length and 0x1019 synchronous counter overflow value.
class Sync {
 public:
  // As after a reset. A period of 0: nothing is produced by itself. `by_owner`: nothing ever is, and the
  // period is that in which the owner asks for SYNCs; no other can be written than it and 0.
  void load_defaults(bool producer, std::uint32_t period_us, bool by_owner = false);
  // The node leaves initialising or stopped: the period begins, and the counter with 1.
  void start(std::uint64_t now_us);

  // One of the four objects; kObjectDoesNotExist for others.
  AbortCode read(std::uint16_t index, ObjectValue& value) const;
  AbortCode write(std::uint16_t index, std::uint32_t value);

  bool identifies(const hal::CanFrame& frame) const { return frame.identifier == (cob_id_ & kCobIdMask); }
  // Notes a SYNC. False when it is not as long as 0x1019 says: it is none then.
  bool accept(const hal::CanFrame& frame, std::uint64_t now_us);
  // Of the last SYNC: 1..240, or 0 without a counter.
  std::uint8_t counter() const { return counter_; }
  // Whether synchronous data may still arrive for this cycle. A length of 0: always.
  bool window_open(std::uint64_t now_us) const { return window_us_ == 0 || now_us - last_us_ <= window_us_; }

  // Whether a SYNC that the owner asks for is to be sent.
  bool produces() const { return producer() && (owners_period_us_ == 0 || period_us_ != 0); }
  // True when the producer's next SYNC is due by its period, once for each.
  bool take_due(std::uint64_t now_us) {
    return period_us_ != 0 && owners_period_us_ == 0 && take_beat(now_us);
  }
  // The SYNC that comes next, whoever asks for it.
  hal::CanFrame next();

 private:
  bool take_beat(std::uint64_t now_us);
  bool producer() const { return (cob_id_ & kSyncProducer) != 0; }
  AbortCode write_cob_id(std::uint32_t value);
  AbortCode write_overflow(std::uint32_t value);

  std::uint32_t cob_id_ = kSyncCobId;
  std::uint32_t period_us_ = 0;
  std::uint32_t owners_period_us_ = 0;  // 0: the period is this object's own
  std::uint32_t window_us_ = 0;
  std::uint8_t overflow_ = 0;  // highest value of the counter; 0: SYNC carries none
  std::uint8_t produced_ = 0;  // counter of the last SYNC that this node produced
  std::uint8_t counter_ = 0;
  std::uint64_t due_us_ = 0;
  std::uint64_t last_us_ = 0;
};

}  // namespace koboshi::canopen
