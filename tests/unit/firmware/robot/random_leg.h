#pragma once

#include <array>
#include <random>

#include "firmware/robot/leg.h"
#include "tests/unit/firmware/robot/reference.h"

// Legs of any geometry, and their kinematics in double precision, independent of the firmware.
namespace koboshi::test {

// How a leg differs from that of the test robot.
struct LegPlan {
  std::array<robot::LegJoint, 3> hip{robot::kHipYaw, robot::kHipRoll, robot::kHipPitch};
  std::array<robot::LegJoint, 2> ankle{robot::kAnklePitch, robot::kAnkleRoll};
  bool has_yaw = true;
  std::array<Point, robot::kLegJoints> offsets{};  // added to the anchors, by place in the chain, in m
  std::array<Point, robot::kLegJoints> tilts{};    // added to the axes, by LegJoint; they are normalised
  std::array<bool, robot::kLegJoints> reversed{};  // axes, by LegJoint
};

// Returns the test robot with two such legs; the right one is the mirror image.
robot::RobotModel make_robot_with(const LegPlan& plan);

// Draws a plan: any order of the joints, up to 50 mm between the hip axes and 10 mm between those of the
// ankle, axes off by up to 10 degrees, any signs, and hips turned by 45 degrees in one of four.
LegPlan draw_leg_plan(std::mt19937& random);

// The pose of a sole in double precision.
struct SolePose {
  Point p;
  std::array<Point, 3> axes;
};

// A leg in double precision: its pose by the reference kinematics, and its inverse by Levenberg and
// Marquardt's method with a Jacobian of finite differences.
class ReferenceLeg {
 public:
  using Angles = std::array<double, robot::kLegJoints>;  // by LegJoint

  ReferenceLeg(const robot::RobotModel& model, hal::Side side, const robot::LegGeometry& leg)
      : model_(model), side_(side), leg_(leg) {}

  SolePose pose(const Angles& angles_rad) const;
  // Improves `angles_rad`. Returns the largest component of the error that is left, in m and rad; without hip
  // yaw the heading is none of them.
  double solve(const SolePose& target, Angles& angles_rad) const;
  // By how much the sole is off, in m, and its axes, in rad.
  double position_error_m(const Angles& angles_rad, const SolePose& target) const;
  double direction_error(const Angles& angles_rad, const SolePose& target) const;

 private:
  std::array<double, 6> error(const Angles& angles_rad, const SolePose& target) const;

  const robot::RobotModel& model_;
  hal::Side side_;
  const robot::LegGeometry& leg_;
};

robot::Pose to_fixed(const SolePose& pose);
ReferenceLeg::Angles to_double(const robot::LegAngles& solution);

}  // namespace koboshi::test
