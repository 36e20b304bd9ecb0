#include "tools/import/read/xml_values.h"

#include <cmath>
#include <map>
#include <utility>

#include "base/text/text.h"
#include "base/xml/xml_check.h"

namespace koboshi::tools {
namespace {

bool is_ignored(const XmlFault& fault) {
  switch (fault.kind) {
    case XmlFaultKind::kUnknownElement:
    case XmlFaultKind::kUnknownAttribute:
    case XmlFaultKind::kText:
      return true;
    default:
      return false;
  }
}

std::string ignored_name(const XmlFault& fault) {
  if (fault.kind == XmlFaultKind::kText) return "text in <" + fault.node.name() + ">";
  if (fault.kind == XmlFaultKind::kUnknownAttribute)
    return "attribute " + one_line(fault.name) + " of <" + fault.node.name() + ">";
  const auto parent = fault.node.parent();
  return "<" + one_line(fault.node.name()) + ">" + (parent ? " in <" + parent->name() + ">" : std::string());
}

}  // namespace

void require_rule(const XmlDraft& draft, const XmlRule& rule, ImportReport& report) {
  std::map<std::string, std::pair<int, int>> ignored;  // by name: number and first line
  for (const XmlFault& fault : find_xml_faults(draft.root(), rule)) {
    if (!is_ignored(fault)) throw fault.error(draft.path());
    ++ignored.try_emplace(ignored_name(fault), 0, fault.line).first->second.first;
  }
  for (const auto& [name, count] : ignored)
    report.ignored.push_back(name + " (" + std::to_string(count.first) + " times, first in line " +
                             std::to_string(count.second) + ")");
}

std::vector<double> numbers_in(const XmlNode& node, const std::string& text, std::size_t count,
                               const std::string& what) {
  constexpr double kMax = 1e6;
  const auto values = parse_numbers(text);
  const std::string expected =
      count == 1 ? "a number" : std::to_string(count) + " numbers, separated by blanks";
  if (!values || values->size() != count) throw node.error(what + " = " + one_line(text), expected);
  for (const double value : *values)
    if (std::abs(value) >= kMax) throw node.error(what + " = " + one_line(text), expected + " below 1e6");
  return *values;
}

double number_in(const XmlNode& node, const std::string& text, const std::string& what) {
  return numbers_in(node, text, 1, what).front();
}

Eigen::Vector3d vector_in(const XmlNode& node, const std::string& text, const std::string& what) {
  const std::vector<double> values = numbers_in(node, text, 3, what);
  return {values[0], values[1], values[2]};
}

Eigen::Vector3d unit_vector_in(const XmlNode& node, const std::string& text, const std::string& what) {
  const Eigen::Vector3d vector = vector_in(node, text, what);
  if (vector.norm() < 1e-6) throw node.error(what + " = " + one_line(text), "a direction, any but zero");
  return vector.normalized();
}

Eigen::Matrix3d inertia_from(double ixx, double iyy, double izz, double ixy, double ixz, double iyz) {
  Eigen::Matrix3d inertia;
  inertia << ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz;
  return inertia;
}

Eigen::Isometry3d pose_from(const Eigen::Vector3d& position_m, const Eigen::Vector3d& angles_rad) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = position_m;
  pose.linear() = (Eigen::AngleAxisd(angles_rad.z(), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(angles_rad.y(), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(angles_rad.x(), Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace koboshi::tools
