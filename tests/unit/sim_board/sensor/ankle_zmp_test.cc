#include "sim_board/sensor/ankle_zmp.h"

#include <gtest/gtest.h>

namespace koboshi::sim_board {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGravity_m_per_s2 = 10.0;
constexpr double kHeight_m = 0.04;
const Vector3d p_SCom_S(0.01, 0.0, -0.03);  // of a foot of 100 g

struct Rig {
  Rig() {
    robot.links.resize(2);
    robot.links[1].mass_kg = 0.1;
    robot.links[1].p_LCom_L = p_SCom_S;
    robot.joints.resize(1);
    robot.joints[0].child = 1;
    sensor.name = "ankle";
    sensor.joint = 0;
    sensor.height_above_sole_m = kHeight_m;
    sensor.force = {.range = 100.0, .resolution = 0.004};
    sensor.torque = {.range = 4.0, .resolution = 0.0002};
  }

  // The ground pushes with `f_N` at a place in the sole; the foot stands level and at rest.
  AnkleZmp::Reading on_ground(const Vector3d& f_N, const Vector2d& zmp_S_m, double noise_scale = 0.0) {
    const Vector3d weight_N(0.0, 0.0, -0.1 * kGravity_m_per_s2);
    const Wrench wrench_S{
        f_N + weight_N, Vector3d(zmp_S_m.x(), zmp_S_m.y(), -kHeight_m).cross(f_N) + p_SCom_S.cross(weight_N)};
    AnkleZmp zmp(sensor, robot, kGravity_m_per_s2, {.seed = 1, .scale = noise_scale});
    return zmp.read(wrench_S);
  }

  RobotDescription robot;
  AnkleSensorDescription sensor;
};

TEST(AnkleZmp, IsTheCentreOfPressureForAnyFriction) {
  Rig rig;
  for (const Vector3d& f_N :
       {Vector3d(0.0, 0.0, 12.0), Vector3d(3.0, -2.0, 12.0), Vector3d(-0.5, 0.5, 2.0)}) {
    for (const Vector2d& zmp_S_m : {Vector2d(0.0, 0.0), Vector2d(0.05, 0.0), Vector2d(-0.03, 0.02)}) {
      const AnkleZmp::Reading reading = rig.on_ground(f_N, zmp_S_m);
      EXPECT_NEAR(reading.load_N, f_N.z(), 0.002);
      // Half a count of torque at each load, and of force at the sensor's height.
      EXPECT_LT((reading.zmp_S_m - zmp_S_m).cwiseAbs().maxCoeff(), (0.0001 + 0.002 * 0.09) / f_N.z());
    }
  }
}

TEST(AnkleZmp, HasTheSensorsBias) {
  Rig rig;
  rig.sensor.torque.bias = 0.01;
  const double error_m = rig.on_ground({0.0, 0.0, 10.0}, {0.0, 0.0}, 1.0).zmp_S_m.norm();
  EXPECT_GT(error_m, 0.00005);
  EXPECT_LT(error_m, 0.0015);
}

// A force straight through the ankle that reads as a torque as well.
TEST(AnkleZmp, HasTheSensorsCrosstalk) {
  Rig rig;
  rig.sensor.crosstalk = 0.1;
  const AnkleCrosstalk crosstalk(rig.sensor, {.seed = 1});
  const Vector3d f_N(0.0, 0.0, 10.0);
  const Vector3d weight_N(0.0, 0.0, -0.1 * kGravity_m_per_s2);
  const Wrench felt = crosstalk.apply({f_N + weight_N, p_SCom_S.cross(weight_N)});
  const Vector3d tau_Nm = felt.torque_Nm - p_SCom_S.cross(weight_N);
  const Vector3d f_felt_N = felt.force_N - weight_N;
  const Vector2d expected_m =
      Vector2d(-tau_Nm.y() - f_felt_N.x() * kHeight_m, tau_Nm.x() - f_felt_N.y() * kHeight_m) / f_felt_N.z();
  EXPECT_GT(expected_m.norm(), 0.0005);
  EXPECT_LT((rig.on_ground(f_N, {0.0, 0.0}, 1.0).zmp_S_m - expected_m).norm(), 0.00005);
}

TEST(AnkleZmp, IsTheOriginOfTheSoleWithoutLoad) {
  EXPECT_EQ(Rig().on_ground(Vector3d::Zero(), {0.03, 0.0}).zmp_S_m, Vector2d(0.0, 0.0));
}

}  // namespace
}  // namespace koboshi::sim_board
