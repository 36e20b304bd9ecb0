#include "simulation/model/leg_faults.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
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
constexpr double kTolerance_m = 1e-6;  // as kCoincidenceTolerance in firmware/robot/leg.cc

Vector3d metres(const robot::Position& p) {
  return {fixed::to_double(p.x), fixed::to_double(p.y), fixed::to_double(p.z)};
}

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
    if (!find_joints()) return;
    for (std::size_t i = 0; i < kLegJoints; ++i) {
      check_parent(i);
      check_axis(i);
    }
    check_meeting(robot::kHipRoll, "hip", "hip_yaw");
    check_meeting(robot::kHipPitch, "hip", "hip_roll");
    check_plane(robot::kKnee, "hip");
    check_below(robot::kKnee, "hip");
    check_plane(robot::kAnklePitch, "knee");
    check_below(robot::kAnklePitch, "knee");
    check_meeting(robot::kAnkleRoll, "ankle", "ankle_pitch");
  }

 private:
  std::string role(std::size_t i) const { return prefix_ + kNames[i]; }
  // With the role, if that is not the name.
  std::string name(std::size_t i) const {
    const std::string& name = joint(i).name;
    return name == role(i) ? name : name + " (" + role(i) + ")";
  }
  const JointDescription& joint(std::size_t i) const { return robot_.joints[indices_[i]]; }
  Vector3d anchor_m(std::size_t i) const { return metres(model_.joints[indices_[i]].anchor); }
  void add(std::size_t i, const std::string& found, const std::string& expected) {
    errors_.emplace_back(robot_.file, joint(i).line, found, expected);
  }

  bool find_joints() {
    bool complete = true;
    for (std::size_t i = 0; i < kLegJoints; ++i) {
      if (const auto index = model_.find(robot::leg_role(side_, i))) {
        indices_[i] = *index;
        continue;
      }
      complete = false;
      errors_.emplace_back(
          robot_.file, robot_.line, "no joint " + role(i),
          "a leg of six joints with the names or roles " + prefix_ +
              "hip_yaw, hip_roll, hip_pitch, knee, ankle_pitch, ankle_roll (koboshi model map "
              "proposes roles)");
    }
    return complete;
  }

  void check_parent(std::size_t i) {
    const robot::LinkIndex expected =
        i == 0 ? robot::LinkIndex() : robot::LinkIndex(robot::JointIndex(indices_[i - 1]));
    if (model_.joints[indices_[i]].parent == expected) return;
    const std::string& base = robot_.links.front().name;
    add(i, name(i) + " on the link " + robot_.links.at(static_cast<std::size_t>(joint(i).parent)).name,
        i == 0 ? "a joint on " + base : "a joint on the link that " + name(i - 1) + " turns");
  }

  void check_axis(std::size_t i) {
    const robot::Direction& axis = model_.joints[indices_[i]].axis;
    robot::Direction unit{};
    const int number = kAxes[i];
    (number == 0 ? unit.x : number == 1 ? unit.y : unit.z) = fixed::kOne;
    if (axis == unit || axis == -unit) return;
    const Vector3d axis_B = robot_.links.front().X_ML.linear().transpose() * joint(i).axis_M;
    const double across = std::hypot(axis_B[(number + 1) % 3], axis_B[(number + 2) % 3]);
    const double off_deg = kDegreesPerRad * std::atan2(across, std::abs(axis_B[number]));
    add(i,
        fmt::format("the axis of {}, {:.2g} degrees from the base's {}", name(i), off_deg,
                    kAxisNames[static_cast<std::size_t>(number)]),
        fmt::format("that axis exactly, at joint angles zero: an <xyz> without rounded rotations"));
  }

  // The axes of a hip meet in one point, and those of an ankle.
  void check_meeting(std::size_t i, const char* what, const char* other) {
    const Vector3d miss_m = anchor_m(i);
    if (miss_m.cwiseAbs().maxCoeff() <= kTolerance_m) return;
    add(i,
        fmt::format("{} at ({:.3f}, {:.3f}, {:.3f}) mm from {}{}", name(i), kMmPerM * miss_m.x(),
                    kMmPerM * miss_m.y(), kMmPerM * miss_m.z(), prefix_, other),
        fmt::format("one point for the axes of the {}, to 0.001 mm (each may slide along its own axis)",
                    what));
  }

  void check_plane(std::size_t i, const char* above) {
    const double miss_m = anchor_m(i).y();
    if (std::abs(miss_m) <= kTolerance_m) return;
    add(i, fmt::format("{} {:.3f} mm beside the {}", name(i), kMmPerM * miss_m, above),
        "hip, knee and ankle in one plane, to 0.001 mm (a pitch joint may slide along its own axis)");
  }

  void check_below(std::size_t i, const char* above) {
    const double height_m = anchor_m(i).z();
    if (height_m < -kTolerance_m) return;
    add(i, fmt::format("{} {:.3f} mm above the {} at joint angles zero", name(i), kMmPerM * height_m, above),
        "a leg that hangs down");
  }

  const RobotDescription& robot_;
  const robot::RobotModel& model_;
  hal::Side side_;
  std::string prefix_;
  std::vector<InputError>& errors_;
  std::array<std::size_t, kLegJoints> indices_{};
};

}  // namespace

void find_leg_faults(const RobotDescription& robot, const robot::RobotModel& model,
                     std::vector<InputError>& errors) {
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight})
    LegFaults(robot, model, side, errors).find();
}

}  // namespace koboshi::simulation
