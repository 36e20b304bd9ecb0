#include "view/film/caption.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "view/render/playback.h"

namespace koboshi::view {
namespace {

constexpr double kEvent_s = 4.0;      // an event is shown this long
constexpr double kEventFade_s = 0.8;  // and fades at the end
// An event is left of what the camera follows: its feet are in the middle, above the lower edge.
constexpr double kEventWidth = 0.4;  // of the picture's width, with the margin
constexpr std::size_t kEventLines = 3;
constexpr double kShownForce_N = 10.0;
constexpr Colour kInk{0.10F, 0.12F, 0.15F};
constexpr Colour kPale{0.42F, 0.45F, 0.50F};
constexpr Colour kPaper{1.0F, 1.0F, 1.0F};
constexpr double kPaperOpacity = 0.78;

void add_event(Caption& caption, const Recording& recording, std::uint64_t time_us) {
  const auto after = std::ranges::upper_bound(recording.events, time_us, {}, &Event::time_us);
  if (after == recording.events.begin()) return;
  const Event& event = *std::prev(after);
  const double age_s = 1e-6 * static_cast<double>(time_us - event.time_us);
  if (age_s >= kEvent_s) return;
  caption.event_time = time_text(event.time_us);
  caption.event = event.text;
  caption.event_opacity = std::min(1.0, (kEvent_s - age_s) / kEventFade_s);
}

// Only what the recording has: a preview measures nothing.
void add_keys(Caption& caption, const Recording& recording, const Overlays& overlays) {
  const auto add = [&](Overlay overlay, const Colour& colour, const char* text) {
    if (overlays.has(overlay)) caption.keys.push_back({colour, text});
  };
  std::string prefix = "ZMP ";  // of the first one
  for (const ZmpMark& mark : kZmpMarks) {
    if (!overlays.has(Overlay::kZmp) || !find_signal(recording, std::string(mark.signal) + "_x")) continue;
    caption.keys.push_back({mark.colour, std::exchange(prefix, "") + std::string(mark.text)});
  }
  add(Overlay::kCom, kComColour, "centre of mass");
  add(Overlay::kContacts, kContactColour, "contact force");
  add(Overlay::kPushes, kPushColour, "push");
  add(Overlay::kFootprints, kSideColours[0], "left");
  add(Overlay::kFootprints, kSideColours[1], "right footprint");
  add(Overlay::kSupport, kMeasuredColour, "support polygon");
  if (overlays.has(Overlay::kContacts) || overlays.has(Overlay::kPushes))
    caption.force_scale_m_per_N = kForceScale_m_per_N;
}

// Sizes relative to the picture.
struct Sizes {
  double text;
  double small;
  double large;
  double margin;

  explicit Sizes(const Canvas& canvas)
      : text(std::clamp(std::min(canvas.height_px() / 36.0, canvas.width_px() / 52.0), 8.0, 40.0)),
        small(0.82 * text),
        large(1.55 * text),
        margin(1.3 * text) {}
};

void draw_time(Canvas& canvas, const Caption& caption, const Sizes& sizes) {
  double y = sizes.margin + sizes.large;
  double x = sizes.margin;
  if (!caption.time.empty()) {
    canvas.text(x, y, sizes.large, caption.time, kInk, 1.0, Canvas::Weight::kBold);
    x += canvas.text_width_px(sizes.large, "000.00 s", Canvas::Weight::kBold) + 0.6 * sizes.text;
  }
  if (!caption.state.empty()) {
    const double width = canvas.text_width_px(sizes.text, caption.state) + 1.2 * sizes.text;
    const double height = 1.6 * sizes.text;
    canvas.rounded_box(x, y - 1.3 * sizes.text, width, height, 0.5 * height, kMeasuredColour, 0.92);
    canvas.text(x + 0.6 * sizes.text, y - 0.15 * sizes.text, sizes.text, caption.state, kPaper);
  }
  if (!caption.title.empty())
    canvas.text(sizes.margin, y + 1.5 * sizes.text, sizes.small, caption.title, kPale);
}

// The words in at most kEventLines lines of this width; the last one is cut.
std::vector<std::string> wrapped(Canvas& canvas, double size_px, const std::string& text, double width_px) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string& line = lines.back();
    const std::string longer = line.empty() ? word : line + " " + word;
    if (line.empty() || lines.size() == kEventLines || canvas.text_width_px(size_px, longer) <= width_px) {
      line = longer;
    } else {
      lines.push_back(word);
    }
  }
  for (std::string& line : lines) line = canvas.fitting(size_px, line, width_px);
  return lines;
}

