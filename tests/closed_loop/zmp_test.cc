#include <gtest/gtest.h>

#include "simulation/observe/zmp_sensor_check.h"
#include "tests/closed_loop/run.h"

namespace koboshi::test {
namespace {

// Returns the RMS difference between the ZMP from the ankle sensors and the ZMP of the engine's contact
// forces, over each millisecond from `begin_us` on.
double zmp_error_rms_m(const simulation::Scenario& scenario, std::uint64_t begin_us, std::uint64_t end_us) {
  RobotRun run(scenario);
  simulation::ZmpSensorCheck check(run.robot(), scenario);
  run.run_until_us(begin_us);
  while (run.now_us() < end_us) {
    run.run_until_us(run.now_us() + 1'000);
    check.observe(run.board());
  }
  return check.rms_m();
}

simulation::Scenario pushed_squat() {
  simulation::Scenario scenario = quick_squat();
  for (const double side : {1.0, -1.0}) {
    simulation::Push push;
    push.at_us = side > 0.0 ? 3'600'000 : 4'600'000;
    push.duration_us = 100'000;
    push.link.text = "trunk";
    push.force_W_N = side * Eigen::Vector3d(1.5, 2.5, 0.0);
    scenario.pushes.push_back(push);
  }
  return scenario;
}

TEST(ZmpOfAnkleSensors, EqualsThatOfTheContactForcesInSquats) {
  const double error_m = zmp_error_rms_m(quick_squat(), 3'000'000, 5'000'000);
  EXPECT_LT(error_m, 0.001);
  EXPECT_GT(error_m, 0.00001);  // the sensors have noise and bias
}

TEST(ZmpOfAnkleSensors, EqualsThatOfTheContactForcesUnderPushes) {
  EXPECT_LT(zmp_error_rms_m(pushed_squat(), 3'000'000, 5'000'000), 0.001);
}

TEST(ZmpOfAnkleSensors, EqualsThatOfTheContactForcesOnTiltedGround) {
  simulation::Scenario scenario = pushed_squat();
  scenario.ground.roll_rad = 0.03;
  scenario.ground.pitch_rad = -0.03;
  EXPECT_LT(zmp_error_rms_m(scenario, 3'000'000, 5'000'000), 0.001);
}

TEST(ZmpOfAnkleSensors, EqualsThatOfTheContactForcesWhileWalking) {
  const simulation::Scenario scenario = simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml");
  const double error_m = zmp_error_rms_m(scenario, 3'500'000, 8'000'000);
  EXPECT_LT(error_m, 0.001);
  EXPECT_GT(error_m, 0.0001);  // the feet have inertia at touchdown
}

}  // namespace
}  // namespace koboshi::test
