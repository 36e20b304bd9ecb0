#include "simulation/model/leg_faults.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/text/user_units.h"
#include "firmware/robot/leg.h"

namespace koboshi::simulation {
namespace {

using Eigen::Vector3d;
using robot::kLegJoints;
using sim_board::JointDescription;
using sim_board::RobotDescription;

// By robot::LegJoint.
constexpr std::array<const char*, kLegJoints> kNames{"hip_yaw", "hip_roll",    "hip_pitch",
                                                     "knee",    "ankle_pitch", "ankle_roll"};
constexpr std::array<int, kLegJoints> kAxes{2, 0, 1, 1, 1, 0};
constexpr std::array<char, 3> kAxisNames{'x', 'y', 'z'};
constexpr double kMaxOff_deg = 60.0;  // as kMinAlignment in firmware/robot/leg_geometry.cc

class LegFaults {
 public:
  LegFaults(const RobotDescription& robot, const robot::RobotModel& model, hal::Side side,
            std::vector<InputError>& errors)
      : robot_(robot),
        model_(model),
        side_(side),
        prefix_(side == hal::Side::kLeft ? "left_" : "right_"),
        errors_(errors) {}

  void find() {
    if (!find_joints()) return;  // such a leg can stand, but not walk
    const std::size_t errors_before = errors_.size();
    check_order();
    for (const std::size_t i : joints_) check_axis(i);
    for (const std::size_t i : joints_)
      if (i != robot::kHipYaw && model_.is_follower(robot::JointIndex(indices_[i])))
        add(i, name(i) + " with <mimic>",
            "a drive, or hip_yaw: one motor may turn both hip yaws, no other joints of the legs");
    robot::LegGeometry leg;
    if (errors_.size() == errors_before && !robot::make_leg_geometry(model_, side_, leg)) {
      add(robot::kKnee, "a " + prefix_ + "leg whose joints cannot move the sole in all directions",
          "axes that do not coincide, at bent knees, and a thigh and a shank");
    }
  }

 private:
  std::string role(std::size_t i) const { return prefix_ + kNames[i]; }
  // With the role, if that is not the name.
  std::string name(std::size_t i) const {
    const std::string& name = joint(i).name;
    return name == role(i) ? name : name + " (" + role(i) + ")";
  }
  const JointDescription& joint(std::size_t i) const { return robot_.hinge(indices_[i]); }
  void add(std::size_t i, const std::string& found, const std::string& expected) {
    errors_.emplace_back(robot_.file, joint(i).line, found, expected);
  }

  bool find_joints() {
    bool complete = true;
    for (std::size_t i = 0; i < kLegJoints; ++i) {
      if (const auto index = model_.find_hinge(robot::leg_role(side_, i))) {
        indices_[i] = *index;
        joints_.push_back(i);
        continue;
      }
      if (i != robot::kHipYaw) complete = false;
    }
    return complete;
  }

  // The hip joints, the knee and the two ankle joints follow each other, in any order within hip and ankle.
  void check_order() {
    const std::size_t knee_place = joints_.size() - 3;
    robot::LinkIndex parent;
    std::string above = robot_.links.front().name;
    for (std::size_t place = 0; place < joints_.size(); ++place) {
      const char* const kind = place < knee_place    ? "a hip joint"
                               : place == knee_place ? "the knee"
                                                     : "an ankle joint";
      const auto next = std::ranges::find_if(
          joints_, [&](std::size_t i) { return model_.joints[indices_[i]].parent == parent; });
      const bool fits = next != joints_.end() && (place < knee_place    ? *next < robot::kKnee
                                                  : place == knee_place ? *next == robot::kKnee
                                                                        : *next > robot::kKnee);
      if (!fits) {
        const std::size_t i = next == joints_.end() ? misplaced(parent) : *next;
        add(i, name(i) + " on the link " + robot_.links.at(static_cast<std::size_t>(joint(i).parent)).name,
            std::string(kind) + " of that leg on " + above +
                ": from the base down the hip joints, the knee and the ankle joints, each on the link of the "
                "one before");
        return;
      }
      parent = robot::LinkIndex(robot::JointIndex(indices_[*next]));
      above = robot_.links.at(static_cast<std::size_t>(joint(*next).child)).name;
    }
  }

  // Returns the first joint that hangs on a link outside of the leg.
  std::size_t misplaced(robot::LinkIndex end) const {
    for (const std::size_t i : joints_) {
      const robot::LinkIndex parent = model_.joints[indices_[i]].parent;
      const bool in_leg = parent.is_trunk() || std::ranges::any_of(joints_, [&](std::size_t other) {
                            return parent == robot::LinkIndex(robot::JointIndex(indices_[other]));
                          });
      if (!in_leg) return i;
    }
    return end.is_trunk() ? joints_.front() : joints_.back();
  }

  // The hip yaw may have any axis. The others are within 60 degrees of the axis of their role.
  void check_axis(std::size_t i) {
    if (i == robot::kHipYaw) return;
    const Vector3d axis_B = robot_.links.front().X_ML.linear().transpose() * joint(i).axis_M;
    const int number = kAxes[i];
    const double across = std::hypot(axis_B[(number + 1) % 3], axis_B[(number + 2) % 3]);
    const double off_deg = kDegreesPerRad * std::atan2(across, std::abs(axis_B[number]));
    if (off_deg <= kMaxOff_deg) return;
    add(i,
        fmt::format("the axis of {}, {:.2g} degrees from the base's {}", name(i), off_deg,
                    kAxisNames[static_cast<std::size_t>(number)]),
        fmt::format("at most {} degrees, at joint angles zero; or another role for this joint", kMaxOff_deg));
  }

  const RobotDescription& robot_;
  const robot::RobotModel& model_;
  hal::Side side_;
  std::string prefix_;
  std::vector<InputError>& errors_;
  std::array<std::size_t, kLegJoints> indices_{};  // by robot::LegJoint
  std::vector<std::size_t> joints_;                // robot::LegJoint, those that the leg has
};

// A joint that only one of two legs has is most often a misspelt name or role.
void find_missing_mirrors(const RobotDescription& robot, const robot::RobotModel& model,
                          std::vector<InputError>& errors) {
  const auto has_leg = [&](hal::Side side) {
    for (std::size_t i = 0; i < kLegJoints; ++i)
      if (model.find_hinge(robot::leg_role(side, i))) return true;
    return false;
  };
  if (!has_leg(hal::Side::kLeft) || !has_leg(hal::Side::kRight)) return;
  for (std::size_t i = 0; i < kLegJoints; ++i) {
    const auto left = model.find_hinge(robot::leg_role(hal::Side::kLeft, i));
    const auto right = model.find_hinge(robot::leg_role(hal::Side::kRight, i));
    if (left.has_value() == right.has_value()) continue;
    const std::string present = (left ? "left_" : "right_") + std::string(kNames[i]);
    const std::string missing = (left ? "right_" : "left_") + std::string(kNames[i]);
    errors.emplace_back(robot.file, robot.hinge(left ? *left : *right).line,
                        "no joint " + missing + " beside " + present,
                        "both or neither; `koboshi model map` proposes roles");
  }
}

}  // namespace

void find_leg_faults(const RobotDescription& robot, const robot::RobotModel& model,
                     std::vector<InputError>& errors) {
  find_missing_mirrors(robot, model, errors);
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight})
    LegFaults(robot, model, side, errors).find();
}

}  // namespace koboshi::simulation
