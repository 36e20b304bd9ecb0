#include "studio/view/scaled_framebuffer.h"

#include <algorithm>
#include <cmath>

#include "view/render/gl.h"

namespace koboshi::studio {

struct ScaledFramebuffer::Parts {
  view::GlRenderbuffer colour = view::make_renderbuffer();
  view::GlRenderbuffer depth = view::make_renderbuffer();
  view::GlFramebuffer framebuffer = view::make_framebuffer();
};

ScaledFramebuffer::ScaledFramebuffer() : parts_(std::make_unique<Parts>()) {}
ScaledFramebuffer::~ScaledFramebuffer() = default;

void ScaledFramebuffer::bind(int width_px, int height_px) {
  glBindFramebuffer(GL_FRAMEBUFFER, parts_->framebuffer.name());
  if (width_px == width_px_ && height_px == height_px_) return;
  glBindRenderbuffer(GL_RENDERBUFFER, parts_->colour.name());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width_px, height_px);
  glBindRenderbuffer(GL_RENDERBUFFER, parts_->depth.name());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width_px, height_px);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, parts_->colour.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, parts_->depth.name());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw view::GlError("OpenGL supports no framebuffer of this size");
  width_px_ = width_px;
  height_px_ = height_px;
}

void ScaledFramebuffer::read(std::span<std::uint8_t> pixels) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, parts_->framebuffer.name());
  view::read_pixels(width_px_, height_px_, pixels);
}

// The time of a frame grows with the number of its pixels, the square of the scale; half of a correction at a
// time, so that one slow frame does not show.
void AdaptiveResolution::drawn_in(double seconds) {
  const double wanted = scale_ * std::sqrt(frame_s_ / std::max(seconds, 1e-6));
  scale_ = std::clamp(0.5 * (scale_ + wanted), kLowest, 1.0);
}

}  // namespace koboshi::studio
