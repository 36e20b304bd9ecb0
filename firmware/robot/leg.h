#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/robot/model.h"

namespace koboshi::robot {

// The joints of a leg by their role. A leg without hip yaw has five.
enum LegJoint : std::size_t { kHipYaw, kHipRoll, kHipPitch, kKnee, kAnklePitch, kAnkleRoll };

// The geometry of a leg for the inverse kinematics. The hip joints come first from the trunk down, in any
// order, then the knee, then the two ankle joints in any order.
//
// A standard leg has a solution in closed form. Its three hip axes (z, x, y) meet in the point H, its two
// ankle axes (y, x) in the point A; at joint zero the knee axis (y) lies in the plane y = 0 through both. The
// knee may lie in front of or behind the line HA: thigh and shank then have tilts at joint zero, positive
// where the lower end is behind, like a positive pitch. For any other leg, thigh, shank and tilts are those
// in the plane across the knee axis, with the hip pitch in H and the ankle pitch in A.
struct LegGeometry {
  // The leg's joints from the trunk down. Inverse of `joints`.
  [[nodiscard]] std::span<const LegJoint> chain() const { return {chain_joints.data(), joint_count}; }
  // False for a leg without a hip yaw of its own: its foot keeps the heading that hip and ankle leave it.
  [[nodiscard]] bool can_turn() const { return joint_count == kLegJoints && !shares_yaw; }

  std::array<JointIndex, kLegJoints> joints{};  // by LegJoint, with drives; a missing hip yaw has the index 0
  std::array<JointIndex, kLegJoints> hinges{};  // the same, but for a hip yaw that follows another joint
  std::array<std::int8_t, kLegJoints> signs{};  // +1 where a joint's axis is nearest to +z, +x or +y; else -1
  std::array<LegJoint, kLegJoints> chain_joints{};
  std::size_t joint_count = 0;  // 5 or 6
  // The hip yaw's motor turns the other leg's as well: its angle is given. Angles are those of the motor's
  // joint; the hinge is at yaw_multiplier * angle + yaw_offset.
  bool shares_yaw = false;
  fixed::Gain yaw_multiplier = fixed::Gain::from_raw(1 << fixed::Gain::kFractionBits);
  fixed::Angle yaw_offset;
  bool is_standard = false;
  Position p_BH_B;  // H at joint zero
  fixed::Length thigh;
  fixed::Length shank;
  fixed::Angle thigh_tilt;
  fixed::Angle shank_tilt;
  fixed::Length ankle_height;  // of the last ankle axis above the sole
  // For the Newton steps: the sum of all links from the first hip axis to the sole, and the exponent of the
  // power of two, in m, by which lengths are divided there; it is not below that sum.
  fixed::Length extent;
  int scale = 0;
};

// Returns +1 where the axis of a leg joint is nearest to +z, +x or +y, as its place in the leg has it; else
// -1.
[[nodiscard]] std::int8_t leg_sign(const Joint& joint, LegJoint place);

// Computes the geometry of a leg. Returns false if a joint other than the hip yaw is missing, if the joints
// are in another order, or if they cannot move the sole in all directions; `geometry` is then undefined.
[[nodiscard, gnu::cold]] bool make_leg_geometry(const RobotModel& model, hal::Side side,
                                                LegGeometry& geometry);

// Returns whether both legs have such a geometry: the robot can walk by command.
[[nodiscard]] bool can_walk(const RobotModel& model);

// Returns whether both hips have a yaw joint: a robot that walks can turn its feet, and itself. One motor for
// both must turn the feet against each other.
[[nodiscard]] bool can_turn(const RobotModel& model);

// How one motor for both hip yaws turns the left foot relative to the right one. The other joints of a leg
// keep its sole level, so that only the vertical part of the hinge's axis turns the foot.
struct SharedYaw {
  JointIndex joint;  // with the motor
  fixed::Gain feet;  // turn of the left foot to the left, relative to the right one, per turn of the joint
  fixed::Angle max_turn;  // of the feet against each other to either side, within the joint's limits
};
// Returns nothing if each hip yaw has its own motor, or there is none.
[[nodiscard, gnu::cold]] std::optional<SharedYaw> shared_yaw(const RobotModel& model);
// Least magnitude of SharedYaw::feet with which the robot turns. By hand, 2026-11-28: half of the 1.41 of
// hips at 45 degrees.
inline constexpr fixed::Gain kMinSharedYaw = fixed::Gain::from_raw(46341);

// Tolerances of LegAngles::reached, for the rounding of targets that are just reachable: of a distance, of an
// angle (2^-18 turn, four units of a drive's position), of a sine (7.6e-6, a third of that angle). Set by
// hand (2026-11-21), of the size of the solver's own error: forward of inverse kinematics errs by up to 1.1
// um over the workspace (tests/unit/firmware/robot/leg_test.cc).
inline constexpr fixed::Length kReachTolerance = fixed::Length::from_raw(16);  // 1 um
inline constexpr fixed::Angle kLimitTolerance = fixed::Angle::from_raw(1 << 14);
inline constexpr fixed::Ratio kTurnTolerance = fixed::Ratio::from_raw(1 << 13);

struct LegAngles {
  std::array<fixed::Angle, kLegJoints> angles{};  // in the order of LegGeometry::joints, signs applied
  // Whether the sole reaches its target; without hip yaw, but for the heading. If not, the leg points at the
  // target, stretched or folded as far as possible, and the sole keeps its orientation; if a joint's limit
  // prevents that, the joints solved later (ankle, hip) compensate as far as they can.
  bool reached = false;
  // Turn to the left that the foot lacks to reach its target's heading; zero for a leg with a hip yaw of its
  // own.
  fixed::Angle missing_heading;
};

// Computes the joint angles that place the sole frame at X_BSole, with the knee bent forward. For a standard
// leg this is the closed form of Kajita et al., Introduction to Humanoid Robotics, 2.5.2. The knee angle k
// comes from its half-angle tangent,
//   tan(k/2)^2 = ((A + B)^2 - C^2) / (C^2 - (A - B)^2)
// with thigh A, shank B and the distance C from H to A. It is computed as atan2 of two square roots, without
// a division, and is exact near the straight leg. At a hip roll of +-90 degrees, yaw and pitch turn about one
// axis: the result is one of many solutions.
//
// Any other leg is solved by damped Newton steps on its true chain (leg_newton.h): kTrackingSteps of them
// from `last`, the solution of the last cycle, or up to kMaxFirstSteps from bent knees without one, or where
// the target has jumped.
//
// A first solution in parts takes kTrackingSteps in each of kFirstSolutionParts calls for one pose: from bent
// knees without `last`, then from what the last call returned. No call then costs more than a cycle that has
// the last cycle's solution.
//
// `yaw` is the angle of the joint whose motor turns both hip yaws (LegGeometry::shares_yaw).
enum class FirstSolution : std::uint8_t { kAtOnce, kInParts };
inline constexpr int kFirstSolutionParts = 6;
[[nodiscard]] LegAngles leg_inverse_kinematics(const RobotModel& model, const LegGeometry& geometry,
                                               const Pose& X_BSole, const LegAngles* last = nullptr,
                                               FirstSolution first = FirstSolution::kAtOnce,
                                               fixed::Angle yaw = {});

}  // namespace koboshi::robot
