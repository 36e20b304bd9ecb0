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
  std::uint64_t time_us = 0;  // of a log, its own; of a live bus, since it was opened
};

// Frames from a log or a live bus, in their order.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // The next frame; nothing at the end of a log, or when a live bus was silent for so long.
  virtual std::optional<TimedFrame> next(std::uint64_t timeout_us) = 0;
  virtual bool is_live() const = 0;
};

// A log as of candump -L, or the folder of a run, whose can.log it takes. Throws sim::InputError.
std::unique_ptr<FrameSource> open_log(const std::filesystem::path& place);

// What comes in on a transport, which must outlive the source.
std::unique_ptr<FrameSource> listen_to(sim::Transport& transport);

// Hands over a frame at once, waiting for room as long as a second. Throws std::runtime_error where there is
// none.
void send_surely(sim::Transport& transport, const hal::CanFrame& frame);

// Waits until something may have come in on a transport, or this time has passed.
void wait_for_frames(const sim::Transport& transport, std::uint64_t timeout_us);

}  // namespace koboshi::tools
