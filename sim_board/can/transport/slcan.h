#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "hal/linux/file_descriptor.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::sim {

// The adapter's side of Lawicel's ASCII protocol (CANUSB manual, "CANUSB ASCII commands"; Linux: slcan),
// without the serial line: commands in, answers and frames out.
class SlcanProtocol {
 public:
  // What the host wrote. Returns what it is answered; frames to send are in frames().
  std::string take(std::string_view text);
  // A frame as the host gets it; empty while the host has not opened the channel. `time_us` for the stamp
  // that a host may ask for.
  std::string line_of(const hal::CanFrame& frame, std::uint64_t time_us) const;
  std::deque<hal::CanFrame>& frames() { return frames_; }
  bool is_open() const { return open_; }

 private:
  std::string obey(std::string_view command);
  std::string transmit(std::string_view command);

  static constexpr std::size_t kLongestCommand = 32;

  std::string command_;  // as far as it has come
  bool open_ = false;
  bool listens_only_ = false;
  bool stamps_ = false;
  std::deque<hal::CanFrame> frames_;
};

// An adapter on a pseudo-terminal: slcand, python-can's slcan and any program that speaks to a CANUSB find it
// at place().
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
  hal::FileDescriptor terminal_;  // kept open, so that hosts may come and go
  std::string place_;
  SlcanProtocol protocol_;
  std::string unsent_;  // the rest of a line that the terminal had no room for
};

}  // namespace koboshi::sim
