#include "sim_board/robot/check_model.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <set>

namespace koboshi::sim {
namespace {

using Names = std::set<std::string>;

void take_names(const std::vector<XmlNode>& nodes, Names& names) {
  for (const XmlNode& node : nodes) {
    const std::string name = node.attribute("name");
    if (!names.insert(name).second) throw node.error("a second " + one_line(name), "each name once");
  }
}

void check_part_names(const XmlNode& node) {
  for (const char* part : {"collision", "visual", "sensor"}) {
    Names names;
    take_names(node.children(part), names);
  }
}

void check_frame(const XmlNode& node, const std::string& attribute, const Names& frames) {
  const auto frame = node.find_attribute(attribute);
  if (frame && *frame != "__model__" && !frames.contains(*frame)) {
    throw node.error(attribute + " = " + one_line(*frame), "the name of a link or joint");
  }
}

void check_pose(const XmlNode& node, const Names& frames) {
  if (const auto pose = node.find("pose")) check_frame(*pose, "relative_to", frames);
}

// The principal moments of a rigid body are positive, and none exceeds the sum of the others. A thin plate
// equals the sum exactly, so the margin allows for rounding in the file.
void check_inertia(const XmlNode& link) {
  constexpr double kMargin = 1e-4;
  const XmlNode node = link.child("inertial").child("inertia");
  const double ixy = node.number("ixy", 0.0);
  const double ixz = node.number("ixz", 0.0);
  const double iyz = node.number("iyz", 0.0);
  Eigen::Matrix3d inertia;
  inertia << node.number("ixx"), ixy, ixz, ixy, node.number("iyy"), iyz, ixz, iyz, node.number("izz");
  const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia).eigenvalues();
  const std::string found = "principal moments " + number_text(moments[0]) + ", " + number_text(moments[1]) +
                            " and " + number_text(moments[2]) + " kg m^2 in link " + link.attribute("name");
  if (moments[0] < 1e-12) throw node.error(found, "positive ones");
  if (moments[2] > (moments[0] + moments[1]) * (1 + kMargin)) {
    throw node.error(found, "none greater than the sum of the others");
  }
}

// libsdformat normalises any axis and would not detect a mistyped digit.
void check_axis(const XmlNode& node) {
  const std::vector<double> xyz = node.numbers();
  const double length = std::hypot(xyz[0], xyz[1], xyz[2]);
  if (std::abs(length - 1.0) > 1e-4) {
    throw node.error("<xyz> = " + one_line(node.text()) + ", of length " + number_text(length),
                     "a unit vector");
  }
}

void check_link(const XmlNode& link, const Names& frames) {
  check_part_names(link);
  check_pose(link, frames);
  check_inertia(link);
  for (const char* part : {"collision", "visual", "sensor"}) {
    for (const XmlNode& node : link.children(part)) check_pose(node, frames);
  }
}

void check_joint(const XmlNode& joint, const Names& links, const Names& frames) {
  check_part_names(joint);
  check_pose(joint, frames);
  for (const char* end : {"parent", "child"}) {
    const XmlNode node = joint.child(end);
    if (!links.contains(node.text())) {
      throw node.error("<" + node.name() + "> = " + one_line(node.text()), "the name of a link");
    }
  }
  const XmlNode xyz = joint.child("axis").child("xyz");
  check_frame(xyz, "expressed_in", frames);
  check_axis(xyz);
}

}  // namespace

void check_model(const XmlNode& model) {
  Names links;
  take_names(model.children("link"), links);
  Names frames = links;  // links and joints share one name space in SDF
  take_names(model.children("joint"), frames);
  for (const XmlNode& link : model.children("link")) check_link(link, frames);
  for (const XmlNode& joint : model.children("joint")) check_joint(joint, links, frames);
}

}  // namespace koboshi::sim
