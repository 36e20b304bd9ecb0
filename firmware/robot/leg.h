#pragma once

#include <array>
#include <cstddef>

#include "firmware/robot/model.h"

namespace koboshi::robot {

// The joints of a leg, from the trunk down.
enum LegJoint : std::size_t { kHipYaw, kHipRoll, kHipPitch, kKnee, kAnklePitch, kAnkleRoll };

// The geometry of a leg for the closed-form inverse kinematics. The three hip axes (z, x, y) meet in the
// point H, the two ankle axes (y, x) in the point A; at joint zero the knee axis (y) lies in the plane y = 0
// through both. The knee may lie in front of or behind the line HA: thigh and shank then have tilts at joint
// zero, positive where the lower end is behind, like a positive pitch.
struct LegGeometry {
  std::array<JointIndex, kLegJoints> joints{};  // by LegJoint
  std::array<std::int8_t, kLegJoints> signs{};  // +1 where a joint's axis is +z, +x or +y
  Position p_BH_B;
  fixed::Length thigh;
  fixed::Length shank;
  fixed::Angle thigh_tilt;
  fixed::Angle shank_tilt;
  fixed::Length ankle_height;  // of A above the sole
};

// Computes the geometry of a leg. Returns false if a leg joint is missing or the leg has another shape;
// `geometry` is then undefined.
[[nodiscard]] bool make_leg_geometry(const RobotModel& model, hal::Side side, LegGeometry& geometry);

struct LegAngles {
  std::array<fixed::Angle, kLegJoints> angles{};  // in the order of LegGeometry::joints, signs applied
  // Whether the sole reaches its target. If not, the leg points at the target, stretched or folded as far as
  // possible, and the sole keeps its orientation; if a joint's limit prevents that, the joints solved later
  // (ankle, hip) compensate as far as they can.
  bool reached = false;
};

// Computes the joint angles that place the sole frame at X_BSole, with the knee bent forward: the closed form
// of Kajita et al., Introduction to Humanoid Robotics, 2.5.2. The knee angle k comes from its half-angle
// tangent,
//   tan(k/2)^2 = ((A + B)^2 - C^2) / (C^2 - (A - B)^2)
// with thigh A, shank B and the distance C from H to A. It is computed as atan2 of two square roots, without
// a division, and is exact near the straight leg. At a hip roll of +-90 degrees, yaw and pitch turn about one
// axis: the result is one of many solutions.
[[nodiscard]] LegAngles leg_inverse_kinematics(const RobotModel& model, const LegGeometry& geometry,
                                               const Pose& X_BSole);

}  // namespace koboshi::robot
