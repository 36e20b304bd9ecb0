#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "view/recording/recording.h"
#include "view/render/gl.h"
#include "view/render/surface.h"

namespace koboshi::view {

// A sphere that holds the robot.
struct RobotBounds {
  Eigen::Vector3d centre_W_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;  // a multiple of 0.1 m, so that what depends on it changes seldom
  double lowest_W_m = 0.0;
};

// The shapes of a scene in the memory of the graphics processor: those of a link and colour as one part, so
// that few calls draw a robot. A context must be current when this is made, used and destroyed.
class Shapes {
 public:
  struct Part {
    int link = -1;  // -1: fixed in the world
    bool closed = false;
    Colour colour;
    GLsizei first = 0;  // of its indices
    GLsizei count = 0;
  };

  // Uploads them. Throws GlError.
  explicit Shapes(const Scene& scene);

  // Makes them the ones that are drawn.
  void bind() const { glBindVertexArray(array_.name()); }
  std::span<const Part> robot(bool collisions) const { return collisions ? collisions_ : visuals_; }
  // The robot in fewer parts, without regard to colours.
  std::span<const Part> outlines(bool collisions) const {
    return collisions ? collision_outlines_ : visual_outlines_;
  }
  std::span<const Part> ground() const { return ground_; }
  // The square [-1, 1]^2 at z = 0.
  const Part& plane() const { return plane_; }
  RobotBounds bounds(std::span<const Pose> links) const;
  // A height below which no point of the part is.
  double lowest_W_m(const Part& part, std::span<const Pose> links) const;

  // Sets the uniform "model" of the program in use to the part's pose.
  static void place(const GlProgram& program, const Part& part, std::span<const Pose> links);
  // Draws a part; of a closed one only its front, or only its back.
  static void draw(const Part& part, GLenum hidden_face = GL_BACK);
  // Both, for a list of parts.
  static void draw_all(const GlProgram& program, std::span<const Part> parts, std::span<const Pose> links);

 private:
  std::vector<Part> visuals_;
  std::vector<Part> collisions_;
  std::vector<Part> visual_outlines_;
  std::vector<Part> collision_outlines_;
  std::vector<Part> ground_;
  Part plane_;
  std::vector<float> radii_m_;  // of each link about its origin

  GlBuffer vertices_ = make_buffer();
  GlBuffer indices_ = make_buffer();
  GlVertexArray array_ = make_vertex_array();
};

}  // namespace koboshi::view
