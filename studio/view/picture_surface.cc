#include "studio/view/picture_surface.h"

#include <stdexcept>
#include <utility>

namespace koboshi::studio {

// Objects of OpenGL must be destroyed while its context is current.
PictureSurface::~PictureSurface() {
  try {
    if (gl_) gl_->make_current();
  } catch (const std::runtime_error&) {
    return;  // the display has gone, and everything with it
  }
}

QImage PictureSurface::draw(const RobotPicture& picture, view::Marks marks, QSize size_px) {
  if (!gl_) gl_ = std::make_unique<GlContext>();
  gl_->make_current();
  if (!renderer_ || scene_version_ != picture.scene_version()) {
    renderer_ = std::make_unique<view::Renderer>(picture.scene());
    scene_version_ = picture.scene_version();
  }
  if (!framebuffer_) framebuffer_ = std::make_unique<ScaledFramebuffer>();
  framebuffer_->bind(size_px.width(), size_px.height());
  view::Picture drawn = picture.drawn();
  drawn.marks = std::move(marks);
  renderer_->draw(drawn, size_px.width(), size_px.height());
  QImage image(size_px, QImage::Format_RGB32);
  framebuffer_->read({image.bits(), static_cast<std::size_t>(image.sizeInBytes())});
  return image.mirrored();
}

}  // namespace koboshi::studio
