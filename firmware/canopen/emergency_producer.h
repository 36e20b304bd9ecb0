#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/canopen/cob_id.h"
#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

// Sends emergency messages (CiA 301, 7.2.7) under the COB-ID of 0x1014, no sooner one after another than the
// inhibit time 0x1015 allows; up to kPending wait in order, more are dropped (the history has them all).
class EmergencyProducer {
 public:
  static constexpr std::size_t kPending = 8;

  explicit EmergencyProducer(FrameSink& sink) : sink_(sink) {}

  // As after a reset.
  void load_defaults(std::uint8_t node_id);
  std::uint32_t cob_id() const { return cob_id_; }
  AbortCode write_cob_id(std::uint32_t value);
  std::uint16_t inhibit_time_100us() const { return inhibit_time_100us_; }
  void set_inhibit_time(std::uint16_t time_100us) { inhibit_time_100us_ = time_100us; }

  // Without an inhibit time it goes at once, otherwise with `process`.
  void send(const Emergency& emergency);
  void process(std::uint64_t now_us) {
    if (size_ > 0) send_pending(now_us);
  }
  // Forgets what waits: the state of the node forbids it.
  void clear() { size_ = 0; }

 private:
  void send_pending(std::uint64_t now_us);
  void transmit(const Emergency& emergency);

  FrameSink& sink_;
  std::uint32_t cob_id_ = kCobIdInvalid;
  std::uint16_t inhibit_time_100us_ = 0;
  std::array<Emergency, kPending> pending_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint64_t inhibited_until_us_ = 0;
};

}  // namespace koboshi::canopen
