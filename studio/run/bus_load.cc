#include "studio/run/bus_load.h"

#include <algorithm>

#include "sim_board/can/frame_bits.h"

namespace koboshi::studio {

double load_of_frames(std::span<const view::Frame> frames, std::uint64_t time_us, std::uint64_t window_us) {
  const auto first =
      std::ranges::upper_bound(frames, time_us - std::min(time_us, window_us), {}, &view::Frame::end_us);
  const auto last = std::ranges::upper_bound(frames, time_us, {}, &view::Frame::end_us);
  double bits = 0.0;
  for (const view::Frame& frame : std::span(first, last))
    bits += sim_board::frame_bits(frame.frame) + sim_board::kIntermissionBits;
  return bits / static_cast<double>(window_us);
}

}  // namespace koboshi::studio
