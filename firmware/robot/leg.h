#pragma once

#include <array>
#include <cstddef>

#include "firmware/robot/model.h"

namespace koboshi::robot {

// The places of a leg's joints, from the trunk down.
enum LegJoint : std::size_t { kHipYaw, kHipRoll, kHipPitch, kKnee, kAnklePitch, kAnkleRoll };

// What the closed-form inverse kinematics needs of a leg whose three hip axes (z, x, y) meet in the point H,
// whose two ankle axes (y, x) meet in the point A, and whose knee axis (y) lies in the plane y = 0 of both at
// joint zero. The knee may lie before or behind the line HA: thigh and shank then lean by their tilts at
// joint zero, positive backwards down, as pitch is.
struct LegGeometry {
  std::array<JointIndex, kLegJoints> joints{};  // by LegJoint
  std::array<std::int8_t, kLegJoints> signs{};  // +1 where a joint's axis is +z, +x or +y
  Position p_BH_B;
  fixed::Length thigh;
  fixed::Length shank;
  fixed::Angle thigh_tilt;
  fixed::Angle shank_tilt;
  fixed::Length ankle_height;
};

// False when a leg joint is missing or the leg has another shape.
[[nodiscard]] bool make_leg_geometry(const RobotModel& model, hal::Side side, LegGeometry& geometry);

struct LegAngles {
  std::array<fixed::Angle, kLegJoints> angles{};  // in the order of LegGeometry::joints, signs applied
  // False where the sole cannot go there. The leg then points at the target, stretched or folded as far as it
  // goes, and the sole keeps its direction; where a joint's limit forbids that, the joints after it (knee,
  // ankle, hip) do what they can.
  bool reached = false;
};

// Joint angles that put the sole frame into X_BSole, the knee bent forward: the closed form of Kajita et al.,
// Introduction to Humanoid Robotics, 2.5.2, with the knee by half-angle tangent so that it needs no division
// and stays exact near the straight leg. Where the hip roll is +-90 degrees yaw and pitch turn about one
// axis; the answer is one of the many.
[[nodiscard]] LegAngles leg_inverse_kinematics(const RobotModel& model, const LegGeometry& geometry,
                                               const Pose& X_BSole);

}  // namespace koboshi::robot
