#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/port/can.h"
#include "sim_board/can/candump_log.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::bus {

struct TimedFrame {
  sim_board::BusFrame frame;
  std::uint64_t time_us = 0;  // the log's own, or since the live bus was opened
  std::string interface {};   // of a log
  sim_board::Direction direction = sim_board::Direction::kUnknown;

  // Null for a foreign frame.
  const hal::CanFrame* standard() const { return std::get_if<hal::CanFrame>(&frame); }
};

// A sequence of frames, from a log or a live bus.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // Returns the next frame; nothing at the end of a log, after a live bus was silent for this long, or when
  // the user ends the command.
  virtual std::optional<TimedFrame> next(std::uint64_t timeout_us) = 0;
  virtual bool is_live() const = 0;
  // Returns whether frames arrive while one reads: from a live bus or through a pipe, until the user ends it.
  virtual bool is_arriving() const = 0;
  // Returns what the user should know about the part of a log read since the last call, a line for each.
  virtual std::vector<std::string> take_remarks() { return {}; }
};

// Waits until the descriptor is readable or this time has passed. Returns false, and at once, when the user
// ends the command.
using WaitForInput = std::function<bool(int descriptor, std::uint64_t timeout_us)>;

// A log and how to read it.
struct LogChoice {
  std::filesystem::path
      place;  // a log of can-utils, the folder of a run with its can.log, or - for standard input
  std::string interface {};  // only frames of this one; empty: of all
  sim_board::CandumpReader::Times times = sim_board::CandumpReader::Times::kRecognised;
};

// Opens a log. Throws InputError, also at the end of a log with frames of other interfaces only.
std::unique_ptr<FrameSource> open_log(const LogChoice& log, const WaitForInput& wait = {});

// Returns the interfaces in a log, in the order of their first frames; none for a pipe. Reads up to the first
// line that is neither a frame nor a comment.
std::vector<std::string> interfaces_of(const LogChoice& log);
// The same for a command that must not begin with a log that it cannot read to its end. Throws
// InputError for such a log, and where there are frames, but none of the chosen interface.
std::vector<std::string> check_log(const LogChoice& log);

// Reads the frames that arrive on a transport, which must outlive the source.
std::unique_ptr<FrameSource> listen_to(sim_board::Transport& transport, const WaitForInput& wait = {});

// Sends a frame, and waits up to a second for room. Throws std::runtime_error if there is none.
void send_surely(sim_board::Transport& transport, const hal::CanFrame& frame);

// Waits until a frame may have arrived on a transport, or this time has passed.
void wait_for_frames(const sim_board::Transport& transport, std::uint64_t timeout_us);

}  // namespace koboshi::bus
