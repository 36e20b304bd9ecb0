#include "view/film/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <system_error>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "view/film/canvas.h"
#include "view/film/caption.h"
#include "view/film/encoder.h"
#include "view/film/instants.h"
#include "view/film/offscreen.h"
#include "view/render/playback.h"
#include "view/render/renderer.h"

namespace koboshi::view {
namespace {

constexpr float kTranslucent = 0.38F;
constexpr int kMaxStrip_px = 32000;         // width; Cairo's limit is 32767
constexpr std::size_t kPaletteFrames = 40;  // of a film, from which the palette of a GIF is computed

enum class Kind { kPicture, kStrip, kVideo, kAnimation };

struct Size {
  int width_px;
  int height_px;
};

Size default_size(Kind kind) {
  switch (kind) {
    case Kind::kStrip:
      return {400, 440};
    case Kind::kAnimation:
      return {640, 360};
    default:
      return {1280, 720};
  }
}

Kind kind_of(const FilmOptions& options) {
  const std::string extension = extension_of(options.out);
  if (extension == ".png")
    return options.instants > 0 || options.at_s.size() > 1 ? Kind::kStrip : Kind::kPicture;
  if (extension == ".mp4") return Kind::kVideo;
  if (extension == ".gif" || extension == ".webp") return Kind::kAnimation;
  throw InputError("--out", 0, one_line(options.out.string()),
                   "a file with the extension .mp4, .gif, .webp or .png");
}

// A time that an option gives.
std::uint64_t time_us(const Recording& recording, const char* option, double time_s) {
  const double end_s = 1e-6 * static_cast<double>(recording.samples.back().time_us);
  if (!(time_s >= 0.0 && time_s <= end_s))
    throw InputError(option, 0, number_text(time_s) + " s",
                     fmt::format("a time of the recording, 0 to {} s", number_text(end_s)));
  return static_cast<std::uint64_t>(std::llround(1e6 * time_s));
}

Interval shown_interval(const Recording& recording, const FilmOptions& options) {
  Interval shown{recording.samples.front().time_us, recording.samples.back().time_us};
  if (options.from_s) shown.from_us = time_us(recording, "--from", *options.from_s);
  if (options.to_s) shown.to_us = time_us(recording, "--to", *options.to_s);
  if (shown.from_us > shown.to_us)
    throw InputError("--to", 0, time_text(shown.to_us), "a time after --from " + time_text(shown.from_us));
  return shown;
}

// The checked plan of the drawing.
struct Plan {
  Kind kind;
  Size size;
  Interval shown;
  double frames_per_s;
  std::vector<std::uint64_t> times_us;
};

Plan plan_of(const Recording& recording, const FilmOptions& options) {
  Plan plan{};
  plan.kind = kind_of(options);
  if (recording.samples.empty()) throw InputError("RUN", 0, "a recording without samples", "a run");
  const bool film = plan.kind == Kind::kVideo || plan.kind == Kind::kAnimation;
  if (film && (!options.at_s.empty() || options.instants > 0))
    throw InputError(options.at_s.empty() ? "--frames" : "--at", 0, "a film, " + options.out.string(),
                     "a .png file, or --from and --to");
  if (!film && options.at_s.empty() && options.instants == 0)
    throw InputError("--out", 0, options.out.string() + " without --at and --frames",
                     "one of them, which say which instants to draw");
  const Size usual = default_size(plan.kind);
  plan.size = options.width_px > 0 ? Size{options.width_px, options.height_px} : usual;
  if (plan.kind == Kind::kVideo && (plan.size.width_px % 2 != 0 || plan.size.height_px % 2 != 0))
    throw InputError("--size", 0, fmt::format("{}x{}", plan.size.width_px, plan.size.height_px),
                     "even numbers, which H.264 needs");
  plan.shown = shown_interval(recording, options);
  plan.frames_per_s = options.frames_per_s.value_or(plan.kind == Kind::kAnimation ? 20.0 : 30.0);
  if (film) {
    plan.times_us = film_times_us(plan.shown, plan.frames_per_s, options.speed);
  } else if (options.instants > 0) {
    plan.times_us = strip_times_us(plan.shown, options.instants);
  } else {
    for (const double at_s : options.at_s) plan.times_us.push_back(time_us(recording, "--at", at_s));
    const auto [first, last] = std::ranges::minmax(plan.times_us);
    plan.shown = {first, last};
  }
  return plan;
}

// Draws instants of a recording.
class Painter {
 public:
  Painter(const Recording& recording, const FilmOptions& options, const Plan& plan)
      : recording_(recording),
        options_(options),
        plan_(plan),
        overlays_(caption_overlays(options, plan)),
        renderer_(recording.scene),
        framebuffer_(plan.size.width_px, plan.size.height_px),
        path_(recording, options.camera, plan.shown,
              static_cast<double>(plan.size.width_px) / plan.size.height_px),
        marks_(recording, options.overlays) {}

