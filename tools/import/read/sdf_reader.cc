#include "tools/import/read/sdf_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text/text.h"
#include "tools/import/read/sdf_frames.h"
#include "tools/import/read/xml_rules.h"
#include "tools/import/read/xml_values.h"

namespace koboshi::tools {
namespace {

using enum XmlCount;

XmlRule pose_rule() {
  XmlRule rule = value_element("pose");
  rule.attributes = {value_attribute("relative_to", false), value_attribute("frame", false),
                     value_attribute("degrees", false)};
  return rule;
}

XmlRule geometry_rule() {
  return element("geometry", kRequired, {},
                 {element("box", kOptional, {}, {value_element("size", kRequired)}),
                  element("cylinder", kOptional, {},
                          {value_element("radius", kRequired), value_element("length", kRequired)}),
                  element("capsule", kOptional, {},
                          {value_element("radius", kRequired), value_element("length", kRequired)}),
                  element("sphere", kOptional, {}, {value_element("radius", kRequired)}),
                  element("mesh", kOptional, {}, {value_element("uri", kRequired), value_element("scale")})});
}

XmlRule sdf_link_rule() {
  return element("link", kRepeated, {name_attribute("name")},
                 {pose_rule(),
                  element("inertial", kOptional, {},
                          {pose_rule(), value_element("mass"),
                           element("inertia", kOptional, {},
                                   {value_element("ixx"), value_element("iyy"), value_element("izz"),
                                    value_element("ixy"), value_element("ixz"), value_element("iyz")})}),
                  element("visual", kRepeated, {},
                          {pose_rule(), geometry_rule(),
                           element("material", kOptional, {}, {value_element("diffuse")})}),
                  element("collision", kRepeated, {}, {pose_rule(), geometry_rule()})});
}

XmlRule sdf_joint_rule() {
  XmlRule xyz = value_element("xyz");
  xyz.attributes = {value_attribute("expressed_in", false)};
  return element(
      "joint", kRepeated, {name_attribute("name"), name_attribute("type")},
      {pose_rule(), value_element("parent", kRequired), value_element("child", kRequired),
       element(
           "axis", kOptional, {},
           {xyz, value_element("use_parent_model_frame"),
            element("limit", kOptional, {},
                    {value_element("lower"), value_element("upper"), value_element("effort"),
                     value_element("velocity")}),
            element("mimic", kOptional, {name_attribute("joint")},
                    {value_element("multiplier"), value_element("offset"), value_element("reference")})})});
}

const XmlRule& sdf_file_rule() {
  static const XmlRule rule = element(
      "sdf", kOptional, {value_attribute("version")},
      {element("model", kRequired, {name_attribute("name")},
               {sdf_link_rule(), sdf_joint_rule(),
                element("frame", kRepeated, {name_attribute("name"), value_attribute("attached_to", false)},
                        {pose_rule()}),
                pose_rule()})});
  return rule;
}

double positive_in(const XmlNode& node, const char* child) {
  const XmlNode value = node.child(child);
  const double number = number_in(value, value.text(), child);
  if (number <= 0.0)
    throw value.error(std::string(child) + " = " + number_text(number), "a number above zero");
  return number;
}

ImportedShape sdf_shape(const XmlNode& node, const Eigen::Isometry3d& X_LG) {
  ImportedShape shape{.line = node.line(), .X_LG = X_LG};
  const XmlNode geometry = node.child("geometry");
  if (const auto box = geometry.find("box")) {
    shape.size_m = vector_in(*box, box->child("size").text(), "size").cwiseAbs();
  } else if (const auto sphere = geometry.find("sphere")) {
    shape.kind = ShapeKind::kSphere;
    shape.size_m = Eigen::Vector3d::Constant(positive_in(*sphere, "radius"));
  } else if (const auto mesh = geometry.find("mesh")) {
    shape.kind = ShapeKind::kMesh;
    shape.uri = std::string(trimmed_name(mesh->child("uri").text()));
    if (const auto scale = mesh->find("scale")) shape.scale = vector_in(*scale, scale->text(), "scale");
  } else {
    const auto cylinder = geometry.find("cylinder");
    const auto round = cylinder ? cylinder : geometry.find("capsule");
    if (!round)
      throw geometry.error("<geometry> without a shape", "a box, cylinder, capsule, sphere or mesh");
    const double radius_m = positive_in(*round, "radius");
    shape.kind = cylinder ? ShapeKind::kCylinder : ShapeKind::kCapsule;
    shape.size_m = {radius_m, radius_m, positive_in(*round, "length")};
  }
  return shape;
}

double child_number(const XmlNode& node, const char* child, double fallback) {
  const auto value = node.find(child);
  return value ? number_in(*value, value->text(), child) : fallback;
}

class SdfReader {
 public:
  SdfReader(const std::filesystem::path& file, const XmlNode& model) : model_(model), frames_(model) {
    robot_.file = file;
    robot_.name = model.attribute("name");
  }

