#include "simulation/observe/zmp_sensor_check.h"

#include "sim_board/scenario/player.h"

namespace koboshi::simulation {

ZmpSensorCheck::ZmpSensorCheck(const sim::RobotDescription& robot, const sim::Scenario& scenario)
    : robot_(robot), feet_(sim::feet_of(robot)) {
  const sim::BoardOptions options = sim::board_options(scenario, robot);
  const sim::SensorErrors errors{.seed = options.seed, .scale = options.noise_scale};
  const double gravity_m_per_s2 = options.world.gravity_W_m_per_s2.norm();
  if (robot.left_ankle) sensors_[0].emplace(*robot.left_ankle, robot, gravity_m_per_s2, errors);
  if (robot.right_ankle) sensors_[1].emplace(*robot.right_ankle, robot, gravity_m_per_s2, errors);
}

void ZmpSensorCheck::observe(const sim::SimBoard& board) {
  for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
    const auto i = static_cast<std::size_t>(side);
    const sim::AnkleSensor* sensor = board.ankle_sensor(side);
    if (sensor == nullptr) continue;
    const sim::AnkleZmp::Reading shown = sensors_[i]->read(sensor->wrench_S());
    const sim::FootPressure truth = sim::foot_pressure(robot_, *feet_[i], board.world());
    if (shown.load_N < kMinLoad_N || truth.load_N < kMinLoad_N) continue;
    error_.add((shown.zmp_S_m - truth.zmp_S_m).squaredNorm());
  }
}

}  // namespace koboshi::simulation
