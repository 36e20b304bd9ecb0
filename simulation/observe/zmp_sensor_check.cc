#include "simulation/observe/zmp_sensor_check.h"

#include "simulation/scenario/player.h"

namespace koboshi::simulation {

ZmpSensorCheck::ZmpSensorCheck(const sim_board::RobotDescription& robot, const Scenario& scenario)
    : robot_(robot), feet_(sim_board::feet_of(robot)) {
  const sim_board::BoardOptions options = board_options(scenario, robot);
  const sim_board::SensorErrors errors{.seed = options.seed, .scale = options.noise_scale};
  const double gravity_m_per_s2 = options.world.gravity_W_m_per_s2.norm();
  if (robot.left_ankle) sensors_[0].emplace(*robot.left_ankle, robot, gravity_m_per_s2, errors);
  if (robot.right_ankle) sensors_[1].emplace(*robot.right_ankle, robot, gravity_m_per_s2, errors);
}

void ZmpSensorCheck::observe(const sim_board::SimBoard& board) {
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    const auto i = static_cast<std::size_t>(side);
    const sim_board::AnkleSensor* sensor = board.electronics().ankle_sensor(side);
    if (sensor == nullptr) continue;
    const sim_board::AnkleZmp::Reading shown = sensors_[i]->read(sensor->wrench_S());
    const sim_board::FootPressure truth = sim_board::foot_pressure(robot_, *feet_[i], board.world());
    if (shown.load_N < kMinLoad_N || truth.load_N < kMinLoad_N) continue;
    error_.add((shown.zmp_S_m - truth.zmp_S_m).squaredNorm());
  }
}

void ZmpSensorCheck::archive(sim_board::StateArchive& archive) { archive(sensors_, error_); }

}  // namespace koboshi::simulation
