#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

enum class SdoState : std::uint8_t { kIdle, kBusy, kDone, kAborted, kTimedOut };

// A client of expedited SDO transfers (CiA 301, 7.2.4), one at a time. Several clients of a node may work in
// parallel if their servers differ.
class SdoClient {
 public:
  // Set by hand (2026-11-21): a server of this stack answers within a control cycle, 10 ms; the margin is for
  // a bus that is full of frames of higher priority.
  static constexpr std::uint32_t kDefaultTimeout_us = 100'000;

  // Sends to `sink`, that of the node (Node::sink()), so that frames keep their order.
  explicit SdoClient(FrameSink& sink, std::uint32_t timeout_us = kDefaultTimeout_us)
      : sink_(sink), timeout_us_(timeout_us) {}

  // Begin a transfer on the default channel of server `node_id`. False, and nothing begun, while busy, when
  // the frame cannot be sent, or when `size` is not 1..4 bytes.
  [[nodiscard]] bool begin_write(std::uint8_t node_id, ObjectAddress address, std::uint32_t value,
                                 std::size_t size, std::uint64_t now_us);
  [[nodiscard]] bool begin_read(std::uint8_t node_id, ObjectAddress address, std::uint64_t now_us);

  // Takes every frame from the bus. True when it belongs to the transfer.
  bool on_frame(const hal::CanFrame& frame) { return state_ == SdoState::kBusy && answers(frame); }
  // Checks the time-out: if the server has not answered, aborts with 0504 0000 and ends in kTimedOut.
  void process(std::uint64_t now_us) {
    if (state_ == SdoState::kBusy && now_us >= deadline_us_) time_out();
  }

  SdoState state() const { return state_; }
  // The code of a transfer that ended in kAborted: the server's or, if its answer was invalid, the client's
  // own.
  AbortCode abort_code() const { return abort_code_; }
  // The value of a read: `size()` bytes, not sign-extended.
  std::uint32_t value() const { return value_; }
  std::size_t size() const { return size_; }
  std::uint8_t server() const { return node_id_; }
  ObjectAddress address() const { return address_; }
  // Returns to kIdle from any state, without a message.
  void reset() { state_ = SdoState::kIdle; }

 private:
  bool begin(const hal::CanFrame& request, std::uint8_t node_id, ObjectAddress address, std::uint64_t now_us);
  bool answers(const hal::CanFrame& frame);
  void time_out();
  void abort(AbortCode code);
  void accept(const hal::CanFrame& response);

  FrameSink& sink_;
  std::uint32_t timeout_us_;
  SdoState state_ = SdoState::kIdle;
  bool writing_ = false;
  std::uint8_t node_id_ = 0;
  std::uint8_t size_ = 0;
  ObjectAddress address_;
  AbortCode abort_code_ = AbortCode::kNone;
  std::uint32_t value_ = 0;
  std::uint64_t deadline_us_ = 0;
};

}  // namespace koboshi::canopen
