#pragma once

#include <cstdint>
#include <vector>

#include "view/render/camera_path.h"

namespace koboshi::view {

// Times of a film's frames: from the begin of the interval, `speed` / `frames_per_s` apart, before its end;
// at least one.
std::vector<std::uint64_t> film_times_us(const Interval& shown, double frames_per_s, double speed);

// Times evenly over the interval with both ends. One: its begin.
std::vector<std::uint64_t> strip_times_us(const Interval& shown, int count);

// Pictures side by side with a gap between them and a line of text below each.
struct StripLayout {
  int width_px = 0;
  int height_px = 0;
  int gap_px = 0;
  int tile_width_px = 0;
  double text_px = 0.0;      // size of the text
  double baseline_px = 0.0;  // from the top

  int left_px(int tile) const { return tile * (tile_width_px + gap_px); }
  double centre_px(int tile) const { return left_px(tile) + 0.5 * tile_width_px; }
};

// `with_times`: with room for the line of text.
StripLayout strip_layout(int count, int tile_width_px, int tile_height_px, bool with_times);

}  // namespace koboshi::view
