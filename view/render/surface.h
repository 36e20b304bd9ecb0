#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "view/recording/recording.h"

namespace koboshi::view {

// A corner of a triangle, as the graphics processor reads it.
struct Vertex {
  Eigen::Vector3f p_m;
  Eigen::Vector3f normal;  // unit vector, outwards
};
static_assert(sizeof(Vertex) == 6 * sizeof(float));

struct Surface {
  std::vector<Vertex> vertices{};
  std::vector<std::array<std::uint32_t, 3>>
      triangles{};  // indices of vertices, counter-clockwise from outside
  // Each edge joins two triangles, and they face outwards: from outside, only front faces can be seen.
  bool closed = false;
};

// Edges between faces that differ by more than this angle look sharp, all others smooth.
inline constexpr float kCrease_rad =
    0.6F;  // 34 degrees: sharper than a cylinder's facets, softer than a bevel

// The triangles with a normal for each corner: the mean of the normals of the faces around the corner's
// vertex that are within `crease_rad` of its own face, weighted by their angles at the vertex. Vertices at
// exactly the same position count as one, as meshes from STL files need. Corners with the same position and
// normal share a vertex. Drops triangles without area.
Surface smooth_surface(const Mesh& mesh, float crease_rad = kCrease_rad);
// A box with sharp edges.
Surface box_surface(const Eigen::Vector3d& size_m);
Surface surface_of(const Shape& shape);  // in the frame of the geometry

// The radius of the smallest sphere about the origin that holds the surface.
float radius_m(const Surface& surface);

}  // namespace koboshi::view
