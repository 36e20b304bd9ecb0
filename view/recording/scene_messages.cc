#include "view/recording/scene_messages.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "mechanics/axes.h"

namespace koboshi::view {
namespace {

namespace pb = google::protobuf;

constexpr double kPlane_m = 20.0;
constexpr double kPlaneThickness_m = 0.002;
constexpr Colour kPlaneColour{0.62F, 0.64F, 0.66F};

template <typename Values, typename Container>
void append(const Values& values, Container& container) {
  for (const auto value : values) container.Add(value);
}

// Index of the mesh among those of the scene, to which it is added.
std::uint32_t index_of(const Mesh& mesh, koboshi::Scene& scene, std::vector<const Mesh*>& meshes) {
  const auto known = std::ranges::find_if(meshes, [&](const Mesh* other) {
    return other->triangles == mesh.triangles && other->vertices_m == mesh.vertices_m;
  });
  if (known != meshes.end()) return static_cast<std::uint32_t>(known - meshes.begin());
  meshes.push_back(&mesh);
  koboshi::Mesh& message = *scene.add_meshes();
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) append(vertex, *message.mutable_vertices_m());
  for (const auto& triangle : mesh.triangles) append(triangle, *message.mutable_triangles());
  return static_cast<std::uint32_t>(meshes.size() - 1);
}

koboshi::Shape message_of(const Shape& shape, koboshi::Scene& scene, std::vector<const Mesh*>& meshes) {
  koboshi::Shape message;
  message.set_name(shape.name);
  append(shape.X_LG.translation(), *message.mutable_translation_m());
  append(Eigen::Quaterniond(shape.X_LG.linear()).coeffs(), *message.mutable_rotation());
  for (const float part : {shape.colour.red, shape.colour.green, shape.colour.blue}) message.add_colour(part);
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    append(box->size_m, *message.mutable_size_m());
    return message;
  }
  message.set_mesh(index_of(std::get<Mesh>(shape.geometry), scene, meshes));
  return message;
}

void check(bool is_right, const char* part) {
  if (!is_right) throw std::invalid_argument(part);
}

Eigen::Vector3d vector_of(const pb::RepeatedField<double>& values, const char* part) {
  check(values.size() == 3, part);
  return {values[0], values[1], values[2]};
}

Mesh mesh_of(const koboshi::Mesh& message) {
  check(message.vertices_m_size() % 3 == 0 && message.triangles_size() % 3 == 0, "a mesh's lists");
  Mesh mesh;
  for (int i = 0; i < message.vertices_m_size(); i += 3)
    mesh.vertices_m.emplace_back(message.vertices_m(i), message.vertices_m(i + 1), message.vertices_m(i + 2));
  for (int i = 0; i < message.triangles_size(); i += 3) {
    mesh.triangles.push_back({message.triangles(i), message.triangles(i + 1), message.triangles(i + 2)});
    for (const std::uint32_t vertex : mesh.triangles.back())
      check(vertex < mesh.vertices_m.size(), "a mesh's triangle");
  }
  return mesh;
}

Shape shape_of(const koboshi::Shape& message, const std::vector<Mesh>& meshes) {
  Shape shape{.name = message.name()};
  shape.X_LG.translation() = vector_of(message.translation_m(), "a shape's place");
  check(message.rotation_size() == 4, "a shape's rotation");
  Eigen::Quaterniond q;
  for (int i = 0; i < 4; ++i) q.coeffs()[i] = message.rotation(i);
  shape.X_LG.linear() = q.normalized().toRotationMatrix();
  check(message.colour_size() == 3, "a shape's colour");
  shape.colour = {message.colour(0), message.colour(1), message.colour(2)};
  if (message.size_m_size() > 0) {
    shape.geometry = Box{vector_of(message.size_m(), "a box's size")};
  } else {
    check(message.mesh() < meshes.size(), "a shape's mesh");
    shape.geometry = meshes[message.mesh()];
  }
  return shape;
}

std::vector<Shape> shapes_of(const pb::RepeatedPtrField<koboshi::Shape>& messages,
                             const std::vector<Mesh>& meshes) {
  std::vector<Shape> shapes;
  for (const koboshi::Shape& message : messages) shapes.push_back(shape_of(message, meshes));
  return shapes;
}

Link link_of(const koboshi::Link& message, const std::vector<Mesh>& meshes) {
  Link link{.name = message.name(), .parent = message.parent(), .mass_kg = message.mass_kg()};
  link.p_LCom_L = vector_of(message.centre_of_mass_m(), "a link's centre of mass");
  link.visuals = shapes_of(message.visuals(), meshes);
  link.collisions = shapes_of(message.collisions(), meshes);
  return link;
}

void set_pose(const Eigen::Isometry3d& pose, foxglove::Pose& message) {
  message.mutable_position()->set_x(pose.translation().x());
  message.mutable_position()->set_y(pose.translation().y());
  message.mutable_position()->set_z(pose.translation().z());
  const Eigen::Quaterniond q(pose.linear());
  message.mutable_orientation()->set_x(q.x());
  message.mutable_orientation()->set_y(q.y());
  message.mutable_orientation()->set_z(q.z());
  message.mutable_orientation()->set_w(q.w());
}

void set_colour(const Colour& colour, foxglove::Color& message) {
  message.set_r(static_cast<double>(colour.red));
  message.set_g(static_cast<double>(colour.green));
  message.set_b(static_cast<double>(colour.blue));
  message.set_a(1.0);
}

