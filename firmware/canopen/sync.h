#pragma once

#include <cstdint>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "hal/port/can.h"

namespace koboshi::canopen {

// The next time of something periodic that was due at `due_us`. If it is late by a period or more, the period
// starts anew: it does not catch up.
constexpr std::uint64_t next_beat(std::uint64_t due_us, std::uint64_t period_us, std::uint64_t now_us) {
  const std::uint64_t next_us = due_us + period_us;
  return next_us > now_us ? next_us : now_us + period_us;
}

// SYNC, produced and consumed (CiA 301, 7.2.5), with the objects 0x1005 COB-ID, 0x1006 communication cycle
// period, 0x1007 synchronous window length and 0x1019 synchronous counter overflow value.
class Sync {
 public:
  // Resets the objects to their defaults. With a period of 0 no SYNC is due by itself. `by_owner`: the owner
  // requests SYNCs in this period; 0x1006 then accepts only it and 0.
  void load_defaults(bool producer, std::uint32_t period_us, bool by_owner = false);
  // To be called when the node leaves initialising or stopped: starts the period, and the counter at 1.
  void start(std::uint64_t now_us);

  // One of the four objects; kObjectDoesNotExist for others. Writing a value that is not supported, or
  // another identifier while the node produces SYNC: kInvalidValue; 0x1019 while 0x1006 is not 0:
  // kDeviceState.
  AbortCode read(std::uint16_t index, ObjectValue& value) const;
  AbortCode write(std::uint16_t index, std::uint32_t value);

  std::uint16_t identifier() const { return static_cast<std::uint16_t>(cob_id_ & kCobIdMask); }
  bool identifies(const hal::CanFrame& frame) const { return frame.identifier == identifier(); }
  // 0x1006; 0: none.
  std::uint32_t period_us() const { return period_us_; }
  // Takes a SYNC. False, and nothing taken, when its length does not fit 0x1019.
  bool accept(const hal::CanFrame& frame, std::uint64_t now_us);
  // The counter of the last SYNC: 1..240, or 0 without one.
  std::uint8_t counter() const { return counter_; }
  // Whether the synchronous window 0x1007 is still open; always, if its length is 0.
  bool window_open(std::uint64_t now_us) const { return window_us_ == 0 || now_us - last_us_ <= window_us_; }

  // Whether a SYNC that the owner requests is to be sent.
  bool produces() const { return producer() && (owners_period_us_ == 0 || period_us_ != 0); }
  // True, once for each SYNC, when the producer's next one is due by its period.
  bool take_due(std::uint64_t now_us) {
    return producer() && period_us_ != 0 && owners_period_us_ == 0 && take_beat(now_us);
  }
  // The next SYNC frame; advances the counter.
  hal::CanFrame next();

 private:
  bool take_beat(std::uint64_t now_us);
  bool producer() const { return (cob_id_ & kSyncProducer) != 0; }
  AbortCode write_cob_id(std::uint32_t value);
  AbortCode write_overflow(std::uint32_t value);

  std::uint32_t cob_id_ = kSyncCobId;
  std::uint32_t period_us_ = 0;
  std::uint32_t owners_period_us_ = 0;  // 0: SYNCs are due by themselves
  std::uint32_t window_us_ = 0;
  std::uint8_t overflow_ = 0;  // highest value of the counter; 0: SYNC carries none
  std::uint8_t produced_ = 0;  // counter of the last SYNC that this node produced
  std::uint8_t counter_ = 0;
  std::uint64_t due_us_ = 0;
  std::uint64_t last_us_ = 0;
};

}  // namespace koboshi::canopen
