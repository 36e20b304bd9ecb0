#pragma once

#include <linux/can.h>

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "hal/linux/file_descriptor.h"
#include "hal/linux/socket_option.h"
#include "hal/port/can.h"

namespace koboshi::hal {

// A raw socket on a CAN interface of Linux. No function blocks. Other sockets of the machine receive what
// this socket sends; it does not itself. Frames are exchanged with the kernel in batches, since a system call
// costs more than a frame.
class SocketCan {
 public:
  static constexpr std::size_t kBatch = 64;

  // Throws std::system_error if the kernel has no CAN or no such interface, or if the interface is down.
  explicit SocketCan(const std::string& interface);

  // Buffers the frame until the next flush. Returns false, with the frame lost, if there is no room.
  [[nodiscard]] bool send(const CanFrame& frame);
  // Sends the buffered frames in order. Frames for which the interface has no room stay buffered.
  void flush();
  // Passes frames with 29-bit identifiers, CAN FD frames and error frames that `receive` skips to this
  // function. `is_fd`: in the format of CAN FD. Throws std::system_error if the kernel refuses.
  using TakeForeign = std::function<void(const canfd_frame& frame, bool is_fd)>;
  void watch_foreign(TakeForeign take);
  // Returns the oldest received frame, nothing if there is none. Skips frames with 29-bit identifiers, CAN FD
  // frames and error frames. Throws std::system_error if the interface is gone or down.
  [[nodiscard]] std::optional<CanFrame> receive();
  // Returns the number of frames lost because this socket's buffer was full.
  std::uint64_t dropped() const { return drops(socket_); }
  // Returns the file descriptor, for poll().
  int descriptor() const { return socket_.number(); }

 private:
  bool fetch();

  FileDescriptor socket_;
  std::array<can_frame, kBatch> outgoing_{};
  std::size_t outgoing_count_ = 0;
  TakeForeign take_foreign_;
  std::array<canfd_frame, kBatch> incoming_{};  // classic frames are shorter, with the same beginning
  std::array<bool, kBatch> incoming_is_fd_{};
  std::size_t incoming_count_ = 0;
  std::size_t incoming_next_ = 0;
};

}  // namespace koboshi::hal
