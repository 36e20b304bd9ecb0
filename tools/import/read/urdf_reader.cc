#include "tools/import/read/urdf_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "base/text/text.h"
#include "tools/import/read/xml_rules.h"
#include "tools/import/read/xml_values.h"

namespace koboshi::tools {
namespace {

using enum XmlCount;

constexpr double kMinReduction = 1e-3;  // of a transmission
constexpr double kMaxReduction = 1e4;

using Colours = std::map<std::string, std::array<float, 3>>;  // by the material's name

XmlRule origin() {
  return element("origin", kOptional, {value_attribute("xyz", false), value_attribute("rpy", false)});
}

XmlRule urdf_geometry() {
  return element("geometry", kRequired, {},
                 {element("box", kOptional, {value_attribute("size")}),
                  element("cylinder", kOptional, {value_attribute("radius"), value_attribute("length")}),
                  element("capsule", kOptional, {value_attribute("radius"), value_attribute("length")}),
                  element("sphere", kOptional, {value_attribute("radius")}),
                  element("mesh", kOptional, {name_attribute("filename"), value_attribute("scale", false)})});
}

XmlRule material(XmlCount count) {
  return element("material", count, {value_attribute("name", false)},
                 {element("color", kOptional, {value_attribute("rgba")})});
}

XmlRule urdf_link_rule() {
  return element(
      "link", kRepeated, {name_attribute("name")},
      {element("inertial", kOptional, {},
               {origin(), element("mass", kRequired, {value_attribute("value")}),
                element("inertia", kRequired,
                        {value_attribute("ixx"), value_attribute("iyy"), value_attribute("izz"),
                         value_attribute("ixy", false), value_attribute("ixz", false),
                         value_attribute("iyz", false)})}),
       element("visual", kRepeated, {value_attribute("name", false)},
               {origin(), urdf_geometry(), material(kOptional)}),
       element("collision", kRepeated, {value_attribute("name", false)}, {origin(), urdf_geometry()})});
}

XmlRule urdf_joint_rule() {
  return element("joint", kRepeated, {name_attribute("name"), name_attribute("type")},
                 {origin(), element("parent", kRequired, {name_attribute("link")}),
                  element("child", kRequired, {name_attribute("link")}),
                  element("axis", kOptional, {value_attribute("xyz")}),
                  element("limit", kOptional,
                          {value_attribute("lower", false), value_attribute("upper", false),
                           value_attribute("effort", false), value_attribute("velocity", false)}),
                  element("mimic", kOptional,
                          {name_attribute("joint"), value_attribute("multiplier", false),
                           value_attribute("offset", false)})});
}

XmlRule transmission_rule() {
  const XmlRule reduction = value_element("mechanicalReduction");
  return element("transmission", kRepeated, {value_attribute("name", false)},
                 {value_element("type"), element("joint", kRepeated, {name_attribute("name")}, {reduction}),
                  element("actuator", kRepeated, {value_attribute("name", false)}, {reduction})});
}

const XmlRule& urdf_rule() {
  static const XmlRule rule =
      element("robot", kOptional, {name_attribute("name", false)},
              {material(kRepeated), urdf_link_rule(), urdf_joint_rule(), transmission_rule(),
               value_element("koboshi")});  // of `koboshi model export`
  return rule;
}

Eigen::Isometry3d pose_of(const XmlNode& node) {
  const auto origin = node.find("origin");
  if (!origin) return Eigen::Isometry3d::Identity();
  const auto vector = [&](const char* attribute) -> Eigen::Vector3d {
    const auto text = origin->find_attribute(attribute);
    return text ? vector_in(*origin, *text, attribute) : Eigen::Vector3d::Zero();
  };
  return pose_from(vector("xyz"), vector("rpy"));
}

double positive(const XmlNode& node, const char* attribute) {
  const double value = number_in(node, node.attribute(attribute), attribute);
  if (value <= 0.0)
    throw node.error(std::string(attribute) + " = " + number_text(value), "a number above zero");
  return value;
}

ImportedShape shape_of(const XmlNode& node) {
  ImportedShape shape{.line = node.line(), .X_LG = pose_of(node)};
  const XmlNode geometry = node.child("geometry");
  if (const auto box = geometry.find("box")) {
    shape.size_m = vector_in(*box, box->attribute("size"), "size").cwiseAbs();
  } else if (const auto cylinder = geometry.find("cylinder")) {
    const double radius_m = positive(*cylinder, "radius");
    shape.kind = ShapeKind::kCylinder;
    shape.size_m = {radius_m, radius_m, positive(*cylinder, "length")};
  } else if (const auto capsule = geometry.find("capsule")) {
    const double radius_m = positive(*capsule, "radius");
    shape.kind = ShapeKind::kCapsule;
    shape.size_m = {radius_m, radius_m, positive(*capsule, "length")};
  } else if (const auto sphere = geometry.find("sphere")) {
    shape.kind = ShapeKind::kSphere;
    shape.size_m = Eigen::Vector3d::Constant(positive(*sphere, "radius"));
  } else if (const auto mesh = geometry.find("mesh")) {
    shape.kind = ShapeKind::kMesh;
    shape.uri = mesh->attribute("filename");
    if (const auto scale = mesh->find_attribute("scale")) shape.scale = vector_in(*mesh, *scale, "scale");
  } else {
    throw geometry.error("<geometry> without a shape", "a box, cylinder, capsule, sphere or mesh");
  }
  return shape;
}

std::optional<std::array<float, 3>> colour_of(const XmlNode& material, const Colours& colours) {
  if (const auto color = material.find("color")) {
    const std::vector<double> rgba = numbers_in(*color, color->attribute("rgba"), 4, "rgba");
    std::array<float, 3> rgb{};
    for (std::size_t i = 0; i < 3; ++i) rgb[i] = static_cast<float>(std::clamp(rgba[i], 0.0, 1.0));
    return rgb;
  }
  const auto found = colours.find(material.find_attribute("name").value_or(""));
  return found == colours.end() ? std::nullopt : std::optional(found->second);
}

void read_inertial(const XmlNode& inertial, ImportedLink& link) {
  const XmlNode mass = inertial.child("mass");
  link.mass_kg = number_in(mass, mass.attribute("value"), "mass");
  if (link.mass_kg < 0.0) throw mass.error("a mass of " + number_text(link.mass_kg) + " kg", "zero or more");
  const XmlNode node = inertial.child("inertia");
  const auto moment = [&node](const char* attribute) {
    const auto text = node.find_attribute(attribute);
    return text ? number_in(node, *text, attribute) : 0.0;
  };
  const Eigen::Matrix3d inertia =
      inertia_from(moment("ixx"), moment("iyy"), moment("izz"), moment("ixy"), moment("ixz"), moment("iyz"));
  const Eigen::Isometry3d X_LC = pose_of(inertial);
  link.p_LCom_L = X_LC.translation();
  link.I_LCom_L = X_LC.linear() * inertia * X_LC.linear().transpose();
}

ImportedLink read_link(const XmlNode& node, const Colours& colours) {
  ImportedLink link{.name = node.attribute("name"), .line = node.line()};
  if (const auto inertial = node.find("inertial")) read_inertial(*inertial, link);
  for (const XmlNode& visual : node.children("visual")) {
    link.visuals.push_back(shape_of(visual));
    if (const auto material = visual.find("material"))
      link.visuals.back().colour = colour_of(*material, colours);
  }
  for (const XmlNode& collision : node.children("collision")) link.collisions.push_back(shape_of(collision));
  return link;
}

JointKind kind_of(const std::string& type) {
  if (type == "revolute") return JointKind::kHinge;
  if (type == "continuous") return JointKind::kContinuous;
  return type == "fixed" ? JointKind::kFixed : JointKind::kOther;
}

void read_limits(const XmlNode& node, ImportedJoint& joint) {
  const auto limit = node.find("limit");
  const bool has_range = limit && (limit->find_attribute("lower") || limit->find_attribute("upper"));
  if (joint.kind == JointKind::kHinge && !has_range) joint.kind = JointKind::kContinuous;
  if (!limit) return;
  const auto find = [&limit](const char* attribute) -> std::optional<double> {
    constexpr double kNone = 1e5;  // exporters write 1e16 and inf for no limit
    const auto text = limit->find_attribute(attribute);
    if (!text || *text == "inf" || *text == "-inf") return std::nullopt;
    const auto value = parse_number(*text);
    if (value && std::abs(*value) >= kNone) return std::nullopt;
    return number_in(*limit, *text, attribute);
  };
  const auto is_endless = [&](const char* attribute) {
    return limit->find_attribute(attribute) && !find(attribute);
  };
  if (joint.kind == JointKind::kHinge && (is_endless("lower") || is_endless("upper")))
    joint.kind = JointKind::kContinuous;
  if (joint.kind == JointKind::kHinge) {
    joint.lower_rad = find("lower").value_or(0.0);
    joint.upper_rad = find("upper").value_or(0.0);
    if (*joint.lower_rad > *joint.upper_rad)
      throw limit->error(
          "lower " + number_text(*joint.lower_rad) + " above upper " + number_text(*joint.upper_rad),
          "lower below upper");
  }
  joint.effort_Nm = std::abs(find("effort").value_or(0.0));
  joint.speed_rad_per_s = std::abs(find("velocity").value_or(0.0));
}

int index_of(const std::map<std::string, int>& links, const XmlNode& node) {
  const std::string name = node.attribute("link");
  const auto found = links.find(name);
  if (found == links.end()) throw node.error("link " + one_line(name), "the name of a <link>");
  return found->second;
}

ImportedJoint read_joint(const XmlNode& node, const std::map<std::string, int>& links) {
  ImportedJoint joint{
      .name = node.attribute("name"), .line = node.line(), .kind_name = node.attribute("type")};
  joint.kind = kind_of(joint.kind_name);
  joint.parent = index_of(links, node.child("parent"));
  joint.child = index_of(links, node.child("child"));
  joint.X_PL = pose_of(node);
  const bool is_hinge = joint.kind == JointKind::kHinge || joint.kind == JointKind::kContinuous;
  if (const auto axis = node.find("axis"); axis && is_hinge)
    joint.axis_L = unit_vector_in(*axis, axis->attribute("xyz"), "xyz");
  read_limits(node, joint);
  if (const auto mimic = node.find("mimic")) {
    joint.mimics = mimic->attribute("joint");
    if (const auto ratio = mimic->find_attribute("multiplier"))
      joint.mimic_ratio = number_in(*mimic, *ratio, "multiplier");
    if (const auto offset = mimic->find_attribute("offset"))
      joint.mimic_offset_rad = number_in(*mimic, *offset, "offset");
  }
  return joint;
}

// A negative ratio: the actuator turns the other way, which is no matter of the joint.
void read_reduction(const XmlNode& node, ImportedJoint& joint) {
  joint.reduction = std::abs(number_in(node, node.text(), "mechanicalReduction"));
  if (joint.reduction < kMinReduction || joint.reduction > kMaxReduction)
    throw node.error("mechanicalReduction = " + one_line(node.text()),
                     fmt::format("a ratio from {} to {}", kMinReduction, kMaxReduction));
}

void read_transmission(const XmlNode& node, ImportedRobot& robot) {
  for (const XmlNode& driven : node.children("joint")) {
    const auto index = robot.find_joint(driven.attribute("name"));
    if (!index) throw driven.error("joint " + one_line(driven.attribute("name")), "the name of a <joint>");
    ImportedJoint& joint = robot.joints[static_cast<std::size_t>(*index)];
    joint.has_actuator = true;
    std::vector<XmlNode> holders = node.children("actuator");
    holders.push_back(driven);
    for (const XmlNode& holder : holders)
      if (const auto reduction = holder.find("mechanicalReduction")) read_reduction(*reduction, joint);
  }
}

void require_new_name(std::set<std::string>& names, const XmlNode& node) {
  if (!names.insert(node.attribute("name")).second)
    throw node.error("a second " + node.name() + " " + one_line(node.attribute("name")), "a name of its own");
}

}  // namespace

ImportedRobot read_urdf(const std::filesystem::path& file, const std::string& text, ImportReport& report) {
  const XmlDraft draft(file, text, urdf_rule());
  require_rule(draft, urdf_rule(), report);
  const XmlNode root = draft.root();
  ImportedRobot robot{.name = root.find_attribute("name").value_or(file.stem().string()), .file = file};
  Colours colours;
  for (const XmlNode& node : root.children("material"))
    if (const auto colour = colour_of(node, {})) colours[node.find_attribute("name").value_or("")] = *colour;
  // A material may also be defined in the visual that uses it first.
  const std::vector<XmlNode> links = root.children("link");
  if (links.size() > kMaxImportedLinks)
    throw links[kMaxImportedLinks].error(std::to_string(links.size()) + " links",
                                         "at most " + std::to_string(kMaxImportedLinks));
  std::set<std::string> names;
  std::map<std::string, int> index;
  for (const XmlNode& node : links) {
    require_new_name(names, node);
    index[node.attribute("name")] = static_cast<int>(robot.links.size());
    for (const XmlNode& visual : node.children("visual"))
      if (const auto material = visual.find("material"))
        if (const auto colour = colour_of(*material, {}))
          colours.emplace(material->find_attribute("name").value_or(""), *colour);
    robot.links.push_back(read_link(node, colours));
  }
  names.clear();
  for (const XmlNode& node : root.children("joint")) {
    require_new_name(names, node);
    robot.joints.push_back(read_joint(node, index));
  }
  for (const XmlNode& node : root.children("transmission")) read_transmission(node, robot);
  return robot;
}

}  // namespace koboshi::tools
