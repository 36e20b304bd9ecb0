#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "hal/port/can.h"
#include "hal/port/fifo.h"

namespace koboshi::hal {

// A CAN controller on an infinitely fast bus: frames are sent at once unless the test limits it.
class FakeCan final : public CanPort {
 public:
  static constexpr std::size_t kReceiveCapacity = 64;
  static constexpr std::size_t kTransmitCapacity = 64;

  // --- Functions for tests ---

  // Delivers a frame. If the receive ring is full, it is lost and counted.
  void deliver(const CanFrame& frame) {
    if (received_.push(frame)) return;
    if (status_.receive_overruns < std::numeric_limits<std::uint16_t>::max()) ++status_.receive_overruns;
  }
  // Returns all frames sent since the start or the last `clear_sent`, in order.
  [[nodiscard]] const std::vector<CanFrame>& sent() const { return sent_; }
  // Returns the latest sent frame with this identifier, if any.
  [[nodiscard]] std::optional<CanFrame> last_sent(std::uint16_t identifier) const {
    const auto found = std::find_if(sent_.rbegin(), sent_.rend(), [identifier](const CanFrame& frame) {
      return frame.identifier == identifier;
    });
    return found == sent_.rend() ? std::nullopt : std::optional<CanFrame>(*found);
  }
  void clear_sent() { sent_.clear(); }
  // Stalls the bus: each FIFO takes this many more frames and then refuses, until `release_transmit`.
  void limit_transmit(std::size_t frames) { transmit_limits_.fill(frames); }
  // Stalls one FIFO, as traffic of other nodes with lower identifiers would.
  void limit_transmit(TransmitFifo fifo, std::size_t frames) { transmit_limits_[fifo] = frames; }
  void release_transmit() { transmit_limits_.fill(std::nullopt); }
  void set_error_state(CanErrorState state) { status_.state = state; }
  void set_error_counts(std::uint8_t transmit, std::uint8_t receive) {
    status_.transmit_error_count = transmit;
    status_.receive_error_count = receive;
  }
  // Returns the number of recoveries from bus-off that the firmware has started. The state stays until the
  // test changes it.
  [[nodiscard]] int recoveries() const { return recoveries_; }

  // --- CanPort ---

  [[nodiscard]] bool receive(CanFrame& frame) override { return received_.pop(frame); }
  [[nodiscard]] bool transmit(const CanFrame& frame) override {
    auto& limit = transmit_limits_[transmit_fifo(frame)];
    if (limit == 0) return false;
    if (limit) --*limit;
    sent_.push_back(frame);
    return true;
  }
  [[nodiscard]] std::size_t transmit_space(TransmitFifo fifo) const override {
    return transmit_limits_[fifo].value_or(kTransmitCapacity);
  }
  [[nodiscard]] bool transmit_pending(TransmitFifo fifo) const override {
    return transmit_limits_[fifo] == 0;
  }
  [[nodiscard]] CanStatus status() const override { return status_; }
  void recover() override {
    if (status_.state == CanErrorState::kBusOff) ++recoveries_;
  }

 private:
  Fifo<CanFrame, kReceiveCapacity> received_;
  std::vector<CanFrame> sent_;
  std::array<std::optional<std::size_t>, kTransmitFifos> transmit_limits_;  // by TransmitFifo
  CanStatus status_;
  int recoveries_ = 0;
};

}  // namespace koboshi::hal
