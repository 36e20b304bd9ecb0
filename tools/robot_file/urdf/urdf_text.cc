#include "tools/robot_file/urdf/urdf_text.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "base/text/text.h"
#include "base/xml/xml_text.h"
#include "sim_board/description/frame_pose.h"
#include "tools/import/servo/servo_catalogue.h"

namespace koboshi::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

std::string number(double value) {
  const double rounded = std::round(value * 1e9) / 1e9;
  return number_text(rounded == 0.0 ? 0.0 : rounded);  // no negative zero
}

std::string numbers(const Vector3d& values) {
  return number(values.x()) + " " + number(values.y()) + " " + number(values.z());
}

std::string origin_text(const Isometry3d& X) {
  return fmt::format("<origin xyz=\"{}\" rpy=\"{}\"/>", numbers(X.translation()),
                     numbers(sim_board::fixed_axis_angles(X.linear())));
}

class UrdfWriter {
 public:
  UrdfWriter(const sim_board::RobotDescription& robot, const std::string& mesh_prefix)
      : robot_(robot), mesh_prefix_(mesh_prefix) {
    for (const sim_board::LinkDescription& link : robot.links) X_MF_.push_back(link.X_ML);
    for (std::size_t i = 0; i < robot.hinge_count(); ++i)
      X_MF_[static_cast<std::size_t>(robot.hinge(i).child)].translation() = robot.hinge(i).p_MJ;
  }

