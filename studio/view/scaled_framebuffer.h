#pragma once

#include <cstdint>
#include <memory>
#include <span>

namespace koboshi::studio {

// A framebuffer whose picture can be read. The context in which it was made must be current.
class ScaledFramebuffer {
 public:
  ScaledFramebuffer();
  ~ScaledFramebuffer();
  ScaledFramebuffer(const ScaledFramebuffer&) = delete;
  ScaledFramebuffer& operator=(const ScaledFramebuffer&) = delete;

  // Binds it for drawing, with this size. Throws view::GlError.
  void bind(int width_px, int height_px);
  // Reads the picture: rows from the bottom, four bytes a pixel: blue, green, red, opacity. Throws
  // view::GlError.
  void read(std::span<std::uint8_t> pixels) const;

 private:
  struct Parts;  // the headers of OpenGL do not go with Qt's

  std::unique_ptr<Parts> parts_;
  int width_px_ = 0;
  int height_px_ = 0;
};

// Chooses the resolution so that a frame takes its time at most, and the full resolution when the picture
// rests.
class AdaptiveResolution {
 public:
  static constexpr double kLowest = 0.4;

  explicit AdaptiveResolution(double frame_s) : frame_s_(frame_s) {}

  // Share of the window's width and height for the next frame.
  double scale() const { return scale_; }
  // Learns how long a frame of the present scale took.
  void drawn_in(double seconds);

 private:
  double frame_s_;
  double scale_ = 1.0;
};

}  // namespace koboshi::studio
