#include "sim_board/sensor/imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "sim_board/world/gravity.h"

namespace koboshi::sim_board {
namespace {

constexpr double kGyroResolution = 1e-3;
constexpr double kAccelerometerResolution = 2e-3;
const Eigen::Vector3d kGravity(0.0, 0.0, -kGravity_m_per_s2);

ImuDescription clean_imu() {
  ImuDescription imu;
  imu.name = "imu";
  imu.link = 0;
  imu.gyro.range = 30.0;
  imu.gyro.resolution = kGyroResolution;
  imu.accelerometer.range = 60.0;
  imu.accelerometer.resolution = kAccelerometerResolution;
  return imu;
}

struct Reading {
  Eigen::Vector3d gyro;
  Eigen::Vector3d accelerometer;
};

Eigen::Vector3d scaled(const std::array<std::int16_t, 3>& raw, double resolution) {
  return resolution * Eigen::Vector3d(raw[0], raw[1], raw[2]);
}

// The last sample after 200 ms of a motion at 1 ms steps.
Reading read(const ImuDescription& description, const LinkDescription& link,
             const std::function<BodyState(double time_s)>& motion,
             const Eigen::Vector3d& added_L_rad_per_s = Eigen::Vector3d::Zero()) {
  Imu imu(description, link, kGravity, {});
  imu.add_rate(added_L_rad_per_s);
  for (std::uint64_t time_us = 0; time_us <= 200'000; time_us += 1000) {
    imu.step(motion(static_cast<double>(time_us) * 1e-6), time_us);
  }
  hal::ImuSample sample;
  bool any = false;
  while (imu.poll(201'000, sample)) any = true;
  EXPECT_TRUE(any);
  EXPECT_EQ(sample.time_us, 200'000u);
  return {scaled(sample.gyro_raw, kGyroResolution),
          scaled(sample.accelerometer_raw, kAccelerometerResolution)};
}

// A link that turns about the world's origin by `angle_rad`, about z, its centre of mass `p_com_L` off its
// own origin.
BodyState turned(double angle_rad, double rate_rad_per_s, const Eigen::Vector3d& p_com_L) {
  BodyState state;
  state.X_WL.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  state.w_WL_W = Eigen::Vector3d(0.0, 0.0, rate_rad_per_s);
  state.v_WCom_W = state.w_WL_W.cross(state.X_WL.linear() * p_com_L);
  return state;
}

void expect_near(const Eigen::Vector3d& actual, const Eigen::Vector3d& expected, double tolerance) {
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), tolerance)
      << actual.transpose() << " instead of " << expected.transpose();
}

TEST(Imu, ReadsOneGUpwardsAtRest) {
  const Reading reading = read(clean_imu(), {}, [](double) { return BodyState{}; });
  expect_near(reading.accelerometer, -kGravity, 0.5 * kAccelerometerResolution);
  expect_near(reading.gyro, Eigen::Vector3d::Zero(), 0.0);
}

TEST(Imu, ReadsGravityInItsOwnAxes) {
  ImuDescription description = clean_imu();
  description.X_LS.linear() =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  BodyState pitched;
  pitched.X_WL.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Reading reading = read(description, {}, [&](double) { return pitched; });
  // Pitched forward, up is behind x of the link; the sensor's y is the link's z, its z the link's -y.
  const double g = kGravity_m_per_s2;
  expect_near(reading.accelerometer, {-g * std::sin(0.3), g * std::cos(0.3), 0.0},
              0.51 * kAccelerometerResolution);
}

TEST(Imu, ReadsZeroInFreeFall) {
  const Reading reading = read(clean_imu(), {}, [](double time_s) {
    BodyState state;
    state.v_WCom_W = kGravity * time_s;
    return state;
  });
  expect_near(reading.accelerometer, Eigen::Vector3d::Zero(), kAccelerometerResolution);
}

TEST(Imu, MeasuresCentripetalAcceleration) {
  constexpr double kRate = 10.0;
  constexpr double kRadius = 0.15;
  LinkDescription link;
  link.p_LCom_L = Eigen::Vector3d(0.02, -0.05, 0.01);
  ImuDescription description = clean_imu();
  description.X_LS.translation() = Eigen::Vector3d(kRadius, 0.0, 0.04);
  const Reading reading =
      read(description, link, [&](double time_s) { return turned(kRate * time_s, kRate, link.p_LCom_L); });
  expect_near(reading.gyro, {0.0, 0.0, kRate}, 0.51 * kGyroResolution);
  expect_near(reading.accelerometer, {-kRate * kRate * kRadius, 0.0, kGravity_m_per_s2},
              0.6 * kAccelerometerResolution);
}

TEST(Imu, MeasuresTangentialAcceleration) {
  constexpr double kAcceleration = 20.0;  // rad/s^2
  constexpr double kRadius = 0.2;
  ImuDescription description = clean_imu();
  description.X_LS.translation() = Eigen::Vector3d(0.0, kRadius, 0.0);
  const Reading reading = read(description, {}, [&](double time_s) {
    return turned(0.5 * kAcceleration * time_s * time_s, kAcceleration * time_s, Eigen::Vector3d::Zero());
  });
  // y is radial: its share is behind by the filter's lag (2.3 ms) and half a step, at 4 rad/s.
  const double rate = kAcceleration * (0.2 - 0.0005 - 1.0 / (std::numbers::sqrt2 * std::numbers::pi * 98.0));
  EXPECT_NEAR(reading.accelerometer.x(), -kAcceleration * kRadius, 0.01);
  EXPECT_NEAR(reading.accelerometer.y(), -rate * rate * kRadius, 0.01);
  EXPECT_NEAR(reading.gyro.z(),
              kAcceleration * 0.2 - kAcceleration / (std::numbers::sqrt2 * std::numbers::pi * 98.0),
              kGyroResolution);
}

TEST(Imu, GyroRespondsToGravityByItsGSensitivity) {
  constexpr double kSensitivity = 0.01;  // rad/s per m/s^2
  ImuDescription description = clean_imu();
  description.g_sensitivity = kSensitivity;
  const Eigen::Matrix3d expected = CrossSensitivity(kSensitivity, 1, "imu.gyro.g_sensitivity").value();
  const Eigen::Vector3d up(0.0, 0.0, kGravity_m_per_s2);
  const Eigen::Matrix3d turns[] = {Eigen::AngleAxisd(0.0, Eigen::Vector3d::UnitX()).toRotationMatrix(),
                                   Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX()).toRotationMatrix(),
                                   Eigen::AngleAxisd(2.5, Eigen::Vector3d(0.6, 0.8, 0.0)).toRotationMatrix()};
  for (const Eigen::Matrix3d& R_WL : turns) {
    BodyState state;
    state.X_WL.linear() = R_WL;
    const Reading reading = read(description, {}, [&](double) { return state; });
    const Eigen::Vector3d shown = expected * (R_WL.transpose() * up);
    EXPECT_GT(shown.norm(), 0.01);
    expect_near(reading.gyro, shown, 0.51 * kGyroResolution);
    expect_near(reading.accelerometer, R_WL.transpose() * up, 0.51 * kAccelerometerResolution);
  }
}

TEST(Imu, AddsTheGSensitivityToTheRate) {
  ImuDescription description = clean_imu();
  description.g_sensitivity = 0.01;
  const auto spin = [](double time_s) { return turned(3.0 * time_s, 3.0, Eigen::Vector3d::Zero()); };
  const auto rest = [](double) { return BodyState{}; };
  // About the vertical, so that gravity stays along the sensor's z.
  expect_near(read(description, {}, spin).gyro - read(description, {}, rest).gyro, {0.0, 0.0, 3.0},
              1.01 * kGyroResolution);
}

// The rate is given in the axes of the link, and the unit's are others.
TEST(Imu, AddsARateToThatOfTheLink) {
  ImuDescription description = clean_imu();
  description.X_LS.linear() =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto spin = [](double time_s) { return turned(3.0 * time_s, 3.0, Eigen::Vector3d::Zero()); };
  const Reading reading = read(description, {}, spin, {0.5, -0.25, 1.0});
  expect_near(reading.gyro, {-0.25, -0.5, 4.0}, 0.51 * kGyroResolution);
  expect_near(reading.accelerometer, read(description, {}, spin).accelerometer, 0.0);
}

TEST(Imu, CarriesTheLowBitsOfTime) {
  Imu imu(clean_imu(), {}, kGravity, {});
  const std::uint64_t start_us = (std::uint64_t{1} << 32) - 200;
  imu.step(BodyState{}, start_us);
  imu.step(BodyState{}, start_us + 1000);
  hal::ImuSample sample;
  ASSERT_TRUE(imu.poll(start_us + 3000, sample));
  const std::uint64_t instant_us = (start_us / 1000 + 1) * 1000;
  EXPECT_EQ(sample.time_us, static_cast<std::uint32_t>(instant_us));
  EXPECT_LT(sample.time_us, 1000u);
}

}  // namespace
}  // namespace koboshi::sim_board
