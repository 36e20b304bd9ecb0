#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/linux/file_descriptor.h"
#include "hal/port/can.h"

namespace koboshi::hal {

// A raw socket on a CAN interface of Linux. Nothing blocks. What this socket sends, it does not hear; other
// sockets of the machine do.
class SocketCan {
 public:
  // Throws std::system_error where the kernel knows no CAN, no such interface, or the interface is down.
  explicit SocketCan(const std::string& interface);

  // False when the interface has no room: the frame is not sent.
  [[nodiscard]] bool send(const CanFrame& frame);
  // The oldest received frame. Frames with 29-bit identifiers and error frames are passed over. Throws
  // std::system_error when the interface is gone or down.
  [[nodiscard]] std::optional<CanFrame> receive();
  // What poll() may wait for.
  int descriptor() const { return socket_.number(); }

 private:
  FileDescriptor socket_;
};

}  // namespace koboshi::hal
