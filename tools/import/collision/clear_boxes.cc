#include "tools/import/collision/clear_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "sim_board/engine/common/model_constants.h"
#include "tools/import/collision/bent_legs.h"
#include "tools/import/collision/boxes.h"
#include "tools/import/decide/role_joints.h"
#include "tools/import/normalise/repair_links.h"

namespace koboshi::tools {
namespace {

using Eigen::Vector3d;

constexpr double kTouching_m = 0.0004;  // the motion check and R007 count from 0.5 mm
constexpr double kStep_rad = 2.0 * kRadPerDegree;

constexpr int kAnyDistance = std::numeric_limits<int>::max();

// All boxes are along the same axes in the zero pose: the shortest way out of an overlap is along one of
// them.
void clear_zero_pose(Boxes& boxes, BoxCutter& cutter, ImportReport& report) {
  boxes.pose({});
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
  boxes.pose({});
  for (std::size_t a = 0; a < boxes.size(); ++a)
    for (std::size_t b = 0; b < boxes.size(); ++b)
      if (boxes.is_below(a, child) && boxes.is_below(static_cast<std::size_t>(child), static_cast<int>(b)) &&
          static_cast<int>(b) != child && boxes.may_touch(a, b) && boxes.distance(a, b) <= max_joints &&
          boxes.overlap_m(a, b) <= kTouching_m)
        pairs.emplace_back(a, b);
  const auto steps = static_cast<int>(std::ceil(std::abs(end_rad) / kStep_rad));
  for (int step = 1; step <= steps; ++step) {
    const double angle_rad = end_rad * step / steps;
    boxes.pose(std::array{Boxes::Turn{joint, angle_rad}});
    for (const auto& [a, b] : pairs)
      if (!boxes.are_far(a, b, 0.0) && boxes.overlap_m(a, b) > kTouching_m) return Contact{angle_rad, a, b};
  }
  return std::nullopt;
}

// The end of the usual range on the side of `end_rad`, in the signs of this joint. A joint that turns about
// another axis than its role does, such as an elbow that bends inwards, has its longer side where its own
// range is longer.
double usual_end_rad(const ImportedJoint& joint, double end_rad) {
  std::array<double, 2> range_rad = usual_range_rad(joint.name);
  const RoleJoint* const role = find_role(joint.name);
  int axis = 0;
  joint.axis_L.cwiseAbs().maxCoeff(&axis);
  if (role != nullptr && axis != role->axis - 'x') {
    // In the signs of the left side, so that both sides end alike.
    const bool is_right = joint.name.starts_with("right_");
    const double lower_rad = is_right ? -*joint.upper_rad : *joint.lower_rad;
    const double upper_rad = is_right ? -*joint.lower_rad : *joint.upper_rad;
    const bool is_longer_below = -lower_rad > upper_rad;
    if ((-range_rad[0] > range_rad[1]) != (is_longer_below != is_right))
      range_rad = {-range_rad[1], -range_rad[0]};
  }
  return std::abs(range_rad[end_rad > 0.0 ? 1 : 0]);
}

// Shrinks boxes until the joint turns through its usual range.
void shrink_for(Boxes& boxes, BoxCutter& cutter, std::size_t index, double end_rad, ImportReport& report) {
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

// Cuts the boxes of a leg at their lower ends until none reaches the ground on which the foot stands,
// whatever ankle pitch and roll within their usual ranges. A box around a shank is far wider at the ankle
// than the shank, and contacts between it and the foot, which neighbours do not make, would not stop it.
void lift_above_sole(Boxes& boxes, BoxCutter& cutter, std::size_t foot, const std::string& side,
                     ImportReport& report) {
  constexpr double kAir_m = 0.003;
  const ImportedRobot& robot = boxes.robot();
  const auto joint_named = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(robot.joints, name, &ImportedJoint::name) -
                                    robot.joints.begin());
  };
  const auto ends = [&](std::size_t joint) -> std::vector<double> {
    if (joint == robot.joints.size()) return {0.0};
    const std::array<double, 2> usual_rad = usual_range_rad(robot.joints[joint].name);
    return {std::max(usual_rad[0], *robot.joints[joint].lower_rad),
            std::min(usual_rad[1], *robot.joints[joint].upper_rad)};
  };
  const std::size_t pitch = joint_named(side + "_ankle_pitch");
  const std::size_t roll = joint_named(side + "_ankle_roll");
  for (std::size_t link = 0; link < boxes.size(); ++link) {
    if (link == foot || robot.links[link].collisions.empty() ||
        !boxes.is_below(foot, static_cast<int>(link)) ||
        boxes.distance(link, foot) >= sim_board::kMinJointsBetween)
      continue;
    for (const double pitch_rad : ends(pitch)) {
      for (const double roll_rad : ends(roll)) {
        boxes.pose(std::array{Boxes::Turn{pitch, pitch_rad}, Boxes::Turn{roll, roll_rad}});
        const double slice_m = 0.02 * boxes.box(link).size_m.z();
        bool cuts = true;
        while (cuts && boxes.height_above_sole_m(link, foot) < kAir_m)
          cuts = cutter.cut(link, 2, false, slice_m);
        if (cuts) continue;
        report.warnings.push_back(
            fmt::format("{} reaches below the sole with the ankle at {:.0f} and {:.0f} deg",
                        robot.links[link].name, kDegreesPerRad * pitch_rad, kDegreesPerRad * roll_rad));
      }
    }
  }
}

// Cuts the box of a thigh at its upper end, then that of the trunk at its lower one, until they do not meet
// with the hip bent and spread at the same time. Each joint alone may be free, and a step bends and spreads
// both.
void clear_hip(Boxes& boxes, BoxCutter& cutter, std::size_t thigh, const std::string& side) {
  constexpr std::array<double, 3> kBent_deg{-90.0, -60.0, -30.0};
  constexpr double kSpread_deg = 15.0;
  const ImportedRobot& robot = boxes.robot();
  const auto pitch = std::ranges::find(robot.joints, side + "_hip_pitch", &ImportedJoint::name);
  const auto roll = std::ranges::find(robot.joints, side + "_hip_roll", &ImportedJoint::name);
  if (pitch == robot.joints.end() || roll == robot.joints.end()) return;
  constexpr std::size_t kTrunk = 0;
  if (robot.links[kTrunk].collisions.empty() || !boxes.may_touch(kTrunk, thigh)) return;
  for (const double bent_deg : kBent_deg) {
    for (const double spread_deg : {-kSpread_deg, kSpread_deg}) {
      boxes.pose(std::array{
          Boxes::Turn{static_cast<std::size_t>(pitch - robot.joints.begin()), kRadPerDegree * bent_deg},
          Boxes::Turn{static_cast<std::size_t>(roll - robot.joints.begin()), kRadPerDegree * spread_deg}});
      while (boxes.overlap_m(kTrunk, thigh) > kTouching_m) {
        const double slice_m = 0.02 * boxes.box(thigh).size_m.z();
        if (!cutter.cut(thigh, 2, true, slice_m) && !cutter.cut(kTrunk, 2, false, slice_m)) return;
      }
    }
  }
}

}  // namespace

