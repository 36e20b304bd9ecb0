#pragma once

#include <cstddef>

#include "view/recording/recording.h"

namespace koboshi::tools {

struct MeshFaults {
  std::size_t open_edges = 0;  // that do not belong to exactly two triangles of opposite direction
  bool inverted = false;       // the triangles of a closed mesh face inwards
};

// Vertices at the same place count as one.
[[nodiscard]] MeshFaults find_mesh_faults(const view::Mesh& mesh);

}  // namespace koboshi::tools
