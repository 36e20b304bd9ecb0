#include "studio/view/gl_context.h"

#include <QSurfaceFormat>
#include <stdexcept>

namespace koboshi::studio {

GlContext::GlContext() {
  QSurfaceFormat format;
  format.setVersion(3, 3);
  format.setProfile(QSurfaceFormat::CoreProfile);
  surface_.setFormat(format);
  surface_.create();
  context_.setFormat(format);
  if (!context_.create()) throw std::runtime_error("this display offers no OpenGL 3.3, which the view needs");
}

void GlContext::make_current() {
  if (!context_.makeCurrent(&surface_)) throw std::runtime_error("OpenGL is not available for the view");
}

}  // namespace koboshi::studio
