#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "hal/linux/file_descriptor.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim_board {

// The adapter's side of Lawicel's ASCII protocol (CANUSB manual, "CANUSB ASCII commands"; Linux: slcan)
// without the serial line: converts commands to answers and frames.
class SlcanProtocol {
 public:
  // Processes text from the host. Returns the answers; frames to send are in frames().
  std::string take(std::string_view text);
  // Returns the text of a frame for the host; empty until the host opens the channel. `time_us` gives the
  // time stamp that a host may request.
  std::string line_of(const hal::CanFrame& frame, std::uint64_t time_us) const;
  std::deque<hal::CanFrame>& frames() { return frames_; }
  bool is_open() const { return open_; }

 private:
  std::string obey(std::string_view command);
  std::string transmit(std::string_view command);

  static constexpr std::size_t kMaxCommandLength = 32;

  std::string command_;  // incomplete command
  bool open_ = false;
  bool listens_only_ = false;
  bool stamps_ = false;
  std::deque<hal::CanFrame> frames_;
};

// An adapter on a pseudo-terminal for slcand, python-can's slcan and any other CANUSB program. place() is its
// name.
class Slcan final : public Transport {
 public:
  // Throws std::system_error.
  Slcan();

  bool send(const hal::CanFrame& frame, std::uint64_t time_us) override;
  std::optional<hal::CanFrame> receive() override;
  std::string place() const override { return place_; }
  int descriptor() const override { return adapter_.number(); }

 private:
  void listen();
  bool write_out(std::string_view text);

  hal::FileDescriptor adapter_;
  hal::FileDescriptor terminal_;  // kept open, so that hosts can reconnect
  std::string place_;
  SlcanProtocol protocol_;
  std::string unsent_;  // rest of a line that the terminal had no room for
};

}  // namespace koboshi::sim_board
