#pragma once

#include <linux/can.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "hal/linux/file_descriptor.h"
#include "hal/linux/socket_option.h"
#include "hal/port/can.h"

namespace koboshi::hal {

// A raw socket on a CAN interface of Linux. Nothing blocks. What this socket sends, it does not hear; other
// sockets of the machine do. Frames go to and come from the kernel many at a time: a system call for each
// costs more than the frame.
class SocketCan {
 public:
  static constexpr std::size_t kBatch = 64;

  // Throws std::system_error where the kernel knows no CAN, no such interface, or the interface is down.
  explicit SocketCan(const std::string& interface);

  // Keeps the frame for the next flush. False when there is no room for it: it is lost.
  [[nodiscard]] bool send(const CanFrame& frame);
  // Hands over what was kept, in its order. What the interface has no room for stays and is tried again.
  void flush();
  // The oldest received frame. Frames with 29-bit identifiers and error frames are passed over. Throws
  // std::system_error when the interface is gone or down.
  [[nodiscard]] std::optional<CanFrame> receive();
  // Frames that the kernel had no room for in this socket's buffer.
  std::uint64_t dropped() const { return drops(socket_); }
  // What poll() may wait for.
  int descriptor() const { return socket_.number(); }

 private:
  bool fetch();

  FileDescriptor socket_;
  std::array<can_frame, kBatch> outgoing_{};
  std::size_t outgoing_count_ = 0;
  std::array<can_frame, kBatch> incoming_{};
  std::size_t incoming_count_ = 0;
  std::size_t incoming_next_ = 0;
};

}  // namespace koboshi::hal
