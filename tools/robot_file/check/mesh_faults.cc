#include "tools/robot_file/check/mesh_faults.h"

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace koboshi::tools {

MeshFaults find_mesh_faults(const view::Mesh& mesh) {
  std::map<std::array<float, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> place_of;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m)
    place_of.push_back(
        places.try_emplace({vertex.x(), vertex.y(), vertex.z()}, static_cast<std::uint32_t>(places.size()))
            .first->second);
  // By edge, its triangles in the direction of the edge less those against it; and their number.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges;
  double volume_m3 = 0.0;
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = mesh.vertices_m[triangle[i]].cast<double>();
      const std::uint32_t from = place_of[triangle[i]];
      const std::uint32_t to = place_of[triangle[(i + 1) % 3]];
      if (from == to) continue;  // a triangle without area
      auto& [balance, count] = edges[{std::min(from, to), std::max(from, to)}];
      balance += from < to ? 1 : -1;
      ++count;
    }
    volume_m3 += corners[0].dot(corners[1].cross(corners[2])) / 6.0;
  }
  MeshFaults faults;
  for (const auto& [edge, triangles] : edges)
    if (triangles.first != 0 || triangles.second % 2 != 0) ++faults.open_edges;
  faults.inverted = faults.open_edges == 0 && volume_m3 < 0.0;
  return faults;
}

}  // namespace koboshi::tools
