#include "tools/import/write/robot_sdf.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>

#include <fmt/format.h>

#include "base/text/text.h"
#include "base/xml/xml_text.h"
#include "firmware/robot/model.h"
#include "sim_board/description/frame_pose.h"
#include "sim_board/description/reserved_nodes.h"
#include "tools/import/decide/role_joints.h"
#include "tools/import/write/sensors_sdf.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

// Lengths in steps of 1 um, without a negative zero.
std::string length(double value_m) {
  const double rounded = std::round(value_m * 1e6) / 1e6;
  return number_text(rounded == 0.0 ? 0.0 : rounded);
}
std::string lengths(const Vector3d& p_m) {
  return length(p_m.x()) + " " + length(p_m.y()) + " " + length(p_m.z());
}
std::string pose(const Eigen::Isometry3d& X) {
  const Vector3d angles_rad = sim_board::fixed_axis_angles(X.linear());
  const auto angle = [](double value_rad) {
    const double rounded = std::round(value_rad * 1e9) / 1e9;
    return number_text(rounded == 0.0 ? 0.0 : rounded);
  };
  return lengths(X.translation()) + " " + angle(angles_rad.x()) + " " + angle(angles_rad.y()) + " " +
         angle(angles_rad.z());
}

std::string significant(double value) { return fmt::format("{:.6g}", value); }

std::string inertial_text(const ImportedLink& link) {
  const Eigen::Matrix3d& I = link.I_LCom_L;
  return fmt::format(
      "      <inertial>\n"
      "        <pose>{} 0 0 0</pose>\n"
      "        <mass>{}</mass>\n"
      "        <inertia>\n"
      "          <ixx>{}</ixx><iyy>{}</iyy><izz>{}</izz>\n"
      "          <ixy>{}</ixy><ixz>{}</ixz><iyz>{}</iyz>\n"
      "        </inertia>\n"
      "      </inertial>\n",
      lengths(link.p_LCom_L), significant(link.mass_kg), significant(I(0, 0)), significant(I(1, 1)),
      significant(I(2, 2)), significant(I(0, 1)), significant(I(0, 2)), significant(I(1, 2)));
}

std::string collision_text(const ImportedShape& box, double friction) {
  return fmt::format(
      "      <collision name=\"box\">\n"
      "        <pose>{} 0 0 0</pose>\n"
      "        <geometry><box><size>{}</size></box></geometry>\n"
      "        <surface>\n"
      "          <friction><ode><mu>{}</mu></ode></friction>\n"
      "          <contact><ode><soft_cfm>0.0001</soft_cfm><soft_erp>0.2</soft_erp></ode></contact>\n"
      "        </surface>\n"
      "      </collision>\n",
      lengths(box.X_LG.translation()), lengths(box.size_m), number_text(friction));
}

std::string visual_text(const LinkMesh& mesh, std::size_t index) {
  std::string text = fmt::format(
      "      <visual name=\"shape_{}\">\n        <geometry><mesh><uri>{}</uri></mesh></geometry>\n", index,
      xml_escaped(mesh.file));
  if (mesh.colour)
    text += fmt::format("        <material><diffuse>{:.4g} {:.4g} {:.4g} 1</diffuse></material>\n",
                        (*mesh.colour)[0], (*mesh.colour)[1], (*mesh.colour)[2]);
  return text + "      </visual>\n";
}

class RobotWriter {
 public:
  RobotWriter(const ImportedRobot& robot, const RobotFileParts& parts, const ServoCatalogue& catalogue)
      : robot_(robot), parts_(parts), catalogue_(catalogue), root_(root_link(robot)) {
    for (const ImportedLink& link : robot.links) weight_N_ += 9.80665 * link.mass_kg;
  }