  ImportedRobot read() {
    const std::vector<XmlNode> links = model_.children("link");
    if (links.size() > kMaxImportedLinks)
      throw links[kMaxImportedLinks].error(std::to_string(links.size()) + " links",
                                           "at most " + std::to_string(kMaxImportedLinks));
    for (const XmlNode& link : links) read_link(link);
    for (const XmlNode& joint : model_.children("joint")) read_joint(joint);
    move_links_to_joints();
    return std::move(robot_);
  }

 private:
  // Pose of a part of a link in the link's frame.
  Eigen::Isometry3d in_link(const XmlNode& part, const std::string& link) {
    return frames_.pose_in_model(link, part).inverse() * frames_.pose_in_model(part, link);
  }

  void read_link(const XmlNode& node) {
    ImportedLink link{.name = node.attribute("name"), .line = node.line()};
    X_ML_.push_back(frames_.pose_in_model(link.name, node));
    if (const auto inertial = node.find("inertial")) {
      link.mass_kg = child_number(*inertial, "mass", 1.0);  // SDF's default
      if (link.mass_kg < 0.0)
        throw inertial->error("a mass of " + number_text(link.mass_kg) + " kg", "zero or more");
      Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();
      if (const auto moments = inertial->find("inertia")) {
        const auto moment = [&](const char* name, double fallback) {
          return child_number(*moments, name, fallback);
        };
        inertia = inertia_from(moment("ixx", 1.0), moment("iyy", 1.0), moment("izz", 1.0), moment("ixy", 0.0),
                               moment("ixz", 0.0), moment("iyz", 0.0));
      }
      const Eigen::Isometry3d X_LC = in_link(*inertial, link.name);
      link.p_LCom_L = X_LC.translation();
      link.I_LCom_L = X_LC.linear() * inertia * X_LC.linear().transpose();
    }
    for (const XmlNode& visual : node.children("visual")) {
      link.visuals.push_back(sdf_shape(visual, in_link(visual, link.name)));
      if (const auto material = visual.find("material"))
        if (const auto diffuse = material->find("diffuse")) {
          const auto rgba = parse_numbers(diffuse->text());
          if (!rgba || rgba->size() < 3)
            throw diffuse->error("diffuse = " + one_line(diffuse->text()), "4 numbers");
          std::array<float, 3> colour{};
          for (std::size_t i = 0; i < 3; ++i)
            colour[i] = static_cast<float>(std::clamp((*rgba)[i], 0.0, 1.0));
          link.visuals.back().colour = colour;
        }
    }
    for (const XmlNode& collision : node.children("collision"))
      link.collisions.push_back(sdf_shape(collision, in_link(collision, link.name)));
    robot_.links.push_back(std::move(link));
  }

  int link_index(const XmlNode& node) const {
    const std::string link = frames_.link_of(std::string(trimmed_name(node.text())), node);
    return static_cast<int>(std::ranges::find(robot_.links, link, &ImportedLink::name) -
                            robot_.links.begin());
  }

  void read_joint(const XmlNode& node) {
    ImportedJoint joint{
        .name = node.attribute("name"), .line = node.line(), .kind_name = node.attribute("type")};
    if (std::string(trimmed_name(node.child("parent").text())) == "world")
      return;  // the link becomes the root
    joint.parent = link_index(node.child("parent"));
    joint.child = link_index(node.child("child"));
    const Eigen::Isometry3d X_MJ = frames_.pose_in_model(joint.name, node);
    X_MJ_.push_back(X_MJ);
    joint.kind = joint.kind_name == "revolute"     ? JointKind::kHinge
                 : joint.kind_name == "continuous" ? JointKind::kContinuous
                 : joint.kind_name == "fixed"      ? JointKind::kFixed
                                                   : JointKind::kOther;
    const auto axis = node.find("axis");
    if (axis) read_axis(*axis, X_MJ, joint);
    if (joint.kind == JointKind::kHinge && !joint.upper_rad) joint.kind = JointKind::kContinuous;
    robot_.joints.push_back(std::move(joint));
  }

