#include "view/film/offscreen.h"

#define EGL_NO_X11 1
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "view/render/gl.h"

namespace koboshi::view {
namespace {

constexpr GLint kSamples = 4;  // what llvmpipe supports
constexpr const char* kNeeds = ", which pictures need (apt install libegl1 libgl1-mesa-dri)";

[[noreturn]] void fail(const std::string& what) {
  throw GlError(what + kNeeds + ", EGL error " + std::to_string(eglGetError()));
}

}  // namespace

OffscreenContext::OffscreenContext()
    : display_(eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)) {
  if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) == EGL_FALSE)
    fail("there is no EGL without a display");
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) fail("EGL offers no OpenGL");
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               3,
                               EGL_CONTEXT_MINOR_VERSION,
                               3,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context_ == EGL_NO_CONTEXT) fail("EGL offers no OpenGL 3.3");
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
    fail("EGL offers no OpenGL without a surface");
}

OffscreenContext::~OffscreenContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
}

struct OffscreenFramebuffer::Parts {
  GlFramebuffer smooth = make_framebuffer();
  GlRenderbuffer colour = make_renderbuffer();
  GlRenderbuffer depth = make_renderbuffer();
  GlFramebuffer resolved = make_framebuffer();
  GlRenderbuffer pixels = make_renderbuffer();
};

OffscreenFramebuffer::OffscreenFramebuffer(int width_px, int height_px)
    : width_px_(width_px), height_px_(height_px), parts_(std::make_unique<Parts>()) {
  GLint samples = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &samples);
  samples = std::min(samples, kSamples);
  const auto attach = [&](const GlRenderbuffer& buffer, GLint of_samples, GLenum format, GLenum place) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer.name());
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, of_samples, format, width_px, height_px);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer.name());
  };
  glBindFramebuffer(GL_FRAMEBUFFER, parts_->smooth.name());
  attach(parts_->colour, samples, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  attach(parts_->depth, samples, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
  const GLenum smooth = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  glBindFramebuffer(GL_FRAMEBUFFER, parts_->resolved.name());
  attach(parts_->pixels, 0, GL_RGBA8, GL_COLOR_ATTACHMENT0);
  const GLenum resolved = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (smooth != GL_FRAMEBUFFER_COMPLETE || resolved != GL_FRAMEBUFFER_COMPLETE || glGetError() != GL_NO_ERROR)
    throw GlError("OpenGL supports no picture of " + std::to_string(width_px) + "x" +
                  std::to_string(height_px));
}

OffscreenFramebuffer::~OffscreenFramebuffer() = default;

void OffscreenFramebuffer::bind() const { glBindFramebuffer(GL_FRAMEBUFFER, parts_->smooth.name()); }

void OffscreenFramebuffer::read(std::span<std::uint8_t> pixels) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, parts_->smooth.name());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, parts_->resolved.name());
  glBlitFramebuffer(0, 0, width_px_, height_px_, 0, 0, width_px_, height_px_, GL_COLOR_BUFFER_BIT,
                    GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, parts_->resolved.name());
  read_pixels(width_px_, height_px_, pixels);
  const auto row_bytes = static_cast<std::ptrdiff_t>(4) * width_px_;
  for (int row = 0; row < height_px_ / 2; ++row) {  // OpenGL's rows begin at the bottom
    const auto upper = pixels.begin() + row * row_bytes;
    std::swap_ranges(upper, upper + row_bytes, pixels.begin() + (height_px_ - 1 - row) * row_bytes);
  }
}

}  // namespace koboshi::view
