#pragma once

#include <QOffscreenSurface>
#include <QOpenGLContext>

namespace koboshi::studio {

// An OpenGL 3.3 core context that draws into memory, not into a window. With a widget of OpenGL, Qt would
// compose the whole window with OpenGL for each frame, which costs more than the frame itself where the
// processor draws. It needs a QGuiApplication.
class GlContext {
 public:
  // Throws std::runtime_error.
  GlContext();

  // Makes it the current one of the window's thread. Throws std::runtime_error.
  void make_current();

 private:
  QOffscreenSurface surface_;
  QOpenGLContext context_;
};

}  // namespace koboshi::studio
