#include <sdf/Collision.hh>
#include <sdf/Visual.hh>

#include "sim_board/robot/load_parts.h"

namespace koboshi::sim {
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

BoxDescription load_collision(const sdf::Collision& collision, const XmlNode& node,
                              const std::string& link_name) {
  return {.name = collision.Name(),
          .X_LG = resolve_pose(collision.SemanticPose(), link_name, node),
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

void load_visual(const sdf::Visual& visual, const XmlNode& node, const std::filesystem::path& folder,
                 LinkDescription& link) {
  const Eigen::Isometry3d X_LG = resolve_pose(visual.SemanticPose(), link.name, node);
  const XmlNode geometry = node.child("geometry");
  if (const auto mesh = geometry.find("mesh")) {
    MeshDescription loaded = load_mesh(*mesh, folder);
    loaded.name = visual.Name();
    loaded.X_LG = X_LG;
    loaded.colour = load_colour(node);
    link.meshes.push_back(std::move(loaded));
  } else {
    link.visual_boxes.push_back({.name = visual.Name(),
                                 .X_LG = X_LG,
                                 .size_m = vector_of(geometry.child("box").child("size")),
                                 .surface = {},
                                 .colour = load_colour(node)});
  }
}

}  // namespace

LinkDescription load_link(const sdf::Link& link, const XmlNode& node, const std::filesystem::path& folder) {
  LinkDescription description;
  description.name = link.Name();
  description.line = node.line();
  description.X_ML = resolve_pose(link.SemanticPose(), "__model__", node);

  const auto& inertial = link.Inertial();
  description.mass_kg = inertial.MassMatrix().Mass();
  description.mass_line = node.child("inertial").child("mass").line();
  description.p_LCom_L = to_isometry(inertial.Pose()).translation();
  const auto inertia = inertial.Moi();  // about the centre of mass, in the link's axes
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      description.I_LCom_L(row, column) =
          inertia(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
    }
  }

  for (const XmlNode& collision : node.children("collision")) {
    description.collisions.push_back(
        load_collision(found_part(link.CollisionByName(collision.attribute("name")), collision), collision,
                       description.name));
  }
  for (const XmlNode& visual : node.children("visual")) {
    load_visual(found_part(link.VisualByName(visual.attribute("name")), visual), visual, folder, description);
  }
  return description;
}

}  // namespace koboshi::sim