  void read_axis(const XmlNode& axis, const Eigen::Isometry3d& X_MJ, ImportedJoint& joint) {
    const bool is_hinge = joint.kind == JointKind::kHinge || joint.kind == JointKind::kContinuous;
    joint.axis_L = Eigen::Vector3d::UnitZ();  // SDF's default
    if (const auto xyz = axis.find("xyz"); xyz && is_hinge) {
      joint.axis_L = unit_vector_in(*xyz, xyz->text(), "xyz");
      const auto expressed_in = xyz->find_attribute("expressed_in");
      const auto in_model = axis.find("use_parent_model_frame");
      const bool is_in_model = in_model && (in_model->text() == "1" || in_model->text() == "true");
      if (expressed_in || is_in_model) {
        const Eigen::Isometry3d X_MF = frames_.pose_in_model(expressed_in.value_or(""), *xyz);
        joint.axis_L = (X_MJ.linear().transpose() * X_MF.linear() * joint.axis_L).normalized();
      }
    }
    const auto mimic = axis.find("mimic");
    if (mimic) {
      const auto value = [&mimic](const char* key, double fallback) {
        const auto node = mimic->find(key);
        return node ? number_in(*node, node->text(), key) : fallback;
      };
      joint.mimics = mimic->attribute("joint");
      joint.mimic_ratio = value("multiplier", 1.0);
      joint.mimic_offset_rad = value("offset", 0.0) - joint.mimic_ratio * value("reference", 0.0);
    }
    const auto limit = axis.find("limit");
    if (!limit) return;
    constexpr double kNone = 1e5;  // SDF writes 1e16 and inf for no limit
    const auto number = [&limit](const char* name) -> double {
      const auto value = limit->find(name);
      const auto parsed = value ? parse_number(value->text()) : std::nullopt;
      return parsed ? *parsed : std::numeric_limits<double>::infinity();
    };
    const double lower = number("lower");
    const double upper = number("upper");
    if (joint.kind == JointKind::kHinge && std::abs(lower) < kNone && std::abs(upper) < kNone) {
      if (lower > upper)
        throw limit->error("lower " + number_text(lower) + " above upper " + number_text(upper),
                           "lower below upper");
      joint.lower_rad = lower;
      joint.upper_rad = upper;
    }
    if (const double effort = std::abs(number("effort")); effort < kNone) joint.effort_Nm = effort;
    if (const double speed = std::abs(number("velocity")); speed < kNone) joint.speed_rad_per_s = speed;
  }

  // SDF gives a link and its joint a frame each; here the link's frame is that of its joint.
  void move_links_to_joints() {
    std::vector<Eigen::Isometry3d> X_ML = X_ML_;
    for (std::size_t i = 0; i < robot_.joints.size(); ++i)
      X_ML[static_cast<std::size_t>(robot_.joints[i].child)] = X_MJ_[i];
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const Eigen::Isometry3d X = X_ML[i].inverse() * X_ML_[i];  // the link's own frame in the new one
      ImportedLink& link = robot_.links[i];
      link.p_LCom_L = X * link.p_LCom_L;
      link.I_LCom_L = X.linear() * link.I_LCom_L * X.linear().transpose();
      for (auto* shapes : {&link.visuals, &link.collisions})
        for (ImportedShape& shape : *shapes) shape.X_LG = X * shape.X_LG;
    }
    for (ImportedJoint& joint : robot_.joints)
      joint.X_PL = X_ML[static_cast<std::size_t>(joint.parent)].inverse() *
                   X_ML[static_cast<std::size_t>(joint.child)];
  }

  XmlNode model_;
  SdfFrames frames_;
  ImportedRobot robot_;
  std::vector<Eigen::Isometry3d> X_ML_;  // of the links' own frames
  std::vector<Eigen::Isometry3d> X_MJ_;  // by joint
};

}  // namespace

ImportedRobot read_sdf(const std::filesystem::path& file, const std::string& text, ImportReport& report) {
  const XmlDraft draft(file, text, sdf_file_rule());
  require_rule(draft, sdf_file_rule(), report);
  return SdfReader(file, draft.root().child("model")).read();
}

}  // namespace koboshi::tools