  std::string text() const {
    std::string text = fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<!--\n"
        "  Written by `koboshi model import` from {}. import.md says how, import.yaml what was decided.\n"
        "  SI units, radians, x forward, y left, z up. A joint's anchor and the frame of its child link "
        "coincide.\n"
        "-->\n"
        "<sdf version=\"1.9\" xmlns:koboshi=\"https://koboshi.invalid/sdf\">\n"
        "  <model name=\"{}\">\n",
        comment(parts_.source), xml_escaped(parts_.name));
    std::set<std::string> types;
    for (const ImportedJoint& joint : robot_.joints)
      if (!joint.is_follower) types.insert(servo_of(joint.name));
    for (const std::string& type : types) text += indented(catalogue_.text(type), "    ");
    text += fmt::format(
        "    <!-- Resistance of cells, switch and wires: assumed. -->\n"
        "    <koboshi:battery open_circuit_V=\"{}\" internal_resistance_ohm=\"0.06\"/>\n",
        number_text(parts_.battery_V));
    text += link_text(root_);
    for (const std::size_t joint : joints_from_root(robot_)) {
      text += link_text(robot_.joints[joint].child);
      text += joint_text(robot_.joints[joint]);
    }
    return text + frames_text() + "  </model>\n</sdf>\n";
  }

 private:
  const std::string& servo_of(const std::string& joint) const {
    const auto found = parts_.servos.find(joint);
    return found == parts_.servos.end() ? parts_.servo : found->second;
  }
  // Two hyphens end no comment of XML, but are not permitted in one.
  static std::string comment(std::string text) {
    for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--")) text.erase(at, 1);
    return text;
  }
  static std::string indented(const std::string& lines, const std::string& blanks) {
    std::string text;
    std::size_t begin = 0;
    while (begin < lines.size()) {
      const std::size_t end = std::min(lines.find('\n', begin), lines.size());
      const std::string line = lines.substr(begin, end - begin);
      if (!trimmed_name(line).empty())  // the printer gives each element in the indentation of its depth
        text += (line.find_first_not_of(' ') >= 4 ? blanks + "  " : blanks) +
                std::string(trimmed_name(line)) + "\n";
      begin = end + 1;
    }
    return text;
  }

  // The model's frame is on the ground.
  double base_height_m() const {
    double lowest_m = 0.0;
    const std::vector<Eigen::Isometry3d> X_BL = link_poses(robot_);
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      for (const ImportedShape& box : robot_.links[i].collisions)
        lowest_m = std::min(lowest_m, (X_BL[i] * box.X_LG.translation()).z() - 0.5 * box.size_m.z());
    return -lowest_m;
  }

  std::string link_text(int index) const {
    const ImportedLink& link = robot_.links[static_cast<std::size_t>(index)];
    std::string text = fmt::format("\n    <link name=\"{}\">\n", xml_escaped(link.name));
    if (index == root_) {
      text += fmt::format("      <pose>0 0 {} 0 0 0</pose>\n", length(base_height_m()));
    } else {
      const ImportedJoint& joint = robot_.joints[static_cast<std::size_t>(joint_of(robot_, index))];
      text += fmt::format("      <pose relative_to=\"{}\">{} 0 0 0</pose>\n",
                          xml_escaped(robot_.links[static_cast<std::size_t>(joint.parent)].name),
                          lengths(joint.X_PL.translation()));
    }
    text += inertial_text(link);
    for (const ImportedShape& box : link.collisions) text += collision_text(box, parts_.friction);
    if (const auto meshes = parts_.meshes.find(link.name); meshes != parts_.meshes.end())
      for (std::size_t i = 0; i < meshes->second.size(); ++i) text += visual_text(meshes->second[i], i + 1);
    if (index == root_) text += imu_sdf(imu_pose(link));
    return text + "    </link>\n";
  }

  std::string imu_pose(const ImportedLink& trunk) const {
    for (const ImportedFrame& frame : trunk.frames)
      if (frame.name == parts_.imu_frame) return pose(frame.X_LF);
    return lengths(trunk.p_LCom_L) + " 0 0 0";
  }

  std::string joint_text(const ImportedJoint& joint) const {
    const auto name_of = [this](int link) {
      return xml_escaped(robot_.links[static_cast<std::size_t>(link)].name);
    };
    std::string text = fmt::format(
        "    <joint name=\"{}\" type=\"revolute\">\n"
        "      <parent>{}</parent><child>{}</child>\n"
        "      <axis>\n"
        "        <xyz>{} {} {}</xyz>\n"
        "        <limit><lower>{:.6f}</lower><upper>{:.6f}</upper><velocity>{:.4g}</velocity></limit>\n"
        "{}"
        "      </axis>\n",
        xml_escaped(joint.name), name_of(joint.parent), name_of(joint.child), component(joint.axis_L.x()),
        component(joint.axis_L.y()), component(joint.axis_L.z()), *joint.lower_rad, *joint.upper_rad,
        joint.speed_rad_per_s, joint.is_follower ? mimic_text(joint) : "");
    if (!joint.is_follower) text += drive_text(joint);
    for (const char* side : {"left", "right"})
      if (moves_foot(joint, side)) text += ankle_sensor_sdf(side, weight_N_);
    return text + "    </joint>\n";
  }

  static std::string mimic_text(const ImportedJoint& joint) {
    return fmt::format(
        "        <mimic joint=\"{}\"><multiplier>{:.9g}</multiplier><offset>{:.6f}</offset></mimic>\n",
        xml_escaped(joint.mimics), joint.mimic_ratio, joint.mimic_offset_rad + 0.0);
  }

  std::string drive_text(const ImportedJoint& joint) const {
    const int node_id = node_id_of(joint.name);
    return fmt::format(
        "      <koboshi:servo type=\"{}\"{}/>\n"
        "      <koboshi:encoder bits=\"{}\" noise_counts=\"0.1\"/>\n"
        "      <koboshi:drive node_id=\"{}\" serial_number=\"{}\" sign=\"{}\" zero_rad=\"{:.6f}\"/>\n",
        xml_escaped(servo_of(joint.name)),
        joint.reduction == 1.0 ? "" : fmt::format(" gear=\"{}\"", number_text(joint.reduction)),
        encoder_bits(joint), node_id, node_id, joint.drive_sign, joint.drive_zero_rad);
  }

  // The last joint of an ankle: the sensor is between the robot and its foot.
  bool moves_foot(const ImportedJoint& joint, const std::string& side) const {
    return joint.name.starts_with(side + "_ankle_") &&
           robot_.links[static_cast<std::size_t>(joint.child)].name == side + "_foot";
  }

  // The servos' own encoders: behind a stage, a turn of the joint has more counts, or fewer.
  static int encoder_bits(const ImportedJoint& joint) {
    constexpr int kServo_bits = 12;
    return std::clamp(kServo_bits + static_cast<int>(std::floor(std::log2(joint.reduction))), 8, 24);
  }

  static std::string component(double value) {
    return value == std::round(value) ? number_text(value == 0.0 ? 0.0 : value)
                                      : fmt::format("{:.9f}", value);
  }

  // Node ids from 16 on without reserved ones, in the order of the firmware's roles; the others follow.
  int node_id_of(const std::string& name) const {
    constexpr int kFirst = 16;
    std::vector<std::string> order = role_names();
    for (const ImportedJoint& joint : robot_.joints)
      if (find_role(joint.name) == nullptr) order.push_back(joint.name);
    std::erase_if(order, [this](const std::string& other) {
      const auto joint = robot_.find_joint(other);
      return !joint || robot_.joints[static_cast<std::size_t>(*joint)].is_follower;
    });
    const auto place = std::ranges::find(order, name) - order.begin();
    int node_id = kFirst - 1;
    for (std::ptrdiff_t passed = -1; passed < place;)
      if (sim_board::owner_of_node(++node_id).empty()) ++passed;
    return node_id;
  }

  std::string frames_text() const {
    std::string text;
    for (const ImportedLink& link : robot_.links)
      for (const ImportedFrame& frame : link.frames)
        text += fmt::format("    <frame name=\"{}\" attached_to=\"{}\"><pose>{}</pose></frame>\n",
                            xml_escaped(frame.name), xml_escaped(link.name), pose(frame.X_LF));
    return text.empty() ? text
                        : "\n    <!-- Links of the source that are part of another one here. -->\n" + text;
  }

  const ImportedRobot& robot_;
  const RobotFileParts& parts_;
  const ServoCatalogue& catalogue_;
  int root_;
  double weight_N_ = 0.0;
};

