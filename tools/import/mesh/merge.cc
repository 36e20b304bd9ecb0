#include "tools/import/mesh/merge.h"

#include <meshoptimizer.h>

#include <array>
#include <cstring>
#include <map>

namespace koboshi::tools {
namespace {

// Error in shares of the mesh's size. Where it would be larger, a mesh keeps more triangles than was asked
// for.
constexpr float kMaxError = 0.02F;

// Corners at the same place become one vertex, without which the simplifier sees only borders. Triangles
// without area go.
view::Mesh welded(const view::Mesh& mesh) {
  view::Mesh result;
  std::map<std::array<float, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> place_of;
  place_of.reserve(mesh.vertices_m.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) {
    const auto next = static_cast<std::uint32_t>(result.vertices_m.size());
    const auto [place, is_new] = places.try_emplace({vertex.x(), vertex.y(), vertex.z()}, next);
    if (is_new) result.vertices_m.push_back(vertex);
    place_of.push_back(place->second);
  }
  for (const auto& triangle : mesh.triangles) {
    const std::array corners{place_of[triangle[0]], place_of[triangle[1]], place_of[triangle[2]]};
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
      result.triangles.push_back(corners);
  }
  return result;
}

}  // namespace

void append_surface(view::Mesh& mesh, const view::Mesh& part, const Eigen::Isometry3d& X) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  for (const Eigen::Vector3f& vertex : part.vertices_m)
    mesh.vertices_m.push_back((X * vertex.cast<double>()).cast<float>());
  for (const auto& triangle : part.triangles)
    mesh.triangles.push_back({first + triangle[0], first + triangle[1], first + triangle[2]});
}

view::Mesh simplified(const view::Mesh& mesh, std::size_t max_triangles) {
  view::Mesh result = welded(mesh);
  if (result.triangles.size() <= max_triangles) return result;
  std::vector<unsigned int> indices(3 * result.triangles.size());
  const std::size_t count = meshopt_simplify(
      indices.data(), result.triangles.front().data(), indices.size(), result.vertices_m.front().data(),
      result.vertices_m.size(), sizeof(Eigen::Vector3f), 3 * max_triangles, kMaxError, 0, nullptr);
  result.triangles.clear();
  for (std::size_t i = 0; i + 2 < count; i += 3)
    result.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  return result;
}

std::string stl_bytes(const view::Mesh& mesh) {
  constexpr std::size_t kTitle_bytes = 80;
  std::string bytes(kTitle_bytes, '\0');
  const auto append = [&bytes](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f& a = mesh.vertices_m[triangle[0]];
    const Eigen::Vector3f& b = mesh.vertices_m[triangle[1]];
    const Eigen::Vector3f& c = mesh.vertices_m[triangle[2]];
    const Eigen::Vector3f cross = (b - a).cross(c - a);
    const Eigen::Vector3f normal = cross.norm() > 0.0F ? Eigen::Vector3f(cross.normalized()) : cross;
    for (const Eigen::Vector3f* const vector : {&normal, &a, &b, &c})
      for (int i = 0; i < 3; ++i) append((*vector)[i]);
    append(std::uint16_t{0});
  }
  return bytes;
}

}  // namespace koboshi::tools
