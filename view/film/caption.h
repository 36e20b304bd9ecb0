#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "view/film/canvas.h"
#include "view/recording/recording.h"
#include "view/render/overlay.h"

namespace koboshi::view {

// The text of a picture.
struct Caption {
  struct Key {
    Colour colour;
    std::string text;
  };
  std::string time;   // empty: none, like all that follow
  std::string title;  // scenario and speed
  std::string state;
  std::string event_time;
  std::string event;
  double event_opacity = 0.0;
  std::vector<Key> keys;           // meaning of the marks
  double force_scale_m_per_N = 0;  // with a scale of forces, if positive
};

// The caption of an instant. `speed` is that of a film, 1 otherwise.
Caption caption_at(const Recording& recording, const Overlays& overlays, std::uint64_t time_us, double speed);

// Draws it into the corners: time, title and state above, event and legend below. `px_per_m` is the scale at
// the camera's target.
void draw_caption(Canvas& canvas, const Caption& caption, double px_per_m);

// A time as captions show it: "3.20 s".
std::string time_text(std::uint64_t time_us);

}  // namespace koboshi::view
