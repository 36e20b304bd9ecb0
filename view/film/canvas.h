#pragma once

#include <cairo.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "view/recording/recording.h"

namespace koboshi::view {

// A picture in memory on which text and simple shapes are drawn. Positions are in pixels from the upper left
// corner.
class Canvas {
 public:
  // A white picture.
  Canvas(int width_px, int height_px);

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  // Rows from the top, four bytes a pixel: blue, green, red, unused. Between begin and end of the caller's
  // writing nothing may be drawn.
  std::span<std::uint8_t> begin_pixels();
  void end_pixels();
  std::span<const std::uint8_t> pixels() const;

  enum class Weight { kNormal, kBold };
  // The baseline of the text starts at x, y.
  void text(double x, double y, double size_px, const std::string& text, const Colour& colour,
            double opacity = 1.0, Weight weight = Weight::kNormal);
  double text_width_px(double size_px, const std::string& text, Weight weight = Weight::kNormal);
  // The text, cut and with an ellipsis if it is wider than this.
  std::string fitting(double size_px, const std::string& text, double width_px);
  void rounded_box(double x, double y, double width, double height, double radius, const Colour& colour,
                   double opacity);
  void disc(double x, double y, double radius, const Colour& colour);
  void line(double x1, double y1, double x2, double y2, double width, const Colour& colour);
  void paste(const Canvas& other, double x, double y);

  // The picture as a PNG file.
  std::string png() const;

 private:
  struct Delete {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };
  void choose_font(double size_px, Weight weight);
  void choose_colour(const Colour& colour, double opacity);

  int width_px_;
  int height_px_;
  std::unique_ptr<cairo_surface_t, Delete> surface_;
  std::unique_ptr<cairo_t, Delete> context_;
};

}  // namespace koboshi::view
