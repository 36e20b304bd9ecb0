#pragma once

#include <Eigen/Core>

#include "sim_board/description/description.h"
#include "sim_board/sensor/channel.h"
#include "sim_board/sensor/sensitivity.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Computes the ZMP of a foot from the wrench at its ankle sensor, in double precision. Includes all errors of
// the sensor except filter, jitter and delay: the limit of what any firmware can measure.
//
// The weight of the parts below the sensor is added to the wrench, for a level foot at rest. Then
//   p_x = (-tau_y - f_x d) / f_z,  p_y = (tau_x - f_y d) / f_z
// in the frame of the sole, at distance d below the sensor (equation 1 of the paper, with f_z as
// denominator).
class AnkleZmp {
 public:
  struct Reading {
    double load_N = 0.0;
    Eigen::Vector2d zmp_S_m = Eigen::Vector2d::Zero();  // the sole's origin if there is no load
  };

  // `robot` contains the description's joint and the foot, its child. Throws as Channel does.
  AnkleZmp(const AnkleSensorDescription& description, const RobotDescription& robot, double gravity_m_per_s2,
           const SensorErrors& errors);

  // `wrench_S` is that of AnkleSensor::wrench_S(). Each call draws new noise and advances the drift by one
  // sampling period.
  Reading read(const Wrench& wrench_S);

 private:
  double height_m_;
  Wrench foot_weight_S_;  // carried by the ground, but not by the sensor
  double force_resolution_N_;
  double torque_resolution_Nm_;
  AnkleCrosstalk crosstalk_;
  Channel force_;
  Channel torque_;
};

}  // namespace koboshi::sim_board
