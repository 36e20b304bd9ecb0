#include "sim_board/description/load_parts.h"
#include "sim_board/description/schema/sdf_version.h"

namespace koboshi::sim_board {
namespace {

Eigen::Vector3d vector_of(const XmlNode& node) {
  const std::vector<double> values = node.numbers();
  return {values[0], values[1], values[2]};
}

SurfaceDescription load_surface(const XmlNode& node) {
  SurfaceDescription surface;
  const XmlNode friction = node.child("friction").child("ode");
  surface.friction = friction.number("mu");
  surface.friction_second = friction.number("mu2", surface.friction);
  if (const auto direction = friction.find("fdir1")) surface.friction_direction = vector_of(*direction);
  if (const auto bounce = node.find("bounce")) {
    surface.bounce = bounce->number("restitution_coefficient");
    surface.bounce_threshold_m_per_s = bounce->number("threshold");
  }
  const XmlNode contact = node.child("contact").child("ode");
  surface.error_reduction = contact.number("soft_erp");
  surface.constraint_force_mixing = contact.number("soft_cfm");
  surface.reference_step_s = node.number("koboshi:reference_step_s", surface.reference_step_s);
  if (const auto material = node.find("koboshi:material")) surface.material = material->text();
  return surface;
}

BoxDescription load_collision(const XmlNode& node, const ModelFrames& frames, const std::string& link) {
  return {.name = node.attribute("name"),
          .X_LG = frames.part_pose(node, link).isometry(),
          .size_m = vector_of(node.child("geometry").child("box").child("size")),
          .surface = load_surface(node.child("surface")),
          .colour = std::nullopt};
}

MeshDescription load_mesh(const XmlNode& node, const std::filesystem::path& folder) {
  const auto scale = node.find("scale");
  MeshDescription mesh;
  mesh.file = folder / node.child("uri").text();
  if (scale) mesh.scale = vector_of(*scale);
  return mesh;
}

std::optional<ColourDescription> load_colour(const XmlNode& visual) {
  const auto material = visual.find("material");
  const auto diffuse = material ? material->find("diffuse") : std::nullopt;
  if (!diffuse) return std::nullopt;
  const std::vector<double> values = diffuse->numbers();  // the fourth is the opacity
  return ColourDescription{static_cast<float>(values[0]), static_cast<float>(values[1]),
                           static_cast<float>(values[2])};
}

void load_visual(const XmlNode& node, const ModelFrames& frames, const std::filesystem::path& folder,
                 LinkDescription& link) {
  const Eigen::Isometry3d X_LG = frames.part_pose(node, link.name).isometry();
  const XmlNode geometry = node.child("geometry");
  if (const auto mesh = geometry.find("mesh")) {
    MeshDescription loaded = load_mesh(*mesh, folder);
    loaded.name = node.attribute("name");
    loaded.X_LG = X_LG;
    loaded.colour = load_colour(node);
    link.meshes.push_back(std::move(loaded));
  } else {
    link.visual_boxes.push_back({.name = node.attribute("name"),
                                 .X_LG = X_LG,
                                 .size_m = vector_of(geometry.child("box").child("size")),
                                 .surface = {},
                                 .colour = load_colour(node)});
  }
}

void load_inertial(const XmlNode& node, LinkDescription& link) {
  const auto pose = node.find("pose");
  const FramePose X_LI = pose ? FramePose::from_numbers(pose->numbers()) : FramePose();
  link.mass_kg = node.number("mass");
  link.mass_line = node.child("mass").line();
  link.p_LCom_L = X_LI.position;
  link.I_LCom_L = rotated_inertia(X_LI.rotation, inertia_matrix(node.child("inertia")));
}

}  // namespace

Eigen::Matrix3d inertia_matrix(const XmlNode& node) {
  const double ixy = node.number("ixy", 0.0);
  const double ixz = node.number("ixz", 0.0);
  const double iyz = node.number("iyz", 0.0);
  Eigen::Matrix3d inertia;
  inertia << node.number("ixx"), ixy, ixz, ixy, node.number("iyy"), iyz, ixz, iyz, node.number("izz");
  return inertia;
}

LinkDescription load_link(const XmlNode& node, const ModelFrames& frames,
                          const std::filesystem::path& folder) {
  LinkDescription description;
  description.name = node.attribute("name");
  description.line = node.line();
  description.X_ML = frames.pose(description.name, kModelFrame).isometry();
  load_inertial(node.child("inertial"), description);
  for (const XmlNode& collision : node.children("collision"))
    description.collisions.push_back(load_collision(collision, frames, description.name));
  for (const XmlNode& visual : node.children("visual")) load_visual(visual, frames, folder, description);
  return description;
}

}  // namespace koboshi::sim_board
