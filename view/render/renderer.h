#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "view/recording/recording.h"
#include "view/render/camera.h"
#include "view/render/marks.h"
#include "view/render/tint.h"

namespace koboshi::view {

// The robot of a picture once more, translucent and without shadow.
struct Ghost {
  std::vector<Pose> links{};  // by index of Scene::links
  std::vector<Tint> tints{};  // the same; empty: own colours
  float opacity = 0.4F;
};

// A picture of a scene at one instant.
struct Picture {
  Camera camera{};
  std::vector<Pose> links{};  // by index of Scene::links
  Marks marks{};
  bool collisions = false;      // the shapes that collide in place of those that are seen
  float opacity = 1.0F;         // of the robot
  std::vector<Tint> tints{};    // by index of Scene::links; empty: own colours
  std::vector<Ghost> ghosts{};  // each hides what is behind it of the later ones
};

// Draws pictures of a scene with OpenGL 3.3 core. A context must be current when it is made, used and
// destroyed; whose it is does not matter. It draws into the framebuffer that is bound for drawing, which
// needs a depth buffer, and leaves the state of the context as it found it.
class Renderer {
 public:
  // Uploads the shapes of the scene. Throws GlError.
  explicit Renderer(const Scene& scene);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Fills the framebuffer from its lower left corner to this size. Throws GlError.
  void draw(const Picture& picture, int width_px, int height_px);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace koboshi::view
