#pragma once

#include <Eigen/Core>
#include <vector>

#include "view/render/gl.h"
#include "view/render/renderer.h"
#include "view/render/shapes.h"

namespace koboshi::view {

// The direction from any point to the key light.
Eigen::Vector3d to_light_W();

// The shadows of a robot in the light of its surroundings: a map of depths as the key light sees them, and
// one of how near its lowest links are to the ground. A context must be current when this is made, used and
// destroyed.
class Shadows {
 public:
  // Throws GlError.
  Shadows();

  // Draws the maps of these shapes and poses, unless they hold them already: a camera that moves about a
  // robot at rest costs nothing here. Leaves another framebuffer and viewport bound.
  void update(const Shapes& shapes, const Picture& picture);
  // Binds the maps and sets the uniforms of the surface shader, which is in use.
  void set_uniforms(const GlProgram& surface) const;

 private:
  void place(const RobotBounds& robot);
  void draw_depth(const Shapes& shapes, const Picture& picture);
  void draw_proximity(const Shapes& shapes, const Picture& picture, const RobotBounds& robot);

  GlProgram depth_;
  GlProgram proximity_;
  GlTarget depth_target_;
  GlTarget proximity_target_;
  Eigen::Matrix4f world_to_light_ = Eigen::Matrix4f::Identity();
  float texel_m_ = 0.0F;
  Eigen::Vector4f proximity_place_ = Eigen::Vector4f::Zero();  // centre x, y; half width; height
  std::vector<Pose> drawn_links_;
  bool drawn_collisions_ = false;
};

}  // namespace koboshi::view
