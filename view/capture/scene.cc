#include "view/capture/scene.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "sim_board/world/foot.h"
#include "sim_board/world/support_polygon.h"
#include "view/capture/stl.h"

namespace koboshi::view {
namespace {

constexpr Colour kMeshColour{0.88F, 0.89F, 0.91F};
constexpr Colour kBoxColour{0.28F, 0.30F, 0.34F};
constexpr Colour kGroundColour{0.52F, 0.55F, 0.58F};
constexpr Colour kPatchColour{0.36F, 0.55F, 0.72F};
constexpr double kPatchThickness_m = 0.0005;  // enough to be drawn above the plane
constexpr int kDiscCorners = 48;
constexpr Colour kBallColour{0.83F, 0.87F, 0.25F};
constexpr Colour kSeamColour{0.95F, 0.96F, 0.92F};
constexpr Colour kLooseBoxColour{0.72F, 0.55F, 0.36F};
constexpr int kBallColumns = 32;
constexpr int kBallRows = 16;

Colour colour_of(const std::optional<sim_board::ColourDescription>& colour, const Colour& otherwise) {
  return colour ? Colour{(*colour)[0], (*colour)[1], (*colour)[2]} : otherwise;
}

Shape shape_of(const sim_board::BoxDescription& box) {
  return {.name = box.name,
          .X_LG = box.X_LG,
          .geometry = Box{box.size_m},
          .colour = colour_of(box.colour, kBoxColour)};
}

// The meshes of a robot by their files, each of which is read once: its servos share one.
struct MeshFile {
  StlFile stl{};
  bool is_reported = false;  // a fault of it
};
using MeshFiles = std::map<std::filesystem::path, MeshFile>;

// Returns the mesh, scaled; or why it cannot be shown.
StlFile scaled_mesh(const StlFile& file, const Eigen::Vector3f& scale) {
  StlFile scaled = file;
  if (!scaled.mesh) return scaled;
  for (Eigen::Vector3f& vertex : scaled.mesh->vertices_m) {
    vertex = vertex.cwiseProduct(scale);
    if (!vertex.allFinite()) return {.fault = "a vertex that is too far away"};
  }
  return scaled;
}

// Returns nothing for a mesh that cannot be shown, and appends the reason to `faults`, once for each file.
std::optional<Shape> shape_of(const sim_board::MeshDescription& description, const std::string& link,
                              MeshFiles& files, std::vector<std::string>& faults) {
  const auto [place, is_new] = files.try_emplace(description.file);
  MeshFile& file = place->second;
  if (is_new) file.stl = read_stl(description.file);
  const Eigen::Vector3f scale = description.scale.cast<float>();
  auto [mesh, fault, is_damaged] = scaled_mesh(file.stl, scale);
  if (!mesh) {
    if (!std::exchange(file.is_reported, true))
      faults.push_back("The mesh " + description.file.filename().string() + " of " + link +
                       " cannot be shown: " + fault + ". The link's collision boxes stand for it.");
    return {};
  }
  if (scale.prod() < 0.0F) {  // a mirror image has its corners the other way round
    for (auto& triangle : mesh->triangles) std::swap(triangle[1], triangle[2]);
  }
  return Shape{.name = description.name,
               .X_LG = description.X_LG,
               .geometry = *std::move(mesh),
               .colour = colour_of(description.colour, kMeshColour)};
}

std::vector<Shape> visuals_of(const sim_board::LinkDescription& link, MeshFiles& files,
                              std::vector<std::string>& faults) {
  std::vector<Shape> shapes;
  for (const sim_board::BoxDescription& box : link.visual_boxes) shapes.push_back(shape_of(box));
  bool all_read = true;
  for (const sim_board::MeshDescription& mesh : link.meshes) {
    std::optional<Shape> shape = shape_of(mesh, link.name, files, faults);
    all_read = all_read && shape;
    if (shape) shapes.push_back(*std::move(shape));
  }
  if (all_read) return shapes;
  for (const sim_board::BoxDescription& box : link.collisions) shapes.push_back(shape_of(box));
  return shapes;
}

std::vector<Link> links_of(const sim_board::RobotDescription& robot, std::vector<std::string>& mesh_faults) {
  std::vector<Link> links;
  MeshFiles files;
  for (const sim_board::LinkDescription& description : robot.links) {
    Link link{.name = description.name, .mass_kg = description.mass_kg, .p_LCom_L = description.p_LCom_L};
    link.visuals = visuals_of(description, files, mesh_faults);
    for (const sim_board::BoxDescription& box : description.collisions)
      link.collisions.push_back(shape_of(box));
    links.push_back(std::move(link));
  }
  for (std::size_t i = 0; i < robot.hinge_count(); ++i)
    links[static_cast<std::size_t>(robot.hinge(i).child)].parent = robot.hinge(i).parent;
  return links;
}

void add_soles(const sim_board::RobotDescription& robot, Scene& scene) {
  const auto feet = sim_board::feet_of(robot);
  for (std::size_t side = 0; side < feet.size(); ++side) {
    if (!feet[side]) continue;
    const Eigen::Isometry3d& X_LSole = feet[side]->X_LSole;
    std::vector<Eigen::Vector2d> corners_S;
    for (const Eigen::Vector3d& corner_L : feet[side]->corners_L)
      corners_S.emplace_back((X_LSole.inverse() * corner_L).head<2>());
    for (const Eigen::Vector2d& corner_S : sim_board::convex_hull(corners_S))
      scene.soles_L[side].emplace_back(X_LSole * Eigen::Vector3d(corner_S.x(), corner_S.y(), 0.0));
    scene.sole_links[side] = feet[side]->link;
  }
}

// The upper side of the field, by the triangles of sim_board::HeightField.
Mesh mesh_of(const sim_board::HeightField& field) {
  Mesh mesh;
  for (int row = 0; row < field.rows; ++row)
    for (int column = 0; column < field.columns; ++column)
      mesh.vertices_m.push_back(field.point_F(column, row).cast<float>());
  const auto index = [&](int column, int row) {
    return static_cast<std::uint32_t>(row * field.columns + column);
  };
  for (int row = 0; row + 1 < field.rows; ++row) {
    for (int column = 0; column + 1 < field.columns; ++column) {
      const std::uint32_t low = index(column, row);
      const std::uint32_t high = index(column + 1, row + 1);
      mesh.triangles.push_back({low, index(column + 1, row), high});
      mesh.triangles.push_back({low, high, index(column, row + 1)});
    }
  }
  return mesh;
}

Mesh disc(double radius_m) {
  Mesh mesh;
  mesh.vertices_m.emplace_back(0.0F, 0.0F, static_cast<float>(kPatchThickness_m));
  for (int i = 0; i < kDiscCorners; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kDiscCorners;
    mesh.vertices_m.push_back(
        Eigen::Vector3d(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), kPatchThickness_m)
            .cast<float>());
    const auto corner = static_cast<std::uint32_t>(i);
    mesh.triangles.push_back({0, corner + 1, (corner + 1) % kDiscCorners + 1});
  }
  return mesh;
}

// The rows `from` to `to` of a sphere that is divided into columns about z and rows between its poles.
Mesh zone_of_sphere(double radius_m, int from, int to) {
  Mesh mesh;
  for (int row = from; row <= to; ++row) {
    const double polar_rad = std::numbers::pi * row / kBallRows;
    for (int column = 0; column < kBallColumns; ++column) {
      const double turn_rad = 2.0 * std::numbers::pi * column / kBallColumns;
      mesh.vertices_m.push_back(
          (radius_m * Eigen::Vector3d(std::sin(polar_rad) * std::cos(turn_rad),
                                      std::sin(polar_rad) * std::sin(turn_rad), std::cos(polar_rad)))
              .cast<float>());
    }
  }
  const auto index = [](int row, int column) {
    return static_cast<std::uint32_t>(row * kBallColumns + column % kBallColumns);
  };
  for (int row = 0; row < to - from; ++row) {
    for (int column = 0; column < kBallColumns; ++column) {
      if (from + row > 0)
        mesh.triangles.push_back({index(row, column), index(row + 1, column), index(row, column + 1)});
      if (from + row < kBallRows - 1)
        mesh.triangles.push_back(
            {index(row, column + 1), index(row + 1, column), index(row + 1, column + 1)});
    }
  }
  return mesh;
}

// A ball has a stripe about its equator, so that one sees it roll.
Link link_of(const sim_board::FreeBodyDescription& body) {
  Link link{.name = body.name};
  if (body.shape == sim_board::FreeBodyDescription::Shape::kBox) {
    link.visuals.push_back({.name = body.name, .geometry = Box{body.size_m}, .colour = kLooseBoxColour});
  } else {
    const double radius_m = 0.5 * body.size_m.x();
    constexpr int kMiddle = kBallRows / 2;
    const auto add = [&](const char* part, int from, int to, const Colour& colour) {
      link.visuals.push_back(
          {.name = body.name + part, .geometry = zone_of_sphere(radius_m, from, to), .colour = colour});
    };
    add("_top", 0, kMiddle - 1, kBallColour);
    add("_stripe", kMiddle - 1, kMiddle + 1, kSeamColour);
    add("_bottom", kMiddle + 1, kBallRows, kBallColour);
  }
  link.collisions = link.visuals;
  return link;
}

Shape shape_of(const sim_board::FrictionPatch& patch, std::string name) {
  Shape shape{.name = std::move(name), .X_LG = patch.X_WP, .colour = kPatchColour};
  if (patch.outline == sim_board::FrictionPatch::Outline::kDisc) {
    shape.geometry = disc(0.5 * patch.size_m.x());
  } else {
    shape.geometry = Box{{patch.size_m.x(), patch.size_m.y(), 2.0 * kPatchThickness_m}};
  }
  return shape;
}

std::vector<Shape> shapes_of(const sim_board::GroundDescription& ground) {
  std::vector<Shape> shapes;
  const auto name = [&shapes](const char* kind) { return kind + std::to_string(shapes.size() + 1); };
  for (const sim_board::GroundBox& box : ground.boxes)
    shapes.push_back(
        {.name = name("box_"), .X_LG = box.X_WG, .geometry = Box{box.size_m}, .colour = kGroundColour});
  for (const sim_board::HeightField& field : ground.height_fields)
    shapes.push_back({.name = name("height_field_"),
                      .X_LG = field.X_WF,
                      .geometry = mesh_of(field),
                      .colour = kGroundColour});
  for (const sim_board::FrictionPatch& patch : ground.patches)
    shapes.push_back(shape_of(patch, name("patch_")));
  return shapes;
}

}  // namespace

Scene make_scene(const sim_board::RobotDescription& robot, const sim_board::GroundDescription& ground,
                 const std::vector<sim_board::FreeBodyDescription>& free_bodies) {
  Scene scene{.robot = robot.name, .ground = shapes_of(ground)};
  scene.links = links_of(robot, scene.mesh_faults);
  for (const sim_board::FreeBodyDescription& body : free_bodies) scene.links.push_back(link_of(body));
  if (ground.present) {
    const double length = ground.normal_W.norm();
    scene.planes.push_back({ground.normal_W / length, ground.offset_m});
  }
  add_soles(robot, scene);
  return scene;
}

}  // namespace koboshi::view
