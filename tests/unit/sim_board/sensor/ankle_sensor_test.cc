#include "sim_board/sensor/ankle_sensor.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <numbers>

#include "tests/unit/simulation/observe/staged_world.h"

namespace koboshi::sim_board {
namespace {

constexpr double kForceResolution = 1e-3;
constexpr double kTorqueResolution = 1e-5;

// A shank and a foot whose ankle is 40 mm above the sole; the foot's frame is 10 mm ahead of the ankle and at
// the sole.
RobotDescription two_links() {
  RobotDescription robot;
  robot.links.resize(2);
  robot.links[1].X_ML.translation() = Eigen::Vector3d(0.01, 0.03, 0.0);
  JointDescription ankle;
  ankle.parent = 0;
  ankle.child = 1;
  ankle.p_MJ = Eigen::Vector3d(0.0, 0.03, 0.04);
  robot.joints.push_back(ankle);
  return robot;
}

// 15 mm above the sole, below the ankle's axis.
AnkleSensorDescription clean_sensor() {
  AnkleSensorDescription sensor;
  sensor.name = "left_ankle";
  sensor.joint = 0;
  sensor.X_LS.translation() = Eigen::Vector3d(-0.01, 0.0, 0.015);
  sensor.height_above_sole_m = 0.015;
  sensor.force.range = 30.0;
  sensor.force.resolution = kForceResolution;
  sensor.torque.range = 0.3;
  sensor.torque.resolution = kTorqueResolution;
  return sensor;
}

// Returns the sensor's reading once it has settled on a wrench about the joint's anchor.
Wrench read(const AnkleSensorDescription& description, const BodyState& foot, const Wrench& joint_W) {
  AnkleSensor sensor(description, two_links(), {});
  for (std::uint64_t time_us = 0; time_us <= 10'000; time_us += 1000) sensor.step(foot, joint_W, time_us);
  hal::AnkleSample sample;
  EXPECT_TRUE(sensor.poll(20'000, sample));
  while (sensor.poll(20'000, sample)) {
  }
  EXPECT_EQ(sample.time_us, 10'000u);
  return {
      kForceResolution * Eigen::Vector3d(sample.force_raw[0], sample.force_raw[1], sample.force_raw[2]),
      kTorqueResolution * Eigen::Vector3d(sample.torque_raw[0], sample.torque_raw[1], sample.torque_raw[2])};
}

// The wrench about the ankle of a force that acts at a point of the sole; points from the ankle, axes of the
// foot.
Wrench ground_force_at(const Eigen::Vector3d& p_sole, const Eigen::Vector3d& force_N) {
  return {force_N, p_sole.cross(force_N)};
}

// The convention of the whole project: the paper's equation 1 with f_z below the line.
Eigen::Vector2d zero_moment_point(const Wrench& w, double d_m) {
  return {(-w.torque_Nm.y() - w.force_N.x() * d_m) / w.force_N.z(),
          (w.torque_Nm.x() - w.force_N.y() * d_m) / w.force_N.z()};
}

TEST(AnkleSensor, ReadsPositiveForceWhenTheGroundCarriesTheRobot) {
  const Wrench reading = read(clean_sensor(), {}, ground_force_at({0.0, 0.0, -0.04}, {0.0, 0.0, 6.0}));
  EXPECT_NEAR(reading.force_N.z(), 6.0, kForceResolution);
  EXPECT_NEAR(reading.torque_Nm.norm(), 0.0, kTorqueResolution);
}

TEST(AnkleSensor, GivesTheZeroMomentPointOfAForceOnTheSole) {
  // 30 mm ahead of the ankle, 12 mm to its left, with some shear.
  const Wrench reading = read(clean_sensor(), {}, ground_force_at({0.03, 0.012, -0.04}, {1.5, -0.8, 6.0}));
  const Eigen::Vector2d p = zero_moment_point(reading, 0.015);
  EXPECT_NEAR(p.x(), 0.03, 1e-5);  // the sensor is right below the ankle
  EXPECT_NEAR(p.y(), 0.012, 1e-5);
}

TEST(AnkleSensor, ReadsTheSameInAnyOrientationOfTheFoot) {
  const Wrench level = ground_force_at({0.03, 0.012, -0.04}, {1.5, -0.8, 6.0});
  BodyState foot;
  foot.X_WL.linear() =
      (Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.4, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  foot.X_WL.translation() = Eigen::Vector3d(3.0, -2.0, 0.5);
  const Wrench turned{foot.X_WL.linear() * level.force_N, foot.X_WL.linear() * level.torque_Nm};
  const Wrench a = read(clean_sensor(), {}, level);
  const Wrench b = read(clean_sensor(), foot, turned);
  EXPECT_LE((a.force_N - b.force_N).norm(), 2 * kForceResolution);
  EXPECT_LE((a.torque_Nm - b.torque_Nm).norm(), 2 * kTorqueResolution);
}

TEST(AnkleSensor, ReadsInItsOwnAxes) {
  AnkleSensorDescription description = clean_sensor();
  description.X_LS.linear() =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Wrench reading = read(description, {}, {{2.0, 1.0, 6.0}, Eigen::Vector3d::Zero()});
  EXPECT_NEAR(reading.force_N.x(), 1.0, kForceResolution);
  EXPECT_NEAR(reading.force_N.y(), -2.0, kForceResolution);
}

TEST(AnkleSensor, RotatesTheWrenchByThePoseBeforeTheStep) {
  AnkleSensorDescription description = clean_sensor();
  description.force.bandwidth_Hz = 1e6;  // as good as none
  description.torque.bandwidth_Hz = 1e6;
  description.force.delay_s = description.torque.delay_s = 0.0;
  AnkleSensor sensor(description, two_links(), {});
  BodyState before;
  BodyState after;
  after.X_WL.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Wrench along_x{{5.0, 0.0, 0.0}, Eigen::Vector3d::Zero()};
  hal::AnkleSample sample;
  sensor.step(before, along_x, 0);
  sensor.step(after, along_x, 1000);
  ASSERT_TRUE(sensor.poll(1000, sample));
  EXPECT_EQ(sample.force_raw[1], 0);
  sensor.step(after, along_x, 2000);
  ASSERT_TRUE(sensor.poll(2000, sample));
  EXPECT_NEAR(sample.force_raw[1] * kForceResolution, -5.0 * std::sin(0.1), 2e-2);
}

TEST(AnkleSensor, AppliesCrosstalkToSamplesButNotToTheTrueWrench) {
  AnkleSensorDescription description = clean_sensor();
  description.crosstalk = 0.05;
  const Wrench joint_W{{1.0, -2.0, 12.0}, {0.1, -0.05, 0.02}};
  const Wrench true_S = read(clean_sensor(), BodyState{}, joint_W);
  const Wrench shown = read(description, BodyState{}, joint_W);
  const Wrench expected = AnkleCrosstalk(description, {}).apply(true_S);
  EXPECT_GT((expected.torque_Nm - true_S.torque_Nm).norm(), 0.001);
  EXPECT_GT((expected.force_N - true_S.force_N).norm(), 0.1);
  EXPECT_LT((shown.force_N - expected.force_N).cwiseAbs().maxCoeff(), 1.1 * kForceResolution);
  EXPECT_LT((shown.torque_Nm - expected.torque_Nm).cwiseAbs().maxCoeff(), 1.1 * kTorqueResolution);
  AnkleSensor sensor(description, two_links(), {});
  sensor.step(BodyState{}, joint_W, 0);
  EXPECT_LT((sensor.wrench_S().torque_Nm - true_S.torque_Nm).cwiseAbs().maxCoeff(), kTorqueResolution);
}

// It closes at its force and opens below half of it.
TEST(AnkleSensor, ReadsASwitchByTheLoadOfItsSole) {
  AnkleSensorDescription description = clean_sensor();
  description.kind = hal::AnkleKind::kContactSwitch;
  description.closing_force_N = 2.0;
  const RobotDescription robot = two_links();
  simulation::StagedWorld world(robot);
  AnkleSensor sensor(description, robot, {});
  std::uint64_t time_us = 0;
  const auto reading = [&](double load_N) {
    world.unload();
    if (load_N > 0.0) world.load(1, load_N);
    for (const std::uint64_t end_us = time_us + 10'000; time_us < end_us; time_us += 1000)
      sensor.step(world, time_us);
    hal::AnkleSample sample;
    bool any = false;
    while (sensor.poll(time_us, sample)) any = true;
    EXPECT_TRUE(any);
    EXPECT_EQ(sample.force_raw[0], 0);
    EXPECT_EQ(sample.force_raw[1], 0);
    EXPECT_EQ(sample.torque_raw, (std::array<std::int16_t, 3>{}));
    return sample.force_raw[2];
  };
  // The filter overshoots by 4 % of a change.
  EXPECT_EQ(reading(0.0), 0);
  EXPECT_EQ(reading(1.9), 0);
  EXPECT_EQ(reading(2.05), 1);
  EXPECT_EQ(reading(1.1), 1);
  EXPECT_EQ(reading(0.95), 0);
  EXPECT_EQ(reading(1.9), 0);
  EXPECT_EQ(reading(20.0), 1);
  EXPECT_EQ(reading(0.0), 0);
}

}  // namespace
}  // namespace koboshi::sim_board
