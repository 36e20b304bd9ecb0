#include "view/render/surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace koboshi::view {
namespace {

// A triangle's corner at a vertex.
struct Corner {
  std::size_t face = 0;
  float angle_rad = 0.0F;
};

struct Faces {
  std::vector<std::array<std::uint32_t, 3>> vertices;  // indices of welded vertices
  std::vector<std::array<Eigen::Vector3f, 3>> p_m;
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::vector<Corner>> around;  // by welded vertex
};

float angle_at(const std::array<Eigen::Vector3f, 3>& p_m, std::size_t corner) {
  const Eigen::Vector3f a = (p_m[(corner + 1) % 3] - p_m[corner]).normalized();
  const Eigen::Vector3f b = (p_m[(corner + 2) % 3] - p_m[corner]).normalized();
  return std::acos(std::clamp(a.dot(b), -1.0F, 1.0F));
}

Faces weld(const Mesh& mesh) {
  Faces faces;
  std::map<std::tuple<float, float, float>, std::uint32_t> indices;
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3f, 3> p_m;
    for (std::size_t i = 0; i < 3; ++i) p_m[i] = mesh.vertices_m[triangle[i]];
    const Eigen::Vector3f normal = (p_m[1] - p_m[0]).cross(p_m[2] - p_m[0]);
    if (!(normal.norm() > 0.0F)) continue;
    std::array<std::uint32_t, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto next = static_cast<std::uint32_t>(indices.size());
      corners[i] = indices.try_emplace({p_m[i].x(), p_m[i].y(), p_m[i].z()}, next).first->second;
      faces.around.resize(indices.size());
      faces.around[corners[i]].push_back({faces.normals.size(), angle_at(p_m, i)});
    }
    faces.vertices.push_back(corners);
    faces.p_m.push_back(p_m);
    faces.normals.push_back(normal.normalized());
  }
  return faces;
}

// An edge occurs once in each direction, and the volume is positive.
bool is_closed(const Faces& faces) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  float volume_m3 = 0.0F;
  for (std::size_t face = 0; face < faces.normals.size(); ++face) {
    const auto& corners = faces.vertices[face];
    const auto& p_m = faces.p_m[face];
    volume_m3 += p_m[0].dot(p_m[1].cross(p_m[2])) / 6.0F;
    for (std::size_t i = 0; i < 3; ++i)
      if (!edges.emplace(corners[i], corners[(i + 1) % 3]).second) return false;
  }
  return volume_m3 > 0.0F && std::ranges::all_of(edges, [&](const auto& edge) {
           return edges.contains({edge.second, edge.first});
         });
}

// The vertex with this position and normal among those of a welded vertex; adds it if there is none.
std::uint32_t vertex_of(Surface& surface, std::vector<std::uint32_t>& welded, const Vertex& wanted) {
  for (const std::uint32_t index : welded)
    if (surface.vertices[index].normal == wanted.normal) return index;
  const auto index = static_cast<std::uint32_t>(surface.vertices.size());
  surface.vertices.push_back(wanted);
  welded.push_back(index);
  return index;
}

}  // namespace

Surface smooth_surface(const Mesh& mesh, float crease_rad) {
  const Faces faces = weld(mesh);
  const float least_cosine = std::cos(crease_rad);
  Surface surface{.closed = is_closed(faces)};
  surface.triangles.resize(faces.normals.size());
  std::vector<std::vector<std::uint32_t>> welded(faces.around.size());
  for (std::size_t face = 0; face < faces.normals.size(); ++face) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t corner = faces.vertices[face][i];
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (const Corner& other : faces.around[corner]) {
        const Eigen::Vector3f& normal = faces.normals[other.face];
        if (normal.dot(faces.normals[face]) >= least_cosine) sum += other.angle_rad * normal;
      }
      surface.triangles[face][i] = vertex_of(surface, welded[corner], {faces.p_m[face][i], sum.normalized()});
    }
  }
  return surface;
}

Surface box_surface(const Eigen::Vector3d& size_m) {
  Surface surface{.closed = true};
  const Eigen::Vector3f half_m = 0.5F * size_m.cast<float>();
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      const Eigen::Vector3f normal = sign * Eigen::Vector3f::Unit(axis);
      const Eigen::Vector3f right = Eigen::Vector3f::Unit((axis + 1) % 3);
      const Eigen::Vector3f up = normal.cross(right);
      const auto first = static_cast<std::uint32_t>(surface.vertices.size());
      for (const auto& [u, v] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}}) {
        const Eigen::Vector3f corner = normal + static_cast<float>(u) * right + static_cast<float>(v) * up;
        surface.vertices.push_back({corner.cwiseProduct(half_m), normal});
      }
      surface.triangles.push_back({first, first + 1, first + 2});
      surface.triangles.push_back({first, first + 2, first + 3});
    }
  }
  return surface;
}

Surface surface_of(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape.geometry)) return box_surface(box->size_m);
  return smooth_surface(std::get<Mesh>(shape.geometry));
}

float radius_m(const Surface& surface) {
  float radius = 0.0F;
  for (const Vertex& vertex : surface.vertices) radius = std::max(radius, vertex.p_m.norm());
  return radius;
}

}  // namespace koboshi::view
