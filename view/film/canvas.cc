#include "view/film/canvas.h"

#include <cstddef>
#include <numbers>
#include <stdexcept>

namespace koboshi::view {
namespace {

constexpr const char* kFont = "DejaVu Sans";

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("the picture cannot be drawn: ") + cairo_status_to_string(status));
}

cairo_status_t append(void* closure, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

bool continues_letter(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }  // UTF-8

}  // namespace

Canvas::Canvas(int width_px, int height_px)
    : width_px_(width_px),
      height_px_(height_px),
      surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px)) {
  check(cairo_surface_status(surface_.get()));
  context_.reset(cairo_create(surface_.get()));
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context_.get(), options);
  cairo_font_options_destroy(options);
  cairo_set_source_rgb(context_.get(), 1.0, 1.0, 1.0);
  cairo_paint(context_.get());
}

std::span<std::uint8_t> Canvas::begin_pixels() {
  cairo_surface_flush(surface_.get());
  return {cairo_image_surface_get_data(surface_.get()),
          4 * static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_)};
}

void Canvas::end_pixels() { cairo_surface_mark_dirty(surface_.get()); }

std::span<const std::uint8_t> Canvas::pixels() const {
  cairo_surface_flush(surface_.get());
  return {cairo_image_surface_get_data(surface_.get()),
          4 * static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_)};
}

void Canvas::choose_font(double size_px, Weight weight) {
  cairo_select_font_face(context_.get(), kFont, CAIRO_FONT_SLANT_NORMAL,
                         weight == Weight::kBold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context_.get(), size_px);
}

void Canvas::choose_colour(const Colour& colour, double opacity) {
  cairo_set_source_rgba(context_.get(), static_cast<double>(colour.red), static_cast<double>(colour.green),
                        static_cast<double>(colour.blue), opacity);
}

void Canvas::text(double x, double y, double size_px, const std::string& text, const Colour& colour,
                  double opacity, Weight weight) {
  choose_font(size_px, weight);
  choose_colour(colour, opacity);
  cairo_move_to(context_.get(), x, y);
  cairo_show_text(context_.get(), text.c_str());
  check(cairo_status(context_.get()));
}

double Canvas::text_width_px(double size_px, const std::string& text, Weight weight) {
  choose_font(size_px, weight);
  cairo_text_extents_t extents;
  cairo_text_extents(context_.get(), text.c_str(), &extents);
  return extents.x_advance;
}

std::string Canvas::fitting(double size_px, const std::string& text, double width_px) {
  if (text_width_px(size_px, text) <= width_px) return text;
  std::string shorter = text;
  while (!shorter.empty() && text_width_px(size_px, shorter + "…") > width_px) {
    while (shorter.size() > 1 && continues_letter(shorter.back())) shorter.pop_back();
    shorter.pop_back();
  }
  return shorter + "…";
}

void Canvas::rounded_box(double x, double y, double width, double height, double radius, const Colour& colour,
                         double opacity) {
  cairo_t* context = context_.get();
  constexpr double kQuarter = std::numbers::pi / 2.0;
  cairo_new_sub_path(context);
  cairo_arc(context, x + width - radius, y + radius, radius, -kQuarter, 0.0);
  cairo_arc(context, x + width - radius, y + height - radius, radius, 0.0, kQuarter);
  cairo_arc(context, x + radius, y + height - radius, radius, kQuarter, 2.0 * kQuarter);
  cairo_arc(context, x + radius, y + radius, radius, 2.0 * kQuarter, 3.0 * kQuarter);
  cairo_close_path(context);
  choose_colour(colour, opacity);
  cairo_fill(context);
}

void Canvas::disc(double x, double y, double radius, const Colour& colour) {
  cairo_new_sub_path(context_.get());
  cairo_arc(context_.get(), x, y, radius, 0.0, 2.0 * std::numbers::pi);
  choose_colour(colour, 1.0);
  cairo_fill(context_.get());
}

void Canvas::line(double x1, double y1, double x2, double y2, double width, const Colour& colour) {
  choose_colour(colour, 1.0);
  cairo_set_line_width(context_.get(), width);
  cairo_move_to(context_.get(), x1, y1);
  cairo_line_to(context_.get(), x2, y2);
  cairo_stroke(context_.get());
}

void Canvas::paste(const Canvas& other, double x, double y) {
  cairo_set_source_surface(context_.get(), other.surface_.get(), x, y);
  cairo_paint(context_.get());
}

std::string Canvas::png() const {
  std::string file;
  check(cairo_surface_write_to_png_stream(surface_.get(), append, &file));
  return file;
}

}  // namespace koboshi::view
