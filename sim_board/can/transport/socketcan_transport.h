#pragma once

#include <string>

#include "hal/linux/socketcan.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim {

// A SocketCAN interface of Linux.
class SocketCanTransport final : public Transport {
 public:
  // Throws std::system_error.
  explicit SocketCanTransport(const std::string& interface) : interface_(interface), socket_(interface) {}

  bool send(const hal::CanFrame& frame, std::uint64_t) override { return socket_.send(frame); }
  void flush() override { socket_.flush(); }
  std::optional<hal::CanFrame> receive() override { return socket_.receive(); }
  std::uint64_t dropped() const override { return socket_.dropped(); }
  std::string place() const override { return interface_; }
  int descriptor() const override { return socket_.descriptor(); }
  bool is_slow() const override { return true; }

 private:
  std::string interface_;
  hal::SocketCan socket_;
};

}  // namespace koboshi::sim
