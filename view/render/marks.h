#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "view/recording/recording.h"

namespace koboshi::view {

struct MarkVertex {
  Eigen::Vector3f p_W_m;
  Eigen::Vector3f normal;       // zero: not shaded
  std::array<float, 4> colour;  // red, green, blue (sRGB), opacity
};
static_assert(sizeof(MarkVertex) == 10 * sizeof(float));

// Marks in the world that explain a picture, as triangles.
struct Marks {
  std::vector<MarkVertex> flat;   // on the ground, below what stands there; blended in their order
  std::vector<MarkVertex> solid;  // bodies; faint where something hides them
};

// Each adds a mark. Directions and positions are in the world; `up` is the normal of the ground.
void add_sphere(Marks& marks, const Eigen::Vector3d& centre_m, double radius_m, const Colour& colour);
// A shaft with a conical head. An arrow shorter than its head is a smaller head; one without length is
// nothing.
void add_arrow(Marks& marks, const Eigen::Vector3d& tail_m, const Eigen::Vector3d& tip_m, double radius_m,
               const Colour& colour);
void add_rod(Marks& marks, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, double radius_m,
             const Colour& colour);
// A horizontal disc with a rim, or with an inner radius a ring.
void add_disc(Marks& marks, const Eigen::Vector3d& centre_m, double radius_m, double inner_radius_m,
              const Colour& colour, double opacity);
// The same as a body: faint where something hides it.
void add_solid_disc(Marks& marks, const Eigen::Vector3d& centre_m, double radius_m, double inner_radius_m,
                    const Colour& colour);
// A convex polygon, filled.
void add_polygon(Marks& marks, std::span<const Eigen::Vector3d> corners_m, const Colour& colour,
                 double opacity);
// A line of constant width on the ground, closed to a loop if asked for.
void add_line(Marks& marks, std::span<const Eigen::Vector3d> points_m, double width_m, bool closed,
              const Colour& colour, double opacity);

}  // namespace koboshi::view
