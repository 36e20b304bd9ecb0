#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "hal/port/imu.h"
#include "sim_board/robot/description.h"
#include "sim_board/sensor/sensitivity.h"
#include "sim_board/sensor/six_axis.h"
#include "sim_board/world/world.h"

namespace koboshi::sim {

// An inertial unit at X_LS of a link, measuring in its own frame S
//
//   gyro            w_WL_S,
//   accelerometer   R_SW (a_WS - g_W): +1 g upwards at rest,
//
// where a_WS is the velocity difference of the sensor's point over the last physics step divided by it. That
// mean contains the centripetal and the tangential term and is the acceleration at the middle of the step, so
// it is turned into the sensor's axes as they are there; the gyro's rate is that at the end of the step. To
// it comes what the vibrating masses of a real gyro take acceleration for (g-sensitivity).
class Imu {
 public:
  // `link` is the one that the sensor sits on; `g_W` the world's gravity, m/s^2. Throws as SixAxis does.
  Imu(const ImuDescription& description, const LinkDescription& link, const Eigen::Vector3d& g_W,
      const SensorErrors& errors);

  // Once before the first physics step, with the link at rest, and then after each. `time_us` is the world's
  // time.
  void step(const World& world, std::uint64_t time_us) { step(world.body(link_), time_us); }
  void step(const BodyState& link, std::uint64_t time_us);
  // Takes the oldest sample that has arrived by `now_us`. False, and `sample` untouched, when there is none.
  [[nodiscard]] bool poll(std::uint64_t now_us, hal::ImuSample& sample);
  // A stopped sensor delivers nothing.
  void set_running(bool running) { channels_.set_running(running); }

 private:
  struct Motion {
    std::uint64_t time_us = 0;
    Eigen::Matrix3d R_SW = Eigen::Matrix3d::Identity();
    Eigen::Vector3d v_WS_W = Eigen::Vector3d::Zero();
  };

  int link_;
  Eigen::Matrix3d R_SL_;
  Eigen::Vector3d p_ComS_L_;  // from the link's centre of mass to the sensor
  Eigen::Vector3d g_W_;
  CrossSensitivity g_sensitivity_;
  SixAxis channels_;
  Motion last_;
  bool started_ = false;
};

}  // namespace koboshi::sim
