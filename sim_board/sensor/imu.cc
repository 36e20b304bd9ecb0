#include "sim_board/sensor/imu.h"

namespace koboshi::sim_board {

Imu::Imu(const ImuDescription& description, const LinkDescription& link, const Eigen::Vector3d& g_W,
         const SensorErrors& errors)
    : link_(description.link),
      R_SL_(description.X_LS.linear().transpose()),
      p_ComS_L_(description.X_LS.translation() - link.p_LCom_L),
      g_W_(g_W),
      g_sensitivity_(description.g_sensitivity * errors.scale, errors.seed,
                     description.name + ".gyro.g_sensitivity"),
      channels_(description.gyro, description.accelerometer, description.name + ".gyro",
                description.name + ".accelerometer", description.name, errors) {}

void Imu::step(const BodyState& link, std::uint64_t time_us) {
  const Eigen::Matrix3d R_WL = link.X_WL.linear();
  const Motion now{time_us, R_SL_ * R_WL.transpose(), link.v_WCom_W + link.w_WL_W.cross(R_WL * p_ComS_L_)};
  const Eigen::Vector3d gyro_S = now.R_SW * link.w_WL_W + added_rate_S_;
  Eigen::Vector3d specific_force_S = now.R_SW * -g_W_;
  if (started_) {
    const double duration_s = static_cast<double>(time_us - last_.time_us) * 1e-6;
    const Eigen::Vector3d a_WS_W = (now.v_WS_W - last_.v_WS_W) / duration_s;
    specific_force_S = 0.5 * (last_.R_SW + now.R_SW) * (a_WS_W - g_W_);
  }
  channels_.step(gyro_S + g_sensitivity_.value() * specific_force_S, specific_force_S, time_us);
  last_ = now;
  started_ = true;
}

bool Imu::poll(std::uint64_t now_us, hal::ImuSample& sample) {
  SixAxis::Sample raw;
  if (!channels_.poll(now_us, raw)) return false;
  sample = {static_cast<std::uint32_t>(raw.time_us), raw.first_raw, raw.second_raw};
  return true;
}

}  // namespace koboshi::sim_board
