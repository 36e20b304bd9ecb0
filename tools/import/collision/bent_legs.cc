#include "tools/import/collision/bent_legs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/text/user_units.h"
#include "tools/import/decide/role_joints.h"

namespace koboshi::tools {
namespace {

// Boxes this far apart stay so when servos sag by a degree or two at the length of a forearm. By hand.
constexpr double kApart_m = 0.003;
constexpr double kSlice = 0.01;  // of a side; the resolution of a cut

// A pose of the arms, in the signs of the left side.
struct ArmPose {
  const char* name;
  double shoulder_roll_deg;
  double elbow_deg;
};
// Straight down, as the scenarios hang the robot up; the arms of the motion `stand` of robots/koboshi; those
// of the motion `stand` that bring-up writes.
constexpr std::array<ArmPose, 3> kArmPoses{
    {{"zero", 0.0, 0.0}, {"stand", 8.0, -20.0}, {"spread", 15.0, 0.0}}};
// The squats of bring-up and of the motions end at 85 % of the CoM's height, with knees up to 90 degrees.
constexpr double kMaxKnee_deg = 90.0;
constexpr double kKneeStep_deg = 10.0;
constexpr std::array<double, 2> kLegsSpread_deg{0.0, 5.0};  // by the roll of hips, as in the motion `stand`
constexpr std::array<double, 2> kLean_deg{0.0, 20.0};       // of the trunk, forward

struct BentPose {
  std::vector<Boxes::Turn> turns{};
  std::string text{};  // for a warning
};

std::string limb_of(const ImportedRobot& robot, std::size_t link) {
  for (int at = static_cast<int>(link); at >= 0;) {
    const int joint = joint_of(robot, at);
    if (joint < 0) break;
    const std::string& name = robot.joints[static_cast<std::size_t>(joint)].name;
    for (const char* side : {"left_", "right_"}) {
      if (!name.starts_with(side) || find_role(name) == nullptr) continue;
      const bool is_arm = std::ranges::any_of(kArmRoles, [&](const RoleJoint& role) {
        return name == std::string(side) + std::string(role.name);
      });
      return std::string(side) + (is_arm ? "arm" : "leg");
    }
    at = robot.joints[static_cast<std::size_t>(joint)].parent;
  }
  return "body";
}

class PoseMaker {
 public:
  explicit PoseMaker(const ImportedRobot& robot) : robot_(robot), X_BL_(link_poses(robot)) {}

  std::vector<BentPose> poses() const {
    std::vector<BentPose> all;
    const std::optional<double> thigh_m = length_between("hip_pitch", "knee");
    const std::optional<double> shank_m = length_between("knee", "ankle_pitch");
    if (!thigh_m || !shank_m) return all;
    for (const ArmPose& arms : kArmPoses)
      for (const double spread_deg : kLegsSpread_deg)
        for (const double lean_deg : kLean_deg)
          for (double knee_deg = 0.0; knee_deg <= kMaxKnee_deg; knee_deg += kKneeStep_deg) {
            const double knee_rad = kRadPerDegree * knee_deg;
            // The ankle stays below the hip, and the sole level.
            const double hip_rad =
                -std::atan2(*shank_m * std::sin(knee_rad), *thigh_m + *shank_m * std::cos(knee_rad));
            BentPose pose;
            turn(pose, "hip_roll", kRadPerDegree * spread_deg);
            turn(pose, "hip_pitch", hip_rad - kRadPerDegree * lean_deg);
            turn(pose, "knee", knee_rad);
            turn(pose, "ankle_pitch", -(hip_rad + knee_rad));
            turn(pose, "ankle_roll", -kRadPerDegree * spread_deg);
            turn(pose, "shoulder_roll", kRadPerDegree * arms.shoulder_roll_deg);
            turn(pose, "elbow", kRadPerDegree * arms.elbow_deg);
            pose.text = fmt::format("knees at {:.0f} deg and arms as in {}", knee_deg, arms.name);
            all.push_back(std::move(pose));
          }
    return all;
  }

 private:
  // Between two joints of the left leg; nothing without them, or if it hardly moves.
  std::optional<double> length_between(const char* upper, const char* lower) const {
    const auto one = robot_.find_joint(std::string("left_") + upper);
    const auto other = robot_.find_joint(std::string("left_") + lower);
    if (!one || !other) return std::nullopt;
    const auto anchor = [this](int joint) {
      return X_BL_[static_cast<std::size_t>(robot_.joints[static_cast<std::size_t>(joint)].child)]
          .translation();
    };
    const double length_m = (anchor(*other) - anchor(*one)).norm();
    return length_m > 0.005 ? std::optional(length_m) : std::nullopt;
  }

