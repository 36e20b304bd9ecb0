#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/canopen/dictionary.h"
#include "firmware/canopen/frame.h"
#include "hal/port/can.h"
#include "sim_board/state/archive.h"

namespace koboshi::simulation {

// A read or write of one object of a node, as the dictionary browser of a PC makes it.
struct ObjectRequest {
  std::uint64_t number = 0;  // chosen by the asker; the answer has the same
  std::uint8_t node_id = 0;  // 1..127
  canopen::ObjectAddress address{};
  std::vector<std::uint8_t> data{};  // to write, numbers little-endian; empty: read
};

struct ObjectAnswer {
  // Whether no valid answer has come: after a time-out, or in a transfer that another client has disturbed.
  bool is_lost() const {
    using enum canopen::AbortCode;
    return abort == kTimedOut || abort == kGeneralError || abort == kCommandSpecifierUnknown ||
           abort == kToggleBitNotAlternated;
  }

  std::uint64_t number = 0;
  std::uint64_t time_us = 0;
  std::vector<std::uint8_t> data{};                      // of a read
  canopen::AbortCode abort = canopen::AbortCode::kNone;  // kTimedOut: the node has not answered
};

// Accesses objects of any node by SDO (CiA 301, 7.2.4), one after the other, without waiting: reads of up to
// 4 KiB and writes of any size, expedited or by segments. It uses a drive's second channel, which is there
// for the PC, and the default channel of every other node.
class ObjectAccess {
 public:
  // Time-out of each message. Set by hand (2026-11-24): ten control cycles.
  static constexpr std::uint64_t kTimeout_us = 100'000;
  // Time-out of each segment of a write, before which the node may have to erase flash: that of
  // tools::SdoTransfer.
  static constexpr std::uint64_t kStoreTimeout_us = 1'000'000;
  static constexpr std::size_t kMaxBytes = 4096;

  // The sink must outlive this. A bus that other processes serve needs a longer time-out.
  explicit ObjectAccess(canopen::FrameSink& sink, std::uint64_t timeout_us = kTimeout_us)
      : sink_(sink), timeout_us_(timeout_us) {}

  void request(ObjectRequest request) { waiting_.push_back(std::move(request)); }
  // Before all that wait.
  void request_first(ObjectRequest request) { waiting_.push_front(std::move(request)); }
  // Checks the time-out and begins the next access. Call it once per millisecond.
  void process(std::uint64_t now_us);
  // Takes every frame from the bus. True when it belongs to the access under way.
  bool on_frame(const hal::CanFrame& frame, std::uint64_t time_us);
  bool busy() const { return active_.has_value(); }
  // Returns the answers since the last call, in the order of the requests.
  [[nodiscard]] std::vector<ObjectAnswer> take_answers() { return std::exchange(answers_, {}); }

  void archive(sim_board::StateArchive& archive);

 private:
  using Data = std::array<std::uint8_t, 8>;

  void begin(std::uint64_t now_us);
  void send(const Data& data, std::uint64_t now_us);
  void request_segment(std::uint64_t now_us);
  void send_segment(std::uint64_t now_us);
  void accept(const Data& answer, std::uint64_t time_us);
  void accept_written(const Data& answer, std::uint64_t time_us);
  void accept_segment(const Data& answer, std::uint64_t time_us);
  void abort(canopen::AbortCode code, std::uint64_t time_us);
  void end(canopen::AbortCode code, std::uint64_t time_us);

  canopen::FrameSink& sink_;
  const std::uint64_t timeout_us_;
  std::deque<ObjectRequest> waiting_;
  std::optional<ObjectRequest> active_;
  std::vector<ObjectAnswer> answers_;
  std::vector<std::uint8_t> read_;  // bytes of the read under way
  std::size_t written_ = 0;         // bytes of the write under way that were sent
  std::uint8_t toggle_ = 0;
  bool segmented_ = false;
  std::uint64_t deadline_us_ = 0;
};

}  // namespace koboshi::simulation
