#include "tools/import/collision/clear_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "sim_board/engine/common/model_constants.h"
#include "sim_board/world/box_overlap.h"
#include "tools/import/decide/role_joints.h"
#include "tools/import/normalise/repair_links.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

constexpr double kTouching_m = 0.0004;  // the motion check and R007 count from 0.5 mm
constexpr double kStep_rad = 2.0 * kRadPerDegree;
constexpr double kShrink = 0.95;   // a step of shrinking
constexpr double kMinShare = 0.6;  // of a side; a box that is smaller is no image of its link

class Boxes {
 public:
  explicit Boxes(ImportedRobot& robot) : robot_(robot), order_(joints_from_root(robot)) {
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

  void pose(std::size_t turned, double angle_rad) {
    for (const std::size_t i : order_) {
      const ImportedJoint& joint = robot_.joints[i];
      Eigen::Isometry3d& X = X_ML_[static_cast<std::size_t>(joint.child)];
      X = X_ML_[static_cast<std::size_t>(joint.parent)] * joint.X_PL;
      if (i == turned) X.rotate(Eigen::AngleAxisd(angle_rad, joint.axis_L));
    }
  }

  bool may_touch(std::size_t a, std::size_t b) const {
    return !robot_.links[a].collisions.empty() && !robot_.links[b].collisions.empty() &&
           distance(a, b) >= sim_board::kMinJointsBetween;
  }
  bool is_below(std::size_t link, int above) const {
    for (int at = static_cast<int>(link); at >= 0; at = parent_[static_cast<std::size_t>(at)])
      if (at == above) return true;
    return false;
  }
  double overlap_m(std::size_t a, std::size_t b) const {
    const ImportedShape& one = box(a);
    const ImportedShape& other = box(b);
    return sim_board::box_overlap_m(X_ML_[a] * one.X_LG, 0.5 * one.size_m, X_ML_[b] * other.X_LG,
                                    0.5 * other.size_m);
  }
  // Joints between two links.
  int distance(std::size_t a, std::size_t b) const {
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
  ImportedShape& box(std::size_t link) const { return robot_.links[link].collisions.front(); }
  std::size_t size() const { return robot_.links.size(); }
  ImportedRobot& robot() const { return robot_; }
  // Bounds along the model's axes in the zero pose.
  Eigen::AlignedBox3d bounds(std::size_t link) const {
    const Vector3d centre = X_ML_[link] * box(link).X_LG.translation();
    return {centre - 0.5 * box(link).size_m, centre + 0.5 * box(link).size_m};
  }

 private:
  ImportedRobot& robot_;
  std::vector<std::size_t> order_;
  std::vector<int> parent_;  // by link
  std::vector<int> depth_;
  std::vector<Eigen::Isometry3d> X_ML_;
};

bool is_foot(const ImportedLink& link) { return link.name == "left_foot" || link.name == "right_foot"; }

std::optional<std::size_t> mirror_of(const ImportedRobot& robot, std::size_t link) {
  const std::string other = mirrored_name(robot.links[link].name);
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (i != link && robot.links[i].name == other && !robot.links[i].collisions.empty()) return i;
  return std::nullopt;
}

// Cuts a slice off a box at one end of an axis, and off its mirror image.
class Cutter {
 public:
  explicit Cutter(Boxes& boxes) : boxes_(boxes), robot_(boxes.robot()) {
    for (const ImportedLink& link : robot_.links)
      original_m_.push_back(link.collisions.empty() ? Vector3d::Zero() : link.collisions.front().size_m);
  }

  // Returns false if the box would become too small. `at_max`: the end of the larger coordinate.
  bool cut(std::size_t link, int axis, bool at_max, double depth_m) {
    if (is_foot(robot_.links[link])) return false;
    if (boxes_.box(link).size_m[axis] - depth_m < kMinShare * original_m_[link][axis]) return false;
    apply(link, axis, at_max, depth_m);
    if (const auto other = mirror_of(robot_, link))
      apply(*other, axis, axis == 1 ? !at_max : at_max, depth_m);
    return true;
  }
  // Shrinks a box about its centre.
  bool shrink(std::size_t link) {
    bool possible = false;
    for (int axis = 0; axis < 3; ++axis) {
      const double depth_m = 0.5 * (1.0 - kShrink) * boxes_.box(link).size_m[axis];
      possible = cut(link, axis, true, depth_m) && cut(link, axis, false, depth_m);
    }
    return possible;
  }
  double smallest_share(std::size_t link) const {
    return boxes_.box(link).size_m.cwiseQuotient(original_m_[link]).minCoeff();
  }

 private:
  void apply(std::size_t link, int axis, bool at_max, double depth_m) {
    ImportedShape& box = boxes_.box(link);
    box.size_m[axis] -= depth_m;
    box.X_LG.translation()[axis] += (at_max ? -0.5 : 0.5) * depth_m;
  }

  Boxes& boxes_;
  ImportedRobot& robot_;
  std::vector<Vector3d> original_m_;
};

constexpr int kAnyDistance = std::numeric_limits<int>::max();
constexpr std::size_t kNoJoint = static_cast<std::size_t>(-1);

// All boxes are along the same axes in the zero pose: the shortest way out of an overlap is along one of
// them.
void clear_zero_pose(Boxes& boxes, Cutter& cutter, ImportReport& report) {
  boxes.pose(kNoJoint, 0.0);
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    for (std::size_t b = a + 1; b < boxes.size(); ++b) {
      if (!boxes.may_touch(a, b) || boxes.overlap_m(a, b) <= kTouching_m) continue;
      const Eigen::AlignedBox3d one = boxes.bounds(a);
      const Eigen::AlignedBox3d other = boxes.bounds(b);
      int axis = 0;
      one.intersection(other).sizes().minCoeff(&axis);
      const bool one_is_above = one.center()[axis] > other.center()[axis];
      const double depth_m =
          (one_is_above ? other.max()[axis] - one.min()[axis] : one.max()[axis] - other.min()[axis]) + 2e-4;
      const bool both = cutter.cut(a, axis, !one_is_above, 0.5 * depth_m) &&
                        cutter.cut(b, axis, one_is_above, 0.5 * depth_m);
      const double rest_m = boxes.overlap_m(a, b) + 2e-4;
      const bool cleared =
          both || cutter.cut(a, axis, !one_is_above, rest_m) || cutter.cut(b, axis, one_is_above, rest_m);
      if (!cleared && boxes.overlap_m(a, b) > kTouching_m)
        report.warnings.push_back(fmt::format("{} and {} overlap by {:.1f} mm in the zero pose",
                                              boxes.robot().links[a].name, boxes.robot().links[b].name,
                                              kMmPerM * boxes.overlap_m(a, b)));
    }
  }
}

struct Contact {
  double angle_rad = 0.0;
  std::size_t one = 0;
  std::size_t other = 0;
};

// Turns a joint from zero to an end of its range. Returns the first contact, which the zero pose does not
// have, of a link that moves with one that carries the joint. Contacts of two limbs depend on where the other
// one is.
// Only pairs of links with at most `max_joints` between them count.
std::optional<Contact> first_contact(Boxes& boxes, std::size_t joint, double end_rad, int max_joints) {
  const int child = boxes.robot().joints[joint].child;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  boxes.pose(kNoJoint, 0.0);
  for (std::size_t a = 0; a < boxes.size(); ++a)
    for (std::size_t b = 0; b < boxes.size(); ++b)
      if (boxes.is_below(a, child) && boxes.is_below(static_cast<std::size_t>(child), static_cast<int>(b)) &&
          static_cast<int>(b) != child && boxes.may_touch(a, b) && boxes.distance(a, b) <= max_joints &&
          boxes.overlap_m(a, b) <= kTouching_m)
        pairs.emplace_back(a, b);
  const auto steps = static_cast<int>(std::ceil(std::abs(end_rad) / kStep_rad));
  for (int step = 1; step <= steps; ++step) {
    const double angle_rad = end_rad * step / steps;
    boxes.pose(joint, angle_rad);
    for (const auto& [a, b] : pairs)
      if (boxes.overlap_m(a, b) > kTouching_m) return Contact{angle_rad, a, b};
  }
  return std::nullopt;
}

// The end of the usual range on the side of `end_rad`, in the signs of this joint.
double usual_end_rad(const ImportedJoint& joint, double end_rad) {
  const std::array<double, 2> range_rad = usual_range_rad(joint.name);
  return std::abs(range_rad[end_rad > 0.0 ? 1 : 0]);
}

// Shrinks boxes until the joint turns through its usual range.
void shrink_for(Boxes& boxes, Cutter& cutter, std::size_t index, double end_rad, ImportReport& report) {
  const ImportedJoint& joint = boxes.robot().joints[index];
  const double usual_rad = usual_end_rad(joint, end_rad);
  const double reach_rad = std::copysign(std::min(std::abs(end_rad), usual_rad), end_rad);
  if (reach_rad == 0.0) return;
  while (const std::optional<Contact> contact = first_contact(boxes, index, reach_rad, kAnyDistance)) {
    const bool one_first = cutter.smallest_share(contact->one) >= cutter.smallest_share(contact->other);
    const std::size_t first = one_first ? contact->one : contact->other;
    const std::size_t second = one_first ? contact->other : contact->one;
    if (cutter.shrink(first) || cutter.shrink(second)) continue;
    report.warnings.push_back(
        fmt::format("{}: {} and {} touch at {:.0f} deg", joint.name, boxes.robot().links[contact->one].name,
                    boxes.robot().links[contact->other].name, kDegreesPerRad * contact->angle_rad));
    return;
  }
}

// Ends the range of a joint where boxes meet. Whether links further apart meet depends on the other joints
// between them more than on this one.
void end_range(Boxes& boxes, std::size_t index, bool upper, Interview& interview, ImportReport& report) {
  ImportedJoint& joint = boxes.robot().joints[index];
  double& end_rad = upper ? *joint.upper_rad : *joint.lower_rad;
  const std::optional<Contact> contact = first_contact(boxes, index, end_rad, sim_board::kMinJointsBetween);
  if (!contact || std::abs(contact->angle_rad) <= usual_end_rad(joint, end_rad)) return;
  const double taken_rad = contact->angle_rad - std::copysign(kStep_rad, contact->angle_rad);
  if (take_repair({.key = joint.name + (upper ? ".upper" : ".lower"),
                   .found = fmt::format("{} to {:.1f} deg", joint.name, kDegreesPerRad * end_rad),
                   .taken = fmt::format("{:.1f} deg", kDegreesPerRad * taken_rad),
                   .because = boxes.robot().links[contact->one].name + " and " +
                              boxes.robot().links[contact->other].name + " meet there"},
                  interview, report))
    end_rad = taken_rad;
}

}  // namespace

void clear_boxes(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  Boxes boxes(robot);
  Cutter cutter(boxes);
  clear_zero_pose(boxes, cutter, report);
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    for (const double end_rad : {*robot.joints[i].lower_rad, *robot.joints[i].upper_rad})
      shrink_for(boxes, cutter, i, end_rad, report);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    if (interview.given().limits_deg.contains(robot.joints[i].name)) continue;
    if (*robot.joints[i].lower_rad < 0.0) end_range(boxes, i, false, interview, report);
    if (*robot.joints[i].upper_rad > 0.0) end_range(boxes, i, true, interview, report);
  }
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.links[i].collisions.empty()) continue;
    if (const double share = cutter.smallest_share(i); share < 1.0)
      report.normalised.push_back(
          fmt::format("{}: box shrunk to {:.0f} % of a side, so that it touches no other",
                      robot.links[i].name, 100.0 * share));
  }
}

}  // namespace koboshi::tools
