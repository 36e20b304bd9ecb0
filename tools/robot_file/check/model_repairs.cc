// Findings and repairs of faults that a file has within its schema: R001, R012 to R015, R017, R020 to
// R027, R030.

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "sim_board/description/description.h"
#include "tools/robot_file/check/draft_repair.h"
#include "tools/robot_file/check/places.h"
#include "tools/robot_file/check/repairs.h"

namespace koboshi::tools {
namespace {

using Kind = DraftChange::Kind;
using sim_board::RobotFault;
using sim_board::RobotFaultKind;

constexpr std::array<const char*, 6> kMoments{"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
constexpr std::array<std::pair<int, int>, 6> kCells{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

std::string code_of(RobotFaultKind kind) {
  switch (kind) {
    case RobotFaultKind::kFrameRing:
      return "R001";
    case RobotFaultKind::kInertia:
      return "R012";
    case RobotFaultKind::kLimits:
      return "R013";
    case RobotFaultKind::kAxis:
      return "R014";
    case RobotFaultKind::kMesh:
      return "R015";
    case RobotFaultKind::kVersion:
      return "R017";
    case RobotFaultKind::kName:
      return "R020";
    case RobotFaultKind::kReference:
      return "R021";
    case RobotFaultKind::kTree:
      return "R022";
    case RobotFaultKind::kNodeId:
      return "R023";
    case RobotFaultKind::kShaft:
      return "R024";
    case RobotFaultKind::kSensor:
      return "R025";
    case RobotFaultKind::kServoType:
      return "R026";
    case RobotFaultKind::kShape:
      return "R027";
    case RobotFaultKind::kUnit:
      return "R030";
    case RobotFaultKind::kRole:
      return "R031";
    case RobotFaultKind::kCoupling:
      return "R033";
  }
  return {};
}

XmlNode model_of(const XmlNode& node) {
  XmlNode model = node;
  while (model.name() != "model") model = *model.parent();
  return model;
}

void repair_inertia(const XmlNode& inertia, Repair& repair) {
  Eigen::Matrix3d matrix;
  for (std::size_t i = 0; i < kMoments.size(); ++i) {
    const auto [row, column] = kCells[i];
    matrix(row, column) = matrix(column, row) = inertia.number(kMoments[i], 0.0);
  }
  const auto nearest = nearest_inertia(matrix);
  if (!nearest) {
    repair.finding.repair = "A uniform box of mass m and sides a, b, c has ixx = m (b^2 + c^2) / 12.";
    return;
  }
  std::string values;
  for (std::size_t i = 0; i < kMoments.size(); ++i) {
    const auto [row, column] = kCells[i];
    const std::string value = short_number((*nearest)(row, column));
    const auto child = inertia.find(kMoments[i]);
    if (!child) continue;  // a product that is missing stays zero
    if (child->numbers().front() != koboshi::parse_number(value))
      values += fmt::format("{}{} {}", values.empty() ? "" : ", ", kMoments[i], value);
    repair.changes.push_back({Kind::kText, *child, {}, value});
  }
  repair.finding.repair = fmt::format("The nearest inertia of a rigid body has {}.", values);
}

void repair_axis(const XmlNode& xyz, Repair& repair) {
  const std::vector<double> values = xyz.numbers();
  const auto unit = unit_vector_text({values[0], values[1], values[2]});
  if (!unit) {
    repair.finding.repair = "Give a direction, such as 0 1 0 for a pitch joint.";
    return;
  }
  repair.finding.repair = fmt::format("The unit vector in this direction is {}.", *unit);
  repair.changes = {{Kind::kText, xyz, {}, *unit}};
}

void repair_limits(const XmlNode& limit, Repair& repair) {
  const XmlNode lower = limit.child("lower");
  const XmlNode upper = limit.child("upper");
  if (lower.numbers() == upper.numbers()) {
    repair.finding.repair = "Set a range in which the joint can turn.";
    return;
  }
  repair.finding.repair = fmt::format("Exchange them: lower {}, upper {}.", upper.text(), lower.text());
  repair.changes = {{Kind::kText, lower, {}, upper.text()}, {Kind::kText, upper, {}, lower.text()}};
}

// The zero that puts the middle of the range in the middle of the encoder's turn.
void repair_shaft(const XmlNode& drive, Repair& repair) {
  const XmlNode limit = drive.parent()->child("axis").child("limit");
  const double lower_rad = limit.number("lower");
  const double upper_rad = limit.number("upper");
  if (std::abs(upper_rad - lower_rad) >= 2.0 * std::numbers::pi) {
    repair.finding.repair = "Narrow the limits: the encoder measures one turn.";
    return;
  }
  const double sign =
      static_cast<double>(drive.attribute_integer("sign", sim_board::DriveDescription().sign));
  const std::string zero = short_number(-sign * 0.5 * (lower_rad + upper_rad));
  repair.finding.repair = fmt::format("With zero_rad = {} the range is in the middle of the turn.", zero);
  repair.changes = {{Kind::kAttribute, drive, "zero_rad", zero}};
}

void repair_mesh(const XmlNode& uri, const std::filesystem::path& folder, Repair& repair) {
  if (const auto file = nearest_file(folder, uri.text())) {
    repair.finding.repair = fmt::format("The nearest file is {}.", *file);
    repair.changes = {{Kind::kText, uri, {}, *file}};
    repair.finding.edits = edits_of(repair.changes);
    return;
  }
  repair.finding.repair = "Add the file, or remove the visual.";
  const XmlNode visual = *uri.parent()->parent()->parent();
  repair.changes = {{Kind::kErase, visual, {}, {}}};
}

// Names that a reference may have.
std::vector<std::string> names_for(const RobotFault& fault) {
  std::vector<std::string> kinds{"link"};
  if (fault.attribute == "type") {
    kinds = {"koboshi:servo_type"};
  } else if (fault.attribute.empty()) {  // <parent> and <child>
    kinds.emplace_back("frame");
  } else if (fault.attribute != "canonical_link") {
    kinds.insert(kinds.end(), {"joint", "frame"});
  }
  std::vector<std::string> names;
  for (const std::string& kind : kinds)
    for (const XmlNode& node : model_of(fault.node).children(kind))
      if (const auto name = node.find_attribute("name")) names.push_back(*name);
  return names;
}

void repair_reference(const RobotFault& fault, const std::filesystem::path& folder, Repair& repair) {
  const bool is_attribute = !fault.attribute.empty();
  const std::string written = is_attribute ? fault.node.attribute(fault.attribute) : fault.node.text();
  const auto nearest =
      fault.attribute == "file" ? nearest_file(folder, written) : nearest_name(written, names_for(fault));
  if (!nearest) return;
  repair.finding.repair = fmt::format("The nearest is {}.", *nearest);
  repair.changes = {{is_attribute ? Kind::kAttribute : Kind::kText, fault.node, fault.attribute, *nearest}};
}

void repair_node_id(const XmlNode& drive, Repair& repair) {
  constexpr int kMaxNodeId = 127;
  std::set<std::int64_t> used;
  for (const XmlNode& joint : model_of(drive).children("joint"))
    if (const auto other = joint.find("koboshi:drive"))
      if (const auto id = other->find_attribute("node_id")) used.insert(parse_integer(*id).value_or(0));
  std::int64_t free = drive.attribute_integer("node_id");
  while (free <= kMaxNodeId && used.contains(free)) ++free;
  if (free > kMaxNodeId) return;
  repair.finding.repair = fmt::format("The next free node id is {}.", free);
  repair.changes = {{Kind::kAttribute, drive, "node_id", std::to_string(free)}};
}

// A copy of a part gets a name of its own; what refers to a link or joint is for people to decide.
void repair_name(const XmlNode& node, Repair& repair) {
  std::string name = node.attribute("name");
  const bool has_separator = name.find("::") != std::string::npos;
  for (std::size_t at = 0; (at = name.find("::")) != std::string::npos;) name.replace(at, 2, "_");
  if (!has_separator) name += "_2";
  const bool is_second = repair.finding.found.starts_with("a second ");
  repair.finding.repair = fmt::format("Rename {}, such as {}.", is_second ? "one of them" : "it", name);
  if (node.name() == "collision" || node.name() == "visual")
    repair.changes = {{Kind::kAttribute, node, "name", name}};
}

void repair_shape(const XmlNode& node, Repair& repair) {
  if (node.name() == "fdir1") {
    repair.finding.repair = "Remove it, or give a direction, such as 1 0 0.";
    repair.changes = {{Kind::kErase, node, {}, {}}};
  } else if (const auto box = node.find("box")) {
    repair.finding.repair = "Remove the box or the mesh.";
    repair.changes = {{Kind::kErase, *box, {}, {}}};
  } else {
    repair.finding.repair = "Add a box or a mesh, or remove the visual.";
    repair.changes = {{Kind::kErase, *node.parent(), {}, {}}};
  }
}

void repair_sensor(const XmlNode& node, Repair& repair) {
  if (node.name() == "koboshi:jitter_s") {
    repair.finding.repair = "A clock of the sensor's own has a jitter of microseconds.";
    repair.changes = {{Kind::kText, node, {}, "0"}};
  } else if (node.name() == "resolution") {
    constexpr double kCounts = 32768.0;
    const std::string resolution = short_number(node.parent()->number("range") / kCounts);
    repair.finding.repair = fmt::format("The range in 16 bits has a resolution of {}.", resolution);
    repair.changes = {{Kind::kText, node, {}, resolution}};
  } else if (node.name() == "delay_s") {
    const XmlNode channel = *node.parent();
    const XmlNode sensor = *channel.parent();
    for (const auto& [name, other] :
         {std::pair("koboshi:accelerometer", "koboshi:gyro"), std::pair("koboshi:torque", "koboshi:force")}) {
      if (channel.name() != name) continue;
      const std::string delay = sensor.child(other).child("delay_s").text();
      repair.finding.repair = fmt::format("Set both to one value, such as {}.", delay);
      repair.changes = {{Kind::kText, node, {}, delay}};
    }
  } else if (repair.finding.expected == "one") {
    repair.finding.repair = "Remove one of the two.";
    repair.changes = {{Kind::kErase, node, {}, {}}};
  } else {
    repair.finding.repair = "Add a <collision> with a box to the foot.";
  }
}

void describe_tree(const XmlNode& node, Repair& repair) {
  repair.finding.repair = node.name() == "joint"
                              ? "Set the <child> of one of the joints to another link."
                              : "Each link but the base needs one joint whose <child> it is.";
}

void describe_servo_type(const XmlNode& node, Repair& repair) {
  if (node.name() == "koboshi:servo_types") {
    repair.finding.repair = "Correct the library.";
    return;
  }
  repair.finding.repair = node.name() == "backlash_rad" ? "Set rotor_inertia_kg_m2, or remove the backlash."
                                                        : "Check both values against the data sheet.";
}

void make_repair(const RobotFault& fault, const std::filesystem::path& folder, Repair& repair) {
  switch (fault.kind) {
    case RobotFaultKind::kName:
      return repair_name(fault.node, repair);
    case RobotFaultKind::kVersion:
      repair.finding.repair =
          fault.expected == "one of the two" ? "Remove one of the two." : "Write " + fault.expected + ".";
      return;
    case RobotFaultKind::kReference:
      return repair_reference(fault, folder, repair);
    case RobotFaultKind::kInertia:
      return repair_inertia(fault.node, repair);
    case RobotFaultKind::kAxis:
      return repair_axis(fault.node, repair);
    case RobotFaultKind::kLimits:
      return repair_limits(fault.node, repair);
    case RobotFaultKind::kShaft:
      return repair_shaft(fault.node, repair);
    case RobotFaultKind::kNodeId:
      return repair_node_id(fault.node, repair);
    case RobotFaultKind::kTree:
      return describe_tree(fault.node, repair);
    case RobotFaultKind::kMesh:
      return repair_mesh(fault.node, folder, repair);
    case RobotFaultKind::kShape:
      return repair_shape(fault.node, repair);
    case RobotFaultKind::kServoType:
      return describe_servo_type(fault.node, repair);
    case RobotFaultKind::kSensor:
      return repair_sensor(fault.node, repair);
    case RobotFaultKind::kUnit:
      repair.finding.repair = "Write the value in the unit of the file.";
      return;
    case RobotFaultKind::kRole:
      repair.finding.repair = fault.node.name() == "koboshi:maker"
                                  ? "Correct one of the two numbers."
                                  : "koboshi model map proposes roles and mirrors.";
      return;
    case RobotFaultKind::kCoupling:
      repair.finding.repair = fault.node.name() == "mimic" || fault.node.name() == "multiplier"
                                  ? "Each motor may turn one joint more than its own."
                                  : "Remove the element, or <mimic>.";
      return;
    case RobotFaultKind::kFrameRing:
      repair.finding.repair = "Let one of them refer to a frame outside of the ring.";
  }
}

}  // namespace

Repair repair_of(const RobotFault& fault, const std::filesystem::path& folder) {
  Repair repair;
  repair.finding = {.code = code_of(fault.kind),
                    .severity = simulation::Severity::kError,
                    .found = fault.found,
                    .expected = fault.expected};
  set_place(repair.finding, place_of(fault.node));
  if (!fault.attribute.empty()) repair.finding.key += "@" + fault.attribute;
  make_repair(fault, folder, repair);
  // A mesh or a visual that goes only lets the other checks go on.
  if (fault.kind != RobotFaultKind::kMesh) repair.finding.edits = edits_of(repair.changes);
  return repair;
}

}  // namespace koboshi::tools
