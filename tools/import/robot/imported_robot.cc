#include "tools/import/robot/imported_robot.h"

#include <algorithm>

#include "base/text/error.h"

namespace koboshi::tools {
namespace {

// Names the loop of links in which `link` hangs: "a, b, c, a".
std::string loop_text(const ImportedRobot& robot, const std::vector<int>& joint_of_link, int link) {
  // From any link below a loop, as many steps as there are links lead into the loop.
  for (std::size_t step = 0; step < robot.links.size(); ++step)
    link = robot.joints[static_cast<std::size_t>(joint_of_link[static_cast<std::size_t>(link)])].parent;
  std::string text = robot.links[static_cast<std::size_t>(link)].name;
  for (int at = link;;) {
    at = robot.joints[static_cast<std::size_t>(joint_of_link[static_cast<std::size_t>(at)])].parent;
    text += ", " + robot.links[static_cast<std::size_t>(at)].name;
    if (at == link) return text;
  }
}

std::vector<int> parent_joints(const ImportedRobot& robot) {
  std::vector<int> joints(robot.links.size(), -1);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    int& joint = joints[static_cast<std::size_t>(robot.joints[i].child)];
    if (joint >= 0)
      throw InputError(robot.file, robot.joints[i].line,
                       "a closed loop: " + robot.links[static_cast<std::size_t>(robot.joints[i].child)].name +
                           " moved by " + robot.joints[static_cast<std::size_t>(joint)].name + " and by " +
                           robot.joints[i].name,
                       "one joint for each link; remove the joint that closes the loop");
    joint = static_cast<int>(i);
  }
  return joints;
}

}  // namespace

std::optional<int> ImportedRobot::find_joint(const std::string& joint_name) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == joint_name) return static_cast<int>(i);
  return std::nullopt;
}

int root_link(const ImportedRobot& robot) {
  if (robot.links.empty()) throw InputError(robot.file, 0, "a robot without links", "one link or more");
  const std::vector<int> joint_of_link = parent_joints(robot);
  int root = -1;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (joint_of_link[i] >= 0) continue;
    if (root >= 0)
      throw InputError(robot.file, robot.links[i].line, "link " + robot.links[i].name + ", no joint's child",
                       "only " + robot.links[static_cast<std::size_t>(root)].name + " to be that");
    root = static_cast<int>(i);
  }
  if (root < 0)
    throw InputError(robot.file, robot.links[0].line,
                     "a closed loop of links: " + loop_text(robot, joint_of_link, 0), "a tree of joints");
  // A link from which the parents never end is below a loop beside the tree.
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    int above = static_cast<int>(i);
    for (std::size_t step = 0; step <= robot.links.size() && above != root; ++step)
      above = robot.joints[static_cast<std::size_t>(joint_of_link[static_cast<std::size_t>(above)])].parent;
    if (above != root)
      throw InputError(robot.file, robot.links[i].line,
                       "a closed loop of links: " + loop_text(robot, joint_of_link, static_cast<int>(i)),
                       "a tree of joints");
  }
  return root;
}

std::vector<std::size_t> joints_from_root(const ImportedRobot& robot) {
  std::vector<std::size_t> order;
  std::vector<int> reached{root_link(robot)};
  for (std::size_t next = 0; next < reached.size(); ++next) {
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      if (robot.joints[i].parent != reached[next]) continue;
      order.push_back(i);
      reached.push_back(robot.joints[i].child);
    }
  }
  return order;
}

std::vector<Eigen::Isometry3d> link_poses(const ImportedRobot& robot, std::span<const double> angles_rad) {
  std::vector<Eigen::Isometry3d> X_ML(robot.links.size(), Eigen::Isometry3d::Identity());
  for (const std::size_t i : joints_from_root(robot)) {
    const ImportedJoint& joint = robot.joints[i];
    Eigen::Isometry3d& pose = X_ML[static_cast<std::size_t>(joint.child)];
    pose = X_ML[static_cast<std::size_t>(joint.parent)] * joint.X_PL;
    if (!angles_rad.empty() && angles_rad[i] != 0.0)
      pose.rotate(Eigen::AngleAxisd(angles_rad[i], joint.axis_L));
  }
  return X_ML;
}

int joint_of(const ImportedRobot& robot, int link) {
  const auto found = std::ranges::find(robot.joints, link, &ImportedJoint::child);
  return found == robot.joints.end() ? -1 : static_cast<int>(found - robot.joints.begin());
}

Eigen::AlignedBox3d extent_of(std::span<const ImportedShape> shapes) {
  Eigen::AlignedBox3d extent;
  for (const ImportedShape& shape : shapes) {
    if (!shape.surface) continue;
    for (const Eigen::Vector3f& vertex : shape.surface->vertices_m)
      extent.extend(shape.X_LG * vertex.cast<double>());
  }
  return extent;
}

Eigen::AlignedBox3d extent_of(const ImportedLink& link) {
  const Eigen::AlignedBox3d extent = extent_of(std::span(link.collisions));
  return extent.isEmpty() ? extent_of(std::span(link.visuals)) : extent;
}

LinkBox box_of(const ImportedLink& link) {
  const std::span<const ImportedShape> shapes =
      extent_of(std::span(link.collisions)).isEmpty() ? link.visuals : link.collisions;
  LinkBox box;
  double largest_m = 0.0;
  for (const ImportedShape& shape : shapes) {
    if (!shape.surface) continue;
    Eigen::AlignedBox3d extent;
    for (const Eigen::Vector3f& vertex : shape.surface->vertices_m) extent.extend(vertex.cast<double>());
    // The first of two equally large ones, such as both halves of a servo's bracket.
    if (extent.isEmpty() || extent.diagonal().norm() <= largest_m) continue;
    largest_m = extent.diagonal().norm();
    box.R_LG = shape.X_LG.linear();
  }
  for (const ImportedShape& shape : shapes) {
    if (!shape.surface) continue;
    for (const Eigen::Vector3f& vertex : shape.surface->vertices_m)
      box.extent_G.extend(box.R_LG.transpose() * (shape.X_LG * vertex.cast<double>()));
  }
  return box;
}

Eigen::Matrix3d box_inertia(double mass_kg, const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d squares = size_m.cwiseProduct(size_m);
  const Eigen::Vector3d others = Eigen::Vector3d::Constant(squares.sum()) - squares;
  return (mass_kg / 12.0 * others).asDiagonal();
}

}  // namespace koboshi::tools
