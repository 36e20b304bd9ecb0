#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "hal/port/can.h"
#include "sim_board/can/transport/transport.h"

namespace koboshi::tools {

struct TimedFrame {
  hal::CanFrame frame;
  std::uint64_t time_us = 0;  // the log's own, or since the live bus was opened
};

// A sequence of frames, from a log or a live bus.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // Returns the next frame; nothing at the end of a log, or after a live bus was silent for this long.
  virtual std::optional<TimedFrame> next(std::uint64_t timeout_us) = 0;
  virtual bool is_live() const = 0;
};

// Opens a log of candump -L, or the can.log in the folder of a run. Throws sim::InputError.
std::unique_ptr<FrameSource> open_log(const std::filesystem::path& place);

// Reads the frames that arrive on a transport, which must outlive the source.
std::unique_ptr<FrameSource> listen_to(sim::Transport& transport);

// Sends a frame, and waits up to a second for room. Throws std::runtime_error if there is none.
void send_surely(sim::Transport& transport, const hal::CanFrame& frame);

// Waits until a frame may have arrived on a transport, or this time has passed.
void wait_for_frames(const sim::Transport& transport, std::uint64_t timeout_us);

}  // namespace koboshi::tools