void add_shape(const Shape& shape, foxglove::SceneEntity& entity) {
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    foxglove::CubePrimitive& cube = *entity.add_cubes();
    set_pose(shape.X_LG, *cube.mutable_pose());
    cube.mutable_size()->set_x(box->size_m.x());
    cube.mutable_size()->set_y(box->size_m.y());
    cube.mutable_size()->set_z(box->size_m.z());
    set_colour(shape.colour, *cube.mutable_color());
    return;
  }
  const auto& mesh = std::get<Mesh>(shape.geometry);
  foxglove::TriangleListPrimitive& triangles = *entity.add_triangles();
  set_pose(shape.X_LG, *triangles.mutable_pose());
  set_colour(shape.colour, *triangles.mutable_color());
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) {
    foxglove::Point3& point = *triangles.add_points();
    point.set_x(static_cast<double>(vertex.x()));
    point.set_y(static_cast<double>(vertex.y()));
    point.set_z(static_cast<double>(vertex.z()));
  }
  for (const auto& triangle : mesh.triangles) append(triangle, *triangles.mutable_indices());
}

foxglove::SceneEntity& add_entity(const std::string& id, const std::string& frame,
                                  foxglove::SceneUpdate& update) {
  foxglove::SceneEntity& entity = *update.add_entities();
  entity.mutable_timestamp();
  entity.set_frame_id(frame);
  entity.set_id(id);
  entity.mutable_lifetime();
  entity.set_frame_locked(true);
  return entity;
}

// A thin box whose upper side is the plane.
Shape slab(const Plane& plane) {
  Shape shape{
      .name = "plane", .geometry = Box{{kPlane_m, kPlane_m, kPlaneThickness_m}}, .colour = kPlaneColour};
  shape.X_LG.linear() = mechanics::rotation_to_normal(plane.normal_W);
  shape.X_LG.translation() = plane.normal_W * (plane.offset_m - 0.5 * kPlaneThickness_m);
  return shape;
}

}  // namespace

koboshi::Scene message_of(const Scene& scene) {
  koboshi::Scene message;
  std::vector<const Mesh*> meshes;
  message.set_robot(scene.robot);
  for (const Link& link : scene.links) {
    koboshi::Link& part = *message.add_links();
    part.set_name(link.name);
    part.set_parent(link.parent);
    part.set_mass_kg(link.mass_kg);
    append(link.p_LCom_L, *part.mutable_centre_of_mass_m());
    for (const Shape& shape : link.visuals) *part.add_visuals() = message_of(shape, message, meshes);
    for (const Shape& shape : link.collisions) *part.add_collisions() = message_of(shape, message, meshes);
  }
  for (const Plane& plane : scene.planes) {
    koboshi::Plane& part = *message.add_planes();
    append(plane.normal_W, *part.mutable_normal());
    part.set_offset_m(plane.offset_m);
  }
  for (const Shape& shape : scene.ground) *message.add_ground() = message_of(shape, message, meshes);
  for (std::size_t side = 0; side < scene.soles_L.size(); ++side) {
    koboshi::Sole& sole = *message.add_soles();
    sole.set_link(scene.sole_links[side]);
    for (const Eigen::Vector3d& corner : scene.soles_L[side]) append(corner, *sole.mutable_corners_m());
  }
  return message;
}

Scene scene_of(const koboshi::Scene& message) {
  std::vector<Mesh> meshes;
  for (const koboshi::Mesh& mesh : message.meshes()) meshes.push_back(mesh_of(mesh));
  Scene scene{.robot = message.robot()};
  for (const koboshi::Link& link : message.links()) scene.links.push_back(link_of(link, meshes));
  const int links = message.links_size();
  for (const Link& link : scene.links) check(link.parent >= -1 && link.parent < links, "a link's parent");
  for (const koboshi::Plane& plane : message.planes())
    scene.planes.push_back({vector_of(plane.normal(), "a plane's normal"), plane.offset_m()});
  scene.ground = shapes_of(message.ground(), meshes);
  check(message.soles_size() == static_cast<int>(scene.soles_L.size()), "the number of soles");
  for (int side = 0; side < message.soles_size(); ++side) {
    const koboshi::Sole& sole = message.soles(side);
    check(sole.link() >= -1 && sole.link() < links && sole.corners_m_size() % 3 == 0, "a sole");
    scene.sole_links[static_cast<std::size_t>(side)] = sole.link();
    for (int i = 0; i < sole.corners_m_size(); i += 3)
      scene.soles_L[static_cast<std::size_t>(side)].emplace_back(sole.corners_m(i), sole.corners_m(i + 1),
                                                                 sole.corners_m(i + 2));
  }
  return scene;
}

foxglove::SceneUpdate scene_update(const Scene& scene, const char* world) {
  foxglove::SceneUpdate update;
  foxglove::SceneEntity& ground = add_entity("ground", world, update);
  for (const Plane& plane : scene.planes) add_shape(slab(plane), ground);
  for (const Shape& shape : scene.ground) add_shape(shape, ground);
  for (const Link& link : scene.links) {
    foxglove::SceneEntity& entity = add_entity(link.name, link.name, update);
    for (const Shape& shape : link.visuals.empty() ? link.collisions : link.visuals) add_shape(shape, entity);
  }
  return update;
}

}  // namespace koboshi::view
