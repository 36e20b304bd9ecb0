#pragma once

#include <Eigen/Core>

#include "sim_board/robot/description.h"
#include "sim_board/sensor/ankle_crosstalk.h"
#include "sim_board/sensor/channel.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// The ZMP of a foot by the wrench at its ankle sensor, in double precision. Of the sensor's errors it has
// all but filter, jitter and delay: the best that any firmware could know.
//
// The wrench is corrected for what hangs below the sensor, as if the foot stood level and at rest; then
//   p_x = (-tau_y - f_x d) / f_z,  p_y = (tau_x - f_y d) / f_z
// in the sole's frame, d below the sensor (the paper's equation 1, with f_z as denominator).
class AnkleZmp {
 public:
  struct Reading {
    double load_N = 0.0;
    Eigen::Vector2d zmp_S_m = Eigen::Vector2d::Zero();  // without load the sole's origin
  };

  // `robot` has the joint of the description and its child, the foot. Throws as Channel does.
  AnkleZmp(const AnkleSensorDescription& description, const RobotDescription& robot, double gravity_m_per_s2,
           const SensorErrors& errors);

  // `wrench_S` is what AnkleSensor::wrench_S tells. Each reading has noise of its own and drifts on by one
  // sampling period.
  Reading read(const Wrench& wrench_S);

 private:
  double height_m_;
  Wrench foot_weight_S_;  // what the sensor misses of the ground's wrench
  double force_resolution_N_;
  double torque_resolution_Nm_;
  AnkleCrosstalk crosstalk_;
  Channel force_;
  Channel torque_;
};

}  // namespace koboshi::sim
