#pragma once

#include "firmware/robot/leg.h"

namespace koboshi::robot {

// Newton steps of a cycle that has the last cycle's solution. In double precision, on walks of seven legs,
// one step leaves up to 0.41 mm and two leave 1.2 um (2026-11-26).
inline constexpr int kTrackingSteps = 2;
// Limit of the steps from bent knees: as many as take a joint by steps of kMaxStep to any angle, and the four
// after them that square a tenth of a radian down to the rounding.
inline constexpr int kMaxFirstSteps = 12;
static_assert(kFirstSolutionParts * kTrackingSteps == kMaxFirstSteps);

// Computes the joint angles of any leg by damped Newton steps. Each solves
//
//   (J^T J + lambda^2 I) dq = J^T e
//
// with the error e of the sole's position and orientation and the Jacobian J of the true chain, by Cholesky
// factorisation. Lengths are in units of 2^LegGeometry::scale m, so that no element of J exceeds 1. The knee
// is the last unknown, which makes it the first that the back substitution finds. What it returns there is
// replaced twice, and the other joints are then the best ones for that knee:
//
// - The foot's distance is nearly linear in cos(k), not in k, which is what makes Newton steps overshoot near
//   the straight leg. The knee therefore goes where cos(k) changes by -sin(k) dk.
// - The knee stays kMinBend short of straight, where J is singular, and within its limits.
//
// The other joints follow from the ankle up, and each is clamped to its limits before the next is computed.
[[nodiscard]] LegAngles newton_leg_inverse_kinematics(const RobotModel& model, const LegGeometry& geometry,
                                                      const Pose& X_BSole, const LegAngles* last,
                                                      FirstSolution first, fixed::Angle yaw);

// Whether the joints can move the sole in all directions from the bent-knee pose: no pivot of the
// factorisation is near zero.
[[nodiscard]] bool is_movable(const RobotModel& model, const LegGeometry& geometry);

}  // namespace koboshi::robot
