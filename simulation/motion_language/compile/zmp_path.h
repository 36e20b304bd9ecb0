#pragma once

#include "simulation/model/robot_model.h"
#include "simulation/motion_language/parse/diagnostic.h"
#include "simulation/motion_language/parse/source.h"

namespace koboshi::simulation {

// Returns the motion with its moves of `path: zmp` divided into short ones, along which the centre of mass
// moves so that the zero moment point goes straight from pose to pose: in each pose it is where the centre of
// mass of the robot at rest would be. A run of such moves, one after the other in a list, begins and ends at
// rest.
//
// The centre of mass is that of a linear inverted pendulum of constant height z (Kajita et al., "The 3D
// linear inverted pendulum mode", IROS 2001), p = c - z/g c''. With its ends and their speeds given, c is the
// path whose p has the least squared distance from the straight lines, weighted by time. The sole that stays
// on the ground is the frame; the other foot, the height of the hips and the trunk go from pose to pose along
// minimum jerk, and the legs follow by inverse kinematics.
//
// Reports a run that does not follow a pose of all joints of the legs, or in which neither sole stays on the
// ground, a path out of reach, and as a warning a ZMP farther than kZmpTolerance from its line.
[[nodiscard]] MotionSource with_zmp_paths(const MotionSource& motion, const NamedModel& robot,
                                          Diagnostics& diagnostics);

// In heights of the centre of mass: a centimetre of a robot whose centre is 20 cm high, half of the shortest
// distance between the middle of its sole and an edge.
inline constexpr double kZmpTolerance = 0.05;

}  // namespace koboshi::simulation
