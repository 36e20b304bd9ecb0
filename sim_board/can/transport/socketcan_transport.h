#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "hal/linux/socketcan.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim_board {

// A SocketCAN interface of Linux.
class SocketCanTransport final : public Transport {
 public:
  // Throws std::system_error.
  explicit SocketCanTransport(const std::string& interface) : interface_(interface), socket_(interface) {}

  bool send(const hal::CanFrame& frame, std::uint64_t) override { return socket_.send(frame); }
  void flush() override { socket_.flush(); }
  std::optional<hal::CanFrame> receive() override { return socket_.receive(); }
  void watch_foreign(TakeForeign take) override {
    if (!take) return socket_.watch_foreign({});
    socket_.watch_foreign(
        [take = std::move(take)](const canfd_frame& frame, bool is_fd) { take(from_kernel(frame, is_fd)); });
  }
  std::uint64_t dropped() const override { return socket_.dropped(); }
  std::string place() const override { return interface_; }
  int descriptor() const override { return socket_.descriptor(); }
  bool is_slow() const override { return true; }

 private:
  static ForeignFrame from_kernel(const canfd_frame& raw, bool is_fd) {
    const bool error = (raw.can_id & CAN_ERR_FLAG) != 0;
    ForeignFrame frame{.kind = error   ? ForeignFrame::Kind::kError
                               : is_fd ? ForeignFrame::Kind::kFd
                                       : ForeignFrame::Kind::kExtended,
                       .extended = !error && (raw.can_id & CAN_EFF_FLAG) != 0,
                       .remote = !error && !is_fd && (raw.can_id & CAN_RTR_FLAG) != 0,
                       .flags = static_cast<std::uint8_t>(is_fd ? raw.flags & (CANFD_BRS | CANFD_ESI) : 0),
                       .size = std::min<std::uint8_t>(raw.len, is_fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN),
                       .identifier = raw.can_id & CAN_EFF_MASK};
    if (!frame.remote) std::copy_n(raw.data, frame.size, frame.data.begin());
    return frame;
  }

  std::string interface_;
  hal::SocketCan socket_;
};

}  // namespace koboshi::sim_board
