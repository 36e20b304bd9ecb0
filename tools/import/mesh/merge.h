#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <string>

#include "view/recording/recording.h"

namespace koboshi::tools {

// Appends a surface to another, moved by X.
void append_surface(view::Mesh& mesh, const view::Mesh& part, const Eigen::Isometry3d& X);

// Returns a mesh of about `max_triangles` or fewer, by the quadric simplifier of meshoptimizer; the mesh
// itself if it has no more.
[[nodiscard]] view::Mesh simplified(const view::Mesh& mesh, std::size_t max_triangles);

// Returns the bytes of a binary STL file.
[[nodiscard]] std::string stl_bytes(const view::Mesh& mesh);

}  // namespace koboshi::tools
