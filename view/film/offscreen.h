#pragma once

#include <cstdint>
#include <memory>
#include <span>

namespace koboshi::view {

// An OpenGL 3.3 core context without display, window and graphics device: EGL on Mesa's surfaceless platform,
// where the processor draws if nothing else can. Current in the thread that makes it until it is destroyed.
class OffscreenContext {
 public:
  // Throws GlError with the packages that it needs.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  void* display_;
  void* context_ = nullptr;
};

// A framebuffer with smooth edges (multisampling) whose picture can be read.
class OffscreenFramebuffer {
 public:
  // Throws GlError for a size that OpenGL does not support.
  OffscreenFramebuffer(int width_px, int height_px);
  ~OffscreenFramebuffer();
  OffscreenFramebuffer(const OffscreenFramebuffer&) = delete;
  OffscreenFramebuffer& operator=(const OffscreenFramebuffer&) = delete;

  // Binds it for drawing.
  void bind() const;
  // Reads the picture: rows from the top, four bytes a pixel: blue, green, red, opacity.
  void read(std::span<std::uint8_t> pixels) const;

 private:
  struct Parts;
  int width_px_;
  int height_px_;
  std::unique_ptr<Parts> parts_;
};

}  // namespace koboshi::view
