#include "view/render/shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace koboshi::view {
namespace {

constexpr double kRadiusStep_m = 0.1;
constexpr std::array<GLint, 2> kLayout{3, 3};

// Vertices and indices of all shapes before their upload.
struct Upload {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
};

// A shape's surface in the frame of its link.
struct PlacedSurface {
  int link = -1;
  Colour colour;
  Surface surface;
};

PlacedSurface placed(const Shape& shape, int link) {
  PlacedSurface result{link, shape.colour, surface_of(shape)};
  const Eigen::Isometry3f X_LG = shape.X_LG.cast<float>();
  for (Vertex& vertex : result.surface.vertices) vertex = {X_LG * vertex.p_m, X_LG.linear() * vertex.normal};
  return result;
}

auto group_of(const PlacedSurface& one) {
  return std::tuple(one.link, one.surface.closed, one.colour.red, one.colour.green, one.colour.blue);
}

// Shapes of the same link, closure and colour in one part; their order remains.
std::vector<Shapes::Part> add_parts(Upload& upload, std::vector<PlacedSurface> surfaces) {
  std::ranges::stable_sort(surfaces, {}, group_of);
  std::vector<Shapes::Part> parts;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const PlacedSurface& one = surfaces[i];
    if (i == 0 || group_of(one) != group_of(surfaces[i - 1]))
      parts.push_back(
          {one.link, one.surface.closed, one.colour, static_cast<GLsizei>(upload.indices.size()), 0});
    const auto first = static_cast<std::uint32_t>(upload.vertices.size());
    upload.vertices.insert(upload.vertices.end(), one.surface.vertices.begin(), one.surface.vertices.end());
    for (const auto& triangle : one.surface.triangles)
      for (const std::uint32_t corner : triangle) upload.indices.push_back(first + corner);
    parts.back().count = static_cast<GLsizei>(upload.indices.size()) - parts.back().first;
  }
  return parts;
}

// Neighbours of different colours are one outline.
std::vector<Shapes::Part> outlines_of(const std::vector<Shapes::Part>& parts) {
  std::vector<Shapes::Part> outlines;
  for (const Shapes::Part& part : parts) {
    if (!outlines.empty() && outlines.back().link == part.link && outlines.back().closed == part.closed) {
      outlines.back().count += part.count;
    } else {
      outlines.push_back(part);
    }
  }
  return outlines;
}

void upload_to(GLenum target, const GlBuffer& buffer, const auto& values) {
  glBindBuffer(target, buffer.name());
  glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(values.front())), values.data(),
               GL_STATIC_DRAW);
}

}  // namespace

Shapes::Shapes(const Scene& scene) {
  Upload upload;
  std::vector<PlacedSurface> visuals;
  std::vector<PlacedSurface> collisions;
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    for (const Shape& shape : scene.links[i].visuals) visuals.push_back(placed(shape, static_cast<int>(i)));
    for (const Shape& shape : scene.links[i].collisions)
      collisions.push_back(placed(shape, static_cast<int>(i)));
  }
  radii_m_.assign(scene.links.size(), 0.0F);
  for (const auto* surfaces : {&visuals, &collisions}) {
    for (const PlacedSurface& one : *surfaces) {
      float& radius = radii_m_[static_cast<std::size_t>(one.link)];
      radius = std::max(radius, radius_m(one.surface));
    }
  }
  std::vector<PlacedSurface> ground;
  for (const Shape& shape : scene.ground) ground.push_back(placed(shape, -1));
  const Surface square{.vertices = {{{-1.0F, -1.0F, 0.0F}, Eigen::Vector3f::UnitZ()},
                                    {{1.0F, -1.0F, 0.0F}, Eigen::Vector3f::UnitZ()},
                                    {{1.0F, 1.0F, 0.0F}, Eigen::Vector3f::UnitZ()},
                                    {{-1.0F, 1.0F, 0.0F}, Eigen::Vector3f::UnitZ()}},
                       .triangles = {{0, 1, 2}, {0, 2, 3}}};
  visuals_ = add_parts(upload, std::move(visuals));
  collisions_ = add_parts(upload, std::move(collisions));
  ground_ = add_parts(upload, std::move(ground));
  plane_ = add_parts(upload, {{-1, {}, square}}).front();
  visual_outlines_ = outlines_of(visuals_);
  collision_outlines_ = outlines_of(collisions_);

  bind();
  upload_to(GL_ARRAY_BUFFER, vertices_, upload.vertices);
  upload_to(GL_ELEMENT_ARRAY_BUFFER, indices_, upload.indices);
  set_attributes(kLayout);
  check_gl("the upload of the scene");
}

RobotBounds Shapes::bounds(std::span<const Pose> links) const {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Eigen::Vector3d p_m = links[i].p_WL_m.cast<double>();
    const Eigen::Vector3d reach_m = Eigen::Vector3d::Constant(static_cast<double>(radii_m_[i]));
    box.extend(Eigen::AlignedBox3d(p_m - reach_m, p_m + reach_m));
  }
  if (box.isEmpty()) return {};
  const double radius_m = kRadiusStep_m * std::ceil(0.5 * box.diagonal().norm() / kRadiusStep_m);
  return {box.center(), std::max(radius_m, kRadiusStep_m), box.min().z()};
}

double Shapes::lowest_W_m(const Part& part, std::span<const Pose> links) const {
  const auto link = static_cast<std::size_t>(part.link);
  return static_cast<double>(links[link].p_WL_m.z() - radii_m_[link]);
}

void Shapes::place(const GlProgram& program, const Part& part, std::span<const Pose> links) {
  Eigen::Matrix4f model = Eigen::Matrix4f::Identity();
  if (part.link >= 0) {
    const Pose& pose = links[static_cast<std::size_t>(part.link)];
    model.topLeftCorner<3, 3>() = pose.q_WL.toRotationMatrix();
    model.topRightCorner<3, 1>() = pose.p_WL_m;
  }
  program.set("model", model);
}

void Shapes::draw(const Part& part, GLenum hidden_face) {
  if (part.closed) {
    glEnable(GL_CULL_FACE);
    glCullFace(hidden_face);
  } else {
    glDisable(GL_CULL_FACE);
  }
  const auto offset = static_cast<std::uintptr_t>(part.first) * sizeof(std::uint32_t);
  glDrawElements(GL_TRIANGLES, part.count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset));
  glDisable(GL_CULL_FACE);
}

void Shapes::draw_all(const GlProgram& program, std::span<const Part> parts, std::span<const Pose> links) {
  for (const Part& part : parts) {
    place(program, part, links);
    draw(part);
  }
}

}  // namespace koboshi::view
