#include "tools/import/collision/boxes.h"

#include <algorithm>
#include <limits>
#include <string>

#include "sim_board/engine/common/model_constants.h"
#include "tools/import/decide/role_joints.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

constexpr double kShrink = 0.95;   // a step of shrinking
constexpr double kMinShare = 0.6;  // of a side; a box that is smaller is no image of its link

// A box this near to the mid-plane stays there: the trunk's, whichever side of it is cut.
constexpr double kCentred_m = 1e-6;

bool is_foot(const ImportedLink& link) { return link.name == "left_foot" || link.name == "right_foot"; }

std::optional<std::size_t> mirror_of(const ImportedRobot& robot, std::size_t link) {
  const std::string other = mirrored_name(robot.links[link].name);
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (i != link && robot.links[i].name == other && !robot.links[i].collisions.empty()) return i;
  return std::nullopt;
}

}  // namespace

Boxes::Boxes(ImportedRobot& robot) : robot_(robot), order_(joints_from_root(robot)) {
  const std::size_t count = robot.links.size();
  depth_.assign(count, 0);
  parent_.assign(count, -1);
  X_ML_.assign(count, Eigen::Isometry3d::Identity());
  for (const std::size_t i : order_) {
    const ImportedJoint& joint = robot.joints[i];
    parent_[static_cast<std::size_t>(joint.child)] = joint.parent;
    depth_[static_cast<std::size_t>(joint.child)] = depth_[static_cast<std::size_t>(joint.parent)] + 1;
  }
}

void Boxes::pose(std::span<const Turn> turns) {
  for (const std::size_t i : order_) {
    const ImportedJoint& joint = robot_.joints[i];
    Eigen::Isometry3d& X = X_ML_[static_cast<std::size_t>(joint.child)];
    X = X_ML_[static_cast<std::size_t>(joint.parent)] * joint.X_PL;
    for (const Turn& turn : turns)
      if (i == turn.joint) X.rotate(Eigen::AngleAxisd(turn.angle_rad, joint.axis_L));
  }
}

bool Boxes::may_touch(std::size_t a, std::size_t b) const {
  return has_box(a) && has_box(b) && distance(a, b) >= sim_board::kMinJointsBetween;
}

bool Boxes::is_below(std::size_t link, int above) const {
  for (int at = static_cast<int>(link); at >= 0; at = parent_[static_cast<std::size_t>(at)])
    if (at == above) return true;
  return false;
}

int Boxes::distance(std::size_t a, std::size_t b) const {
  int steps = 0;
  auto one = static_cast<int>(a);
  auto other = static_cast<int>(b);
  while (one != other) {
    int& deeper =
        depth_[static_cast<std::size_t>(one)] >= depth_[static_cast<std::size_t>(other)] ? one : other;
    deeper = parent_[static_cast<std::size_t>(deeper)];
    ++steps;
  }
  return steps;
}

double Boxes::overlap_m(std::size_t a, std::size_t b) const {
  const ImportedShape& one = box(a);
  const ImportedShape& other = box(b);
  return sim_board::box_overlap_m(X_ML_[a] * one.X_LG, 0.5 * one.size_m, X_ML_[b] * other.X_LG,
                                  0.5 * other.size_m);
}

sim_board::BoxSeparation Boxes::separation(std::size_t a, std::size_t b) const {
  const ImportedShape& one = box(a);
  const ImportedShape& other = box(b);
  return sim_board::box_separation(X_ML_[a] * one.X_LG, 0.5 * one.size_m, X_ML_[b] * other.X_LG,
                                   0.5 * other.size_m);
}

bool Boxes::are_far(std::size_t a, std::size_t b, double gap_m) const {
  const double reach_m = 0.5 * (box(a).size_m.norm() + box(b).size_m.norm()) + gap_m;
  const Vector3d p_BA_M = X_ML_[a] * box(a).X_LG.translation() - X_ML_[b] * box(b).X_LG.translation();
  return p_BA_M.squaredNorm() > reach_m * reach_m;
}

double Boxes::height_above_sole_m(std::size_t link, std::size_t foot) const {
  const Eigen::Isometry3d X_FootLink = X_ML_[foot].inverse() * X_ML_[link];
  const ImportedShape& shape = box(link);
  double lowest_m = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d sign(corner % 2 == 0 ? -0.5 : 0.5, corner / 2 % 2 == 0 ? -0.5 : 0.5,
                        corner / 4 == 0 ? -0.5 : 0.5);
    lowest_m = std::min(lowest_m, (X_FootLink * shape.X_LG * sign.cwiseProduct(shape.size_m)).z());
  }
  return lowest_m - (box(foot).X_LG.translation().z() - 0.5 * box(foot).size_m.z());
}

Eigen::AlignedBox3d Boxes::bounds(std::size_t link) const {
  const Vector3d centre = X_ML_[link] * box(link).X_LG.translation();
  return {centre - 0.5 * box(link).size_m, centre + 0.5 * box(link).size_m};
}

void cut_slice(ImportedShape& box, int axis, bool at_max, double depth_m) {
  box.size_m[axis] -= depth_m;
  box.X_LG.translation()[axis] += (at_max ? -0.5 : 0.5) * depth_m;
}

BoxCutter::BoxCutter(Boxes& boxes) : boxes_(boxes), robot_(boxes.robot()) {
  for (const ImportedLink& link : robot_.links)
    original_m_.push_back(link.collisions.empty() ? Vector3d::Zero() : link.collisions.front().size_m);
}

double BoxCutter::spare_m(std::size_t link, int axis) const {
  if (is_foot(robot_.links[link])) return 0.0;
  return std::max(0.0, boxes_.box(link).size_m[axis] - kMinShare * original_m_[link][axis]);
}

bool BoxCutter::cut(std::size_t link, int axis, bool at_max, double depth_m) {
  if (is_foot(robot_.links[link])) return false;
  const bool both_ends = axis == 1 && is_own_image(link);
  const double lost_m = both_ends ? 2.0 * depth_m : depth_m;
  if (boxes_.box(link).size_m[axis] - lost_m < kMinShare * original_m_[link][axis]) return false;
  cut_slice(boxes_.box(link), axis, at_max, depth_m);
  if (both_ends) cut_slice(boxes_.box(link), axis, !at_max, depth_m);
  if (const auto other = mirror_of(robot_, link))
    cut_slice(boxes_.box(*other), axis, axis == 1 ? !at_max : at_max, depth_m);
  return true;
}

bool BoxCutter::shrink(std::size_t link) {
  bool possible = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double depth_m = 0.5 * (1.0 - kShrink) * boxes_.box(link).size_m[axis];
    const bool cuts_both = axis == 1 && is_own_image(link);
    possible = cut(link, axis, true, depth_m) && (cuts_both || cut(link, axis, false, depth_m));
  }
  return possible;
}

double BoxCutter::smallest_share(std::size_t link) const {
  return boxes_.box(link).size_m.cwiseQuotient(original_m_[link]).minCoeff();
}

bool BoxCutter::is_own_image(std::size_t link) const {
  return !mirror_of(robot_, link) && std::abs(boxes_.box(link).X_LG.translation().y()) < kCentred_m;
}

}  // namespace koboshi::tools
