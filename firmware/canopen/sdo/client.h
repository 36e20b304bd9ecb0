#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"

namespace koboshi::canopen {

enum class SdoState : std::uint8_t { kIdle, kBusy, kDone, kAborted, kTimedOut };

// The client's side of expedited SDO transfers (CiA 301, 7.2.4): one at a time, to one server at a time.
// Several clients in a node may work side by side if their servers differ.
class SdoClient {
 public:
  static constexpr std::uint32_t kDefaultTimeout_us = 100'000;

  // Frames go to `sink`: that of the node (Node::sink()), so that they keep their order.
  explicit SdoClient(FrameSink& sink, std::uint32_t timeout_us = kDefaultTimeout_us)
      : sink_(sink), timeout_us_(timeout_us) {}

  // Begin a transfer with the default channel of server `node_id`. False, and nothing begun, while busy, when
  // the frame cannot be sent, or when `size` is not 1..4.
  [[nodiscard]] bool begin_write(std::uint8_t node_id, ObjectAddress address, std::uint32_t value,
                                 std::size_t size, std::uint64_t now_us);
  [[nodiscard]] bool begin_read(std::uint8_t node_id, ObjectAddress address, std::uint64_t now_us);

  // To be told of every frame; those that are not of the transfer are ignored. True when the frame was of the
  // transfer.
  bool on_frame(const hal::CanFrame& frame) { return state_ == SdoState::kBusy && answers(frame); }
  // Looks at the clock: a server that has not answered in time is told 0504 0000 and the transfer ends in
  // kTimedOut.
  void process(std::uint64_t now_us) {
    if (state_ == SdoState::kBusy && now_us >= deadline_us_) time_out();
  }

  SdoState state() const { return state_; }
  // Of a transfer that ended in kAborted, by the server or, if its answer made no sense, by us.
  AbortCode abort_code() const { return abort_code_; }
  // What a read brought, `size()` bytes of it, not sign-extended.
  std::uint32_t value() const { return value_; }
  std::size_t size() const { return size_; }
  std::uint8_t server() const { return node_id_; }
  ObjectAddress address() const { return address_; }
  // Back to kIdle, whatever was going on.
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