// `baseline` is that of the last line.
void draw_event(Canvas& canvas, const Caption& caption, const Sizes& sizes, double baseline) {
  if (caption.event.empty()) return;
  const double time_width = canvas.text_width_px(sizes.text, caption.event_time) + 0.7 * sizes.text;
  const double room = kEventWidth * canvas.width_px() - sizes.margin - 1.4 * sizes.text - time_width;
  const std::vector<std::string> lines = wrapped(canvas, sizes.text, caption.event, room);
  double text_width = 0.0;
  for (const std::string& line : lines)
    text_width = std::max(text_width, canvas.text_width_px(sizes.text, line));
  const double line_height = 1.4 * sizes.text;
  const double first = baseline - line_height * static_cast<double>(lines.size() - 1);
  canvas.rounded_box(sizes.margin, first - 1.45 * sizes.text, time_width + text_width + 1.4 * sizes.text,
                     baseline - first + 2.1 * sizes.text, 0.5 * sizes.text, kPaper,
                     kPaperOpacity * caption.event_opacity);
  const double x = sizes.margin + 0.7 * sizes.text;
  canvas.text(x, first, sizes.text, caption.event_time, kPale, caption.event_opacity);
  for (std::size_t i = 0; i < lines.size(); ++i)
    canvas.text(x + time_width, first + line_height * static_cast<double>(i), sizes.text, lines[i], kInk,
                caption.event_opacity);
}

// Right-aligned, one line.
void draw_legend(Canvas& canvas, const Caption& caption, const Sizes& sizes, double baseline,
                 double px_per_m) {
  if (caption.keys.empty()) return;
  const double spot = 0.32 * sizes.small;
  const double gap = 1.1 * sizes.small;
  double width = 0.0;
  for (const Caption::Key& key : caption.keys)
    width += 3.0 * spot + canvas.text_width_px(sizes.small, key.text) + gap;
  const std::string grid = "grid 0.1 m";
  width += canvas.text_width_px(sizes.small, grid);
  const std::string force = fmt::format("{:.0f} N", kShownForce_N);
  const double force_px = kShownForce_N * caption.force_scale_m_per_N * px_per_m;
  if (force_px > 0.0) width += gap + force_px + 0.5 * sizes.small + canvas.text_width_px(sizes.small, force);
  double x = canvas.width_px() - sizes.margin - width - 0.7 * sizes.text;
  canvas.rounded_box(x - 0.7 * sizes.text, baseline - 1.3 * sizes.text, width + 1.4 * sizes.text,
                     1.9 * sizes.text, 0.5 * sizes.text, kPaper, kPaperOpacity);
  for (const Caption::Key& key : caption.keys) {
    canvas.disc(x + spot, baseline - 0.34 * sizes.small, spot, key.colour);
    x += 3.0 * spot;
    canvas.text(x, baseline, sizes.small, key.text, kPale);
    x += canvas.text_width_px(sizes.small, key.text) + gap;
  }
  if (force_px > 0.0) {
    const double y = baseline - 0.34 * sizes.small;
    canvas.line(x, y, x + force_px, y, 0.16 * sizes.small, kPale);
    for (const double end : {x, x + force_px})
      canvas.line(end, y - 0.25 * sizes.small, end, y + 0.25 * sizes.small, 0.12 * sizes.small, kPale);
    x += force_px + 0.5 * sizes.small;
    canvas.text(x, baseline, sizes.small, force, kPale);
    x += canvas.text_width_px(sizes.small, force) + gap;
  }
  canvas.text(x, baseline, sizes.small, grid, kPale);
}

}  // namespace

std::string time_text(std::uint64_t time_us) {
  return fmt::format("{:.2f} s", 1e-6 * static_cast<double>(time_us));
}

Caption caption_at(const Recording& recording, const Overlays& overlays, std::uint64_t time_us,
                   double speed) {
  Caption caption;
  if (overlays.has(Overlay::kTime)) {
    caption.time = time_text(time_us);
    caption.title = recording.title;
    if (speed != 1.0) caption.title += fmt::format("{}speed {:g}", caption.title.empty() ? "" : ", ", speed);
    if (const auto state = find_signal(recording, "state_name"))
      caption.state = name_of_value(recording, *state, sample_at(recording, time_us));
  }
  if (overlays.has(Overlay::kEvents)) add_event(caption, recording, time_us);
  if (overlays.has(Overlay::kLegend)) add_keys(caption, recording, overlays);
  return caption;
}

void draw_caption(Canvas& canvas, const Caption& caption, double px_per_m) {
  const Sizes sizes(canvas);
  draw_time(canvas, caption, sizes);
  const double bottom = canvas.height_px() - sizes.margin - 0.4 * sizes.text;
  draw_legend(canvas, caption, sizes, bottom, px_per_m);
  draw_event(canvas, caption, sizes, bottom - (caption.keys.empty() ? 0.2 : 2.6) * sizes.text);
}

}  // namespace koboshi::view
