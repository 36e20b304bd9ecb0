#include "view/film/instants.h"

#include <algorithm>
#include <cmath>

namespace koboshi::view {

std::vector<std::uint64_t> film_times_us(const Interval& shown, double frames_per_s, double speed) {
  std::vector<std::uint64_t> times_us;
  const double step_us = 1e6 * speed / frames_per_s;
  for (int i = 0;; ++i) {
    const auto time_us = shown.from_us + static_cast<std::uint64_t>(std::llround(i * step_us));
    if (i > 0 && time_us >= shown.to_us) return times_us;
    times_us.push_back(time_us);
  }
}

std::vector<std::uint64_t> strip_times_us(const Interval& shown, int count) {
  std::vector<std::uint64_t> times_us;
  const double span_us = static_cast<double>(shown.to_us - shown.from_us);
  for (int i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / (count - 1) : 0.0;
    times_us.push_back(shown.from_us + static_cast<std::uint64_t>(std::llround(share * span_us)));
  }
  return times_us;
}

StripLayout strip_layout(int count, int tile_width_px, int tile_height_px, bool with_times) {
  StripLayout layout;
  layout.tile_width_px = tile_width_px;
  layout.gap_px = std::max(2, tile_width_px / 80);
  layout.width_px = layout.left_px(count) - layout.gap_px;
  layout.text_px = std::clamp(tile_width_px / 18.0, 9.0, 28.0);
  const int line_px = with_times ? static_cast<int>(std::lround(2.0 * layout.text_px)) : 0;
  layout.height_px = tile_height_px + line_px;
  layout.baseline_px = tile_height_px + 1.35 * layout.text_px;
  return layout;
}

}  // namespace koboshi::view
