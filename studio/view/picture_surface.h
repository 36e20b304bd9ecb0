#pragma once

#include <QImage>
#include <QSize>
#include <cstdint>
#include <memory>

#include "studio/view/gl_context.h"
#include "studio/view/robot_picture.h"
#include "studio/view/scaled_framebuffer.h"
#include "view/render/renderer.h"

namespace koboshi::studio {

// Draws pictures of a robot into images with OpenGL. It needs a QGuiApplication, and OpenGL from the first
// picture on.
class PictureSurface {
 public:
  PictureSurface() = default;
  ~PictureSurface();
  PictureSurface(const PictureSurface&) = delete;
  PictureSurface& operator=(const PictureSurface&) = delete;

  // Draws the picture with these marks. Throws std::runtime_error.
  QImage draw(const RobotPicture& picture, view::Marks marks, QSize size_px);

 private:
  std::unique_ptr<GlContext> gl_;  // before everything that is made in it
  std::unique_ptr<view::Renderer> renderer_;
  std::uint64_t scene_version_ = 0;  // of the renderer
  std::unique_ptr<ScaledFramebuffer> framebuffer_;
};

}  // namespace koboshi::studio
