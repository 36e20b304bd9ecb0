#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hal/port/can.h"
#include "sim_board/can/foreign_frame.h"

namespace koboshi::sim_board {

// Connects the simulated bus to nodes outside this process. All calls are non-blocking.
class Transport {
 public:
  virtual ~Transport() = default;

  // Sends a frame that was on the bus at this simulated time. Returns false if there is no room; the frame is
  // then lost for the transport's receivers only.
  [[nodiscard]] virtual bool send(const hal::CanFrame& frame, std::uint64_t time_us) = 0;
  // Sends buffered frames. Call it once per millisecond, and after the last frame.
  virtual void flush() {}
  // Passes the foreign frames that `receive` finds before its next frame to this function, as far as the
  // transport carries any. Without it they are skipped.
  using TakeForeign = std::function<void(const ForeignFrame&)>;
  virtual void watch_foreign(TakeForeign) {}
  // Returns the oldest received frame, or nothing.
  [[nodiscard]] virtual std::optional<hal::CanFrame> receive() = 0;
  // Number of incoming frames that the system has dropped because they were not read fast enough, as far as
  // the system reports it.
  virtual std::uint64_t dropped() const { return 0; }
  // Name for users to connect to, such as that of a pseudo-terminal.
  virtual std::string place() const = 0;
  // File descriptor for poll(); -1: none.
  virtual int descriptor() const { return -1; }
  // Returns whether the other side runs in real time, so that the simulation should too.
  virtual bool is_live() const { return true; }
  // Returns whether the calls take long enough to justify a separate thread.
  virtual bool is_slow() const { return false; }
};

// Settings of the transports.
struct TransportOptions {
  bool real_bus = false;  // allows an interface that is neither vcan nor vxcan
  // UDP: the number of routers that pass a datagram, plus one; 0, the default, keeps it on this machine.
  std::optional<std::uint8_t> ttl{};
  std::string interface {};  // UDP: the network interface; empty: the one that the routing table chooses

  friend bool operator==(const TransportOptions&, const TransportOptions&) = default;
};

// Opens a transport by its name:
//   socketcan:vcan0             a Linux interface; only vcan or vxcan unless `real_bus` is set
//   udp:239.74.163.2:43113      python-can's udp_multicast; an IPv6 group is in brackets: udp:[ff15::1]:43113
//   slcan                       Lawicel's ASCII protocol on a pseudo-terminal
//   log:FILE                    writes a log in the format of candump -L
// Returns null for "none". Throws std::invalid_argument for any other name, for a refused bus and for an
// option that the transport does not have, and std::system_error if a system call fails.
std::unique_ptr<Transport> open_transport(const std::string& name, const TransportOptions& options = {});

}  // namespace koboshi::sim_board