  // Turns the joints of both sides, as far as they go.
  void turn(BentPose& pose, const char* role, double angle_rad) const {
    const RoleJoint* const found = find_role(std::string("left_") + role);
    const bool is_mirrored = found != nullptr && found->axis != 'y';
    for (const auto& [side, sign] :
         {std::pair{"left_", 1.0}, std::pair{"right_", is_mirrored ? -1.0 : 1.0}}) {
      const auto joint = robot_.find_joint(std::string(side) + role);
      if (!joint) continue;
      const ImportedJoint& hinge = robot_.joints[static_cast<std::size_t>(*joint)];
      pose.turns.push_back(
          {static_cast<std::size_t>(*joint),
           std::clamp(sign * angle_rad, std::min(0.0, *hinge.lower_rad), std::max(0.0, *hinge.upper_rad))});
    }
  }

  const ImportedRobot& robot_;
  std::vector<Eigen::Isometry3d> X_BL_;  // at joint zero
};

// A slice of a box.
struct Cut {
  std::size_t link = 0;
  int axis = 0;
  bool at_max = false;
  double depth_m = 0.0;
};

// Finds cuts for a pair of boxes in the present pose.
class PairCuts {
 public:
  PairCuts(Boxes& boxes, const BoxCutter& cutter, std::size_t one, std::size_t other)
      : boxes_(boxes), cutter_(cutter), one_(one), other_(other) {}

  // Returns the cut that parts the boxes and takes the smallest share of a side; nothing if no single cut
  // does.
  std::optional<Cut> best() const {
    std::optional<Cut> best;
    double least = std::numeric_limits<double>::infinity();
    for_each_end([&](Cut cut) {
      const double slice_m = kSlice * cutter_.original_m(cut.link, cut.axis);
      for (cut.depth_m = slice_m; cut.depth_m <= cutter_.spare_m(cut.link, cut.axis);
           cut.depth_m += slice_m) {
        const double share = cut.depth_m / cutter_.original_m(cut.link, cut.axis);
        if (share >= least) return;
        if (gap_after_m(cut) < kApart_m) continue;
        least = share;
        best = cut;
        return;
      }
    });
    return best;
  }
  // Returns the slice that brings most.
  std::optional<Cut> best_slice() const {
    std::optional<Cut> best;
    double most_m = gap_m() + 1e-6;
    for_each_end([&](Cut cut) {
      cut.depth_m = kSlice * cutter_.original_m(cut.link, cut.axis);
      if (cut.depth_m > cutter_.spare_m(cut.link, cut.axis)) return;
      if (const double gap_m = gap_after_m(cut); gap_m > most_m) {
        most_m = gap_m;
        best = cut;
      }
    });
    return best;
  }
  double gap_m() const { return boxes_.separation(one_, other_).gap_m; }

 private:
  template <typename Visit>
  void for_each_end(const Visit& visit) const {
    for (const std::size_t link : {one_, other_})
      for (int axis = 0; axis < 3; ++axis)
        for (const bool at_max : {false, true}) visit(Cut{link, axis, at_max, 0.0});
  }
  double gap_after_m(const Cut& cut) const {
    ImportedShape& box = boxes_.box(cut.link);
    const double size_m = box.size_m[cut.axis];
    const double centre_m = box.X_LG.translation()[cut.axis];
    cut_slice(box, cut.axis, cut.at_max, cut.depth_m);
    const double gap = gap_m();
    box.size_m[cut.axis] = size_m;
    box.X_LG.translation()[cut.axis] = centre_m;
    return gap;
  }

  Boxes& boxes_;
  const BoxCutter& cutter_;
  std::size_t one_;
  std::size_t other_;
};

// Returns whether the boxes are apart afterwards.
bool part(Boxes& boxes, BoxCutter& cutter, std::size_t one, std::size_t other) {
  const PairCuts cuts(boxes, cutter, one, other);
  while (cuts.gap_m() < kApart_m) {
    std::optional<Cut> cut = cuts.best();
    if (!cut) cut = cuts.best_slice();
    if (!cut || !cutter.cut(cut->link, cut->axis, cut->at_max, cut->depth_m)) return false;
  }
  return true;
}

}  // namespace

void clear_bent_legs(Boxes& boxes, BoxCutter& cutter, ImportReport& report) {
  const ImportedRobot& robot = boxes.robot();
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < boxes.size(); ++a)
    for (std::size_t b = a + 1; b < boxes.size(); ++b)
      if (boxes.may_touch(a, b) && limb_of(robot, a) != limb_of(robot, b)) pairs.emplace_back(a, b);
  for (const BentPose& pose : PoseMaker(robot).poses()) {
    boxes.pose(pose.turns);
    std::erase_if(pairs, [&](const auto& pair) {
      const auto& [a, b] = pair;
      if (boxes.are_far(a, b, kApart_m)) return false;
      if (part(boxes, cutter, a, b)) return false;
      report.warnings.push_back(fmt::format(
          "{} and {} are {:.1f} mm apart, expected {:.0f} mm, with {}", robot.links[a].name,
          robot.links[b].name, kMmPerM * boxes.separation(a, b).gap_m, kMmPerM * kApart_m, pose.text));
      return true;
    });
  }
}

}  // namespace koboshi::tools
