#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "hal/port/imu.h"
#include "sim_board/description/description.h"
#include "sim_board/sensor/sensitivity.h"
#include "sim_board/sensor/six_axis.h"
#include "sim_board/world/world.h"

namespace koboshi::sim_board {

// Inertial measurement unit at pose X_LS in a link. Measures in its frame S:
//
//   gyro            w_WL_S,
//   accelerometer   R_SW (a_WS - g_W): +1 g upwards at rest,
//
// where a_WS is the change of the sensor's velocity over the last physics step, divided by the step. This
// mean includes the centripetal and tangential terms. It is the acceleration at the middle of the step, so it
// is rotated by the mean of R_SW before and after the step. The gyro measures the rate at the end of the
// step, plus its response to acceleration (g-sensitivity of its vibrating masses).
class Imu {
 public:
  // `link` carries the sensor; `g_W` is the world's gravity in m/s^2. Throws as SixAxis does.
  Imu(const ImuDescription& description, const LinkDescription& link, const Eigen::Vector3d& g_W,
      const SensorErrors& errors);

  // Call it once before the first physics step, with the link at rest, and after each step. `time_us` is the
  // world's time.
  void step(const World& world, std::uint64_t time_us) { step(world.body(link_), time_us); }
  void step(const BodyState& link, std::uint64_t time_us);
  // Takes the oldest sample that has arrived by `now_us`. Returns false and leaves `sample` unchanged if
  // there is none.
  [[nodiscard]] bool poll(std::uint64_t now_us, hal::ImuSample& sample);
  // Adds a rate to what the gyro senses from now on, in the link's axes: for measuring control loops.
  void add_rate(const Eigen::Vector3d& w_L_rad_per_s) { added_rate_S_ = R_SL_ * w_L_rad_per_s; }
  // A stopped sensor delivers no samples.
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
  Eigen::Vector3d added_rate_S_ = Eigen::Vector3d::Zero();
  CrossSensitivity g_sensitivity_;
  SixAxis channels_;
  Motion last_;
  bool started_ = false;
};

}  // namespace koboshi::sim_board