  std::string text(const std::string& robot_file) const {
    std::string text = fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<!-- Written by `koboshi model export`. SI units, radians, x forward, y left, z up. -->\n"
        "<robot name=\"{}\">\n",
        xml_escaped(robot_.name));
    for (std::size_t i = 0; i < robot_.links.size(); ++i) text += link_text(i);
    for (const sim_board::JointDescription& joint : robot_.joints)
      text += joint_text(joint, joint.servo, "") + transmission_text(joint);
    for (const sim_board::FollowerDescription& follower : robot_.followers)
      text += joint_text(follower.hinge, robot_.joints[static_cast<std::size_t>(follower.leader)].servo,
                         mimic_text(follower));
    return text + extension_text(robot_file) + "</robot>\n";
  }

 private:
  std::string link_text(std::size_t index) const {
    const sim_board::LinkDescription& link = robot_.links[index];
    const Isometry3d X_FL = X_MF_[index].inverse() * link.X_ML;
    const Eigen::Matrix3d& I = link.I_LCom_L;
    std::string text = fmt::format(
        "  <link name=\"{}\">\n"
        "    <inertial>\n"
        "      <origin xyz=\"{}\"/>\n"
        "      <mass value=\"{}\"/>\n"
        "      <inertia ixx=\"{:.9g}\" ixy=\"{:.9g}\" ixz=\"{:.9g}\" iyy=\"{:.9g}\" iyz=\"{:.9g}\" "
        "izz=\"{:.9g}\"/>\n"
        "    </inertial>\n",
        xml_escaped(link.name), numbers(X_FL * link.p_LCom_L), number_text(link.mass_kg), I(0, 0),
        I(0, 1) + 0.0, I(0, 2) + 0.0, I(1, 1), I(1, 2) + 0.0, I(2, 2));
    for (const sim_board::MeshDescription& mesh : link.meshes)
      text += visual_text(mesh.name, X_FL * mesh.X_LG, mesh_text(mesh), mesh.colour);
    for (const sim_board::BoxDescription& box : link.visual_boxes)
      text += visual_text(box.name, X_FL * box.X_LG, box_text(box), box.colour);
    for (const sim_board::BoxDescription& box : link.collisions)
      text += fmt::format(
          "    <collision name=\"{}\">\n      {}\n      <geometry>{}</geometry>\n    </collision>\n",
          xml_escaped(box.name), origin_text(X_FL * box.X_LG), box_text(box));
    return text + "  </link>\n";
  }

  static std::string box_text(const sim_board::BoxDescription& box) {
    return fmt::format("<box size=\"{}\"/>", numbers(box.size_m));
  }
  std::string mesh_text(const sim_board::MeshDescription& mesh) const {
    const std::string path =
        mesh.file.lexically_relative(robot_.file.parent_path()).lexically_normal().generic_string();
    return fmt::format("<mesh filename=\"{}\" scale=\"{}\"/>", xml_escaped(mesh_prefix_ + path),
                       numbers(mesh.scale));
  }

  // A material's name is that of all materials with its colour: readers of URDF keep them by name.
  static std::string visual_text(const std::string& name, const Isometry3d& X_FG, const std::string& shape,
                                 const std::optional<sim_board::ColourDescription>& colour) {
    std::string text = fmt::format("    <visual name=\"{}\">\n      {}\n      <geometry>{}</geometry>\n",
                                   xml_escaped(name), origin_text(X_FG), shape);
    if (colour) {
      const std::string rgb = fmt::format("{} {} {}", number_text((*colour)[0]), number_text((*colour)[1]),
                                          number_text((*colour)[2]));
      text += fmt::format("      <material name=\"{0}\"><color rgba=\"{0} 1\"/></material>\n", rgb);
    }
    return text + "    </visual>\n";
  }

  std::string mimic_text(const sim_board::FollowerDescription& follower) const {
    return fmt::format("    <mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>\n",
                       xml_escaped(robot_.joints[static_cast<std::size_t>(follower.leader)].name),
                       number_text(follower.multiplier), number(follower.offset_rad));
  }

  // `servo`: that of the motor that turns the joint.
  std::string joint_text(const sim_board::JointDescription& joint, const sim_board::ServoDescription& servo,
                         const std::string& mimic) const {
    const auto parent = static_cast<std::size_t>(joint.parent);
    const auto child = static_cast<std::size_t>(joint.child);
    return fmt::format(
        "  <joint name=\"{}\" type=\"revolute\">\n"
        "    {}\n"
        "    <parent link=\"{}\"/>\n"
        "    <child link=\"{}\"/>\n"
        "    <axis xyz=\"{}\"/>\n"
        "    <limit lower=\"{}\" upper=\"{}\" effort=\"{:.4g}\" velocity=\"{}\"/>\n"
        "{}  </joint>\n",
        xml_escaped(joint.name), origin_text(X_MF_[parent].inverse() * X_MF_[child]),
        xml_escaped(robot_.links[parent].name), xml_escaped(robot_.links[child].name),
        numbers(X_MF_[child].linear().transpose() * joint.axis_M), number(joint.lower_rad),
        number(joint.upper_rad), stall_torque_Nm(servo), number(joint.max_speed_rad_per_s), mimic);
  }

  static std::string transmission_text(const sim_board::JointDescription& joint) {
    if (joint.gear == 1.0) return {};
    return fmt::format(
        "  <transmission name=\"{0}_transmission\">\n"
        "    <type>transmission_interface/SimpleTransmission</type>\n"
        "    <joint name=\"{0}\"/>\n"
        "    <actuator name=\"{0}_servo\"><mechanicalReduction>{1}</mechanicalReduction></actuator>\n"
        "  </transmission>\n",
        xml_escaped(joint.name), number_text(joint.gear));
  }

  // Marked as text, so that no reader takes the links in it for its own. "]]>" would end it.
  static std::string extension_text(std::string robot_file) {
    if (robot_file.empty()) return {};
    constexpr std::string_view kEnd = "]]>";
    constexpr std::string_view kSplit = "]]]]><![CDATA[>";
    for (std::size_t at = robot_file.find(kEnd); at != std::string::npos;
         at = robot_file.find(kEnd, at + kSplit.size()))
      robot_file.replace(at, kEnd.size(), kSplit);
    return "  <!-- The robot's file, for `koboshi model import`: servos, sensors, drives and roles. -->\n"
           "  <koboshi><![CDATA[" +
           robot_file + "]]></koboshi>\n";
  }

  const sim_board::RobotDescription& robot_;
  const std::string& mesh_prefix_;
  std::vector<Isometry3d> X_MF_;  // frames of the URDF's links
};

}  // namespace

std::string urdf_text(const sim_board::RobotDescription& robot, const std::string& mesh_prefix,
                      const std::string& robot_file) {
  return UrdfWriter(robot, mesh_prefix).text(robot_file);
}

}  // namespace koboshi::tools