// A name that the firmware's model holds: at most 24 bytes, cut between two characters.
std::string short_name(const std::string& name) {
  const std::string line = utf8_line(name);
  std::size_t size = std::min(line.size(), robot::kModelNameSize);
  while (size > 0 && find_invalid_utf8(std::string_view(line).substr(0, size)) != std::string_view::npos)
    --size;
  const std::string text(trimmed_name(std::string_view(line).substr(0, size)));
  return name_fault(text).empty() ? text : "robot";
}

// Asks for the robot's name. Warns of a name that is too long, of the source or of an answer.
std::string decide_name(const std::string& of_source, Interview& interview, ImportReport& report) {
  const std::string preset = short_name(of_source);
  const std::string answer = interview.answer({"name", "What is the robot's name?", preset, {}});
  const std::string& wanted = answer == preset ? of_source : answer;
  std::string name = short_name(wanted);
  if (name != wanted && !wanted.empty())
    report.warnings.push_back(
        fmt::format("the robot is named {} instead of {}, because its name has at most {} bytes and no "
                    "control characters; `name` in import.yaml gives another one",
                    name, utf8_line(wanted), robot::kModelNameSize));
  return name;
}

}  // namespace

RobotFileParts decide_parts(const ImportedRobot& robot, const ServoCatalogue& catalogue, Interview& interview,
                            ImportReport& report) {
  RobotFileParts parts{.source = robot.file.filename().string(),
                       .servo = interview.taken.answers.at("servo")};
  for (const ImportedJoint& joint : robot.joints)
    if (!joint.is_follower && joint.servo != parts.servo) parts.servos[joint.name] = joint.servo;
  parts.name = decide_name(robot.name, interview, report);
  ImportQuestion imu{"imu",
                     "Where is the IMU: at the trunk's centre of mass (com), or in a frame of the trunk?",
                     "com",
                     {"com"}};
  for (const ImportedFrame& frame : robot.links[static_cast<std::size_t>(root_link(robot))].frames) {
    imu.choices.push_back(frame.name);
    if (frame.name.find("imu") != std::string::npos && imu.preset == "com") imu.preset = frame.name;
  }
  parts.imu_frame = imu.choices.size() > 1 || interview.given().answers.contains("imu")
                        ? interview.answer(imu)
                        : imu.preset;
  parts.friction = interview.number(
      {"friction", "What is the coefficient of friction of the soles?", "0.8", {}}, 0.05, 5.0);
  const auto most_used = std::ranges::find(robot.joints, parts.servo, &ImportedJoint::servo);
  const ImportedJoint& powered = most_used == robot.joints.end() ? robot.joints.front() : *most_used;
  const double supply_V = catalogue.find(powered.servo, robot.file).servo.supply_V;
  parts.battery_V = interview.number(
      {"battery_V", "What is the voltage of the battery without load?", number_text(supply_V), {}}, 1.0,
      100.0);
  return parts;
}

std::string robot_sdf(const ImportedRobot& robot, const RobotFileParts& parts,
                      const ServoCatalogue& catalogue) {
  return RobotWriter(robot, parts, catalogue).text();
}

}  // namespace koboshi::tools