  void paint(std::uint64_t time_us, Canvas& canvas) {
    Picture picture{path_.at(time_us), poses_at(recording_, time_us), marks_.at(time_us), options_.collisions,
                    options_.translucent ? kTranslucent : 1.0F};
    framebuffer_.bind();
    renderer_.draw(picture, plan_.size.width_px, plan_.size.height_px);
    framebuffer_.read(canvas.begin_pixels());
    canvas.end_pixels();
    const double half_height_m = picture.camera.distance_m * std::tan(0.5 * picture.camera.field_of_view_rad);
    draw_caption(canvas, caption_at(recording_, overlays_, time_us, speed()),
                 0.5 * plan_.size.height_px / half_height_m);
  }

 private:
  // A strip has its times below, and no room for more.
  static Overlays caption_overlays(const FilmOptions& options, const Plan& plan) {
    return plan.kind == Kind::kStrip ? Overlays() : options.overlays;
  }
  double speed() const {
    return plan_.kind == Kind::kVideo || plan_.kind == Kind::kAnimation ? options_.speed : 1.0;
  }

  const Recording& recording_;
  const FilmOptions& options_;
  const Plan& plan_;
  Overlays overlays_;
  OffscreenContext context_;
  Renderer renderer_;
  OffscreenFramebuffer framebuffer_;
  CameraPath path_;
  OverlayMarks marks_;
};

void write_picture(Painter& painter, const Plan& plan, const FilmOptions& options) {
  Canvas canvas(plan.size.width_px, plan.size.height_px);
  painter.paint(plan.times_us.front(), canvas);
  write_whole_file(options.out, canvas.png());
}

void write_strip(Painter& painter, const Plan& plan, const FilmOptions& options,
                 const FilmProgress& progress) {
  const int count = static_cast<int>(plan.times_us.size());
  const bool with_times = options.overlays.has(Overlay::kTime);
  const StripLayout layout = strip_layout(count, plan.size.width_px, plan.size.height_px, with_times);
  if (layout.width_px > kMaxStrip_px)
    throw InputError("--size", 0, fmt::format("a strip of {} pixels", layout.width_px),
                     fmt::format("at most {}", kMaxStrip_px));
  Canvas strip(layout.width_px, layout.height_px);
  Canvas tile(plan.size.width_px, plan.size.height_px);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t time_us = plan.times_us[static_cast<std::size_t>(i)];
    painter.paint(time_us, tile);
    strip.paste(tile, layout.left_px(i), 0.0);
    const std::string text = time_text(time_us);
    if (with_times)
      strip.text(layout.centre_px(i) - 0.5 * strip.text_width_px(layout.text_px, text), layout.baseline_px,
                 layout.text_px, text, {0.25F, 0.27F, 0.30F});
    progress(i + 1, count);
  }
  write_whole_file(options.out, strip.png());
}

// A file that is removed at the end.
class PaletteFile {
 public:
  explicit PaletteFile(const std::filesystem::path& film) : path_(film) { path_ += ".palette.png"; }
  ~PaletteFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  PaletteFile(const PaletteFile&) = delete;
  PaletteFile& operator=(const PaletteFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void write_film(Painter& painter, const Plan& plan, const FilmOptions& options,
                const FilmProgress& progress) {
  const int total = static_cast<int>(plan.times_us.size());
  int done = 0;
  const Encoder::Film film{options.out, plan.size.width_px, plan.size.height_px, plan.frames_per_s,
                           [&] { progress(done, total); }};
  Canvas canvas(plan.size.width_px, plan.size.height_px);
  const PaletteFile palette(options.out);
  if (extension_of(options.out) == ".gif") {
    Encoder encoder = Encoder::palette_of(film, palette.path());
    const std::size_t step = std::max<std::size_t>(1, plan.times_us.size() / kPaletteFrames);
    for (std::size_t i = 0; i < plan.times_us.size(); i += step) {
      painter.paint(plan.times_us[i], canvas);
      encoder.add(canvas.pixels());
      progress(0, total);
    }
    encoder.finish();
  }
  Encoder encoder(film, palette.path());
  for (int i = 0; i < total; ++i) {
    painter.paint(plan.times_us[static_cast<std::size_t>(i)], canvas);
    encoder.add(canvas.pixels());
    progress(done = i + 1, total);
  }
  encoder.finish();
}

}  // namespace

void render(const Recording& recording, const FilmOptions& options, const FilmProgress& progress) {
  const Plan plan = plan_of(recording, options);
  Painter painter(recording, options, plan);
  switch (plan.kind) {
    case Kind::kPicture:
      return write_picture(painter, plan, options);
    case Kind::kStrip:
      return write_strip(painter, plan, options, progress);
    default:
      return write_film(painter, plan, options, progress);
  }
}

}  // namespace koboshi::view
