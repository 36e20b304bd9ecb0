#pragma once

#include <array>
#include <vector>

#include "firmware/robot/leg.h"
#include "mechanics/hinge_tree.h"
#include "sim_board/description/description.h"
#include "simulation/gait/gait.h"
#include "simulation/gait/gait_plan.h"
#include "simulation/model/robot_model.h"

namespace koboshi::simulation {

// Computes joint targets from a plan.
class WalkingPose {
 public:
  // All arguments must outlive this object.
  WalkingPose(const Gait& gait, const sim_board::RobotDescription& robot, const NamedModel& model);

  // Returns the targets in rad, by joint. They place the robot's centre of mass and soles as planned with the
  // gait's trunk pitch, and compensate the servos' sag. Throws InputError if a pose cannot be reached.
  std::vector<double> targets_rad(const GaitInstant& instant) const;

 private:
  std::vector<double> solve_legs(const GaitInstant& instant, const Eigen::Isometry3d& X_WB) const;
  void compensate_sag(const GaitInstant& instant, const Eigen::Isometry3d& X_WB,
                      std::vector<double>& angles_rad) const;
  void check_limits(const std::vector<double>& angles_rad) const;

  const Gait& gait_;
  const sim_board::RobotDescription& robot_;
  const NamedModel& model_;
  mechanics::HingeTree tree_;
  std::array<robot::LegGeometry, 2> legs_;
  std::vector<double> upper_body_rad_;  // by joint; zero for the legs
};

}  // namespace koboshi::simulation