void clear_boxes(ImportedRobot& robot, Interview& interview, ImportReport& report) {
  Boxes boxes(robot);
  BoxCutter cutter(boxes);
  clear_zero_pose(boxes, cutter, report);
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    for (const double end_rad : {*robot.joints[i].lower_rad, *robot.joints[i].upper_rad})
      shrink_for(boxes, cutter, i, end_rad, report);
  for (const char* side : {"left", "right"}) {
    const auto foot = std::ranges::find(robot.links, side + std::string("_foot"), &ImportedLink::name);
    if (foot != robot.links.end() && !foot->collisions.empty())
      lift_above_sole(boxes, cutter, static_cast<std::size_t>(foot - robot.links.begin()), side, report);
    const auto thigh = std::ranges::find(robot.links, side + std::string("_thigh"), &ImportedLink::name);
    if (thigh != robot.links.end() && !thigh->collisions.empty())
      clear_hip(boxes, cutter, static_cast<std::size_t>(thigh - robot.links.begin()), side);
  }
  clear_bent_legs(boxes, cutter, report);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    if (interview.given().limits_deg.contains(robot.joints[i].name)) continue;
    if (*robot.joints[i].lower_rad < 0.0) end_range(boxes, i, false, interview, report);
    if (*robot.joints[i].upper_rad > 0.0) end_range(boxes, i, true, interview, report);
  }
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.links[i].collisions.empty()) continue;
    if (const double share = cutter.smallest_share(i); share < 1.0)
      report.normalised.push_back(
          fmt::format("{}: box shrunk to {:.0f} % of a side, so that it touches no other, nor the ground",
                      robot.links[i].name, 100.0 * share));
  }
}

}  // namespace koboshi::tools
