#pragma once

#include "sim_board/robot/description.h"
#include "sim_board/sensor/channel.h"
#include "sim_board/sensor/sensitivity.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// What the force axes of a six-axis sensor show of a torque, and the torque axes of a force: its strain
// gauges sit on one body, and calibration leaves a rest. With AxisGains for the axes of each triad this fills
// the sensor's 6 x 6 matrix. Drawn once by the seed:
//
//   f_i += c_ij F/T tau_j,   tau_i += c'_ij T/F f_j,   |c| <= crosstalk,
//
// where F and T are the ranges of force and torque.
class AnkleCrosstalk {
 public:
  AnkleCrosstalk(const AnkleSensorDescription& description, const SensorErrors& errors);

  Wrench apply(const Wrench& wrench) const;

 private:
  CrossSensitivity force_by_torque_;  // N / (N m)
  CrossSensitivity torque_by_force_;  // N m / N
};

}  // namespace koboshi::sim
