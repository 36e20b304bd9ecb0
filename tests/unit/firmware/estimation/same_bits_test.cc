// An estimate that must have the same bits everywhere (tests/unit/firmware/fixed/digest.h).

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>

#include "firmware/estimation/estimator.h"
#include "tests/unit/firmware/fixed/digest.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

// Rests for two seconds, in which the gyro's bias is measured, and then moves with loads on both feet.
TEST(SameBits, OfAnEstimate) {
  robot::RobotModel model;
  ASSERT_EQ(load_model(test::encode(test::make_test_robot()), model), robot::ModelStatus::kOk);
  model.R_BI.rows = {robot::kAxisY, -robot::kAxisX, robot::kAxisZ};
  Estimator estimator(model);
  std::array<fixed::Angle, robot::kMaxJoints> angles{};
  test::Digest digest;
  std::mt19937 random(3);
  std::uint64_t now_us = 0;
  const auto noise = [&random](std::int32_t most) {
    return static_cast<std::int16_t>(
        static_cast<std::int32_t>(random() % (2 * static_cast<std::uint32_t>(most) + 1)) - most);
  };
  for (int cycle = 0; cycle < 600; ++cycle) {
    const bool rests = cycle < 250;
    const std::int16_t most = rests ? 3 : 3'000;
    for (int i = 0; i < 10; ++i) {
      now_us += 1'000;
      hal::ImuSample sample;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sample.gyro_raw[axis] = static_cast<std::int16_t>(20 + noise(most));
        sample.accelerometer_raw[axis] = static_cast<std::int16_t>((axis == 2 ? 8'000 : 500) + noise(most));
      }
      estimator.add(sample, now_us);
    }
    for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
      hal::AnkleSample sample;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sample.force_raw[axis] = static_cast<std::int16_t>((axis == 2 ? 4'000 : 0) + noise(3'000));
        sample.torque_raw[axis] = noise(2'000);
      }
      if (cycle % 7 != 0) estimator.add(side, sample, now_us);
    }
    for (std::size_t joint = 0; joint < model.joint_count; ++joint)
      angles[joint] = fixed::Angle::from_raw(noise(20'000) * (1 << 13));
    const RobotState& state = estimator.update(std::span(angles).first(model.joint_count), rests, now_us);
    digest.add(state.up_B.x.raw());
    digest.add(state.up_B.y.raw());
    digest.add(state.up_B.z.raw());
    digest.add(state.roll.raw());
    digest.add(state.pitch.raw());
    digest.add(state.rates_B.x.raw());
    digest.add(state.rates_B.y.raw());
    digest.add(state.rates_B.z.raw());
    digest.add(state.accelerations_B.x.raw());
    digest.add(state.accelerations_B.y.raw());
    digest.add(state.accelerations_B.z.raw());
    digest.add(state.gyro_known);
    digest.add(state.inertial_age_us);
    for (const std::size_t side : {0u, 1u}) {
      digest.add(state.feet[side].valid);
      digest.add(state.feet[side].load.raw());
      digest.add(state.feet[side].x.raw());
      digest.add(state.feet[side].y.raw());
      digest.add(state.ankle_age_us[side]);
    }
    digest.add(static_cast<int>(state.zmp.frame));
    digest.add(state.zmp.valid);
    digest.add(state.zmp.x.raw());
    digest.add(state.zmp.y.raw());
    digest.add(state.centre_of_mass.x.raw());
    digest.add(state.centre_of_mass.y.raw());
    digest.add(state.centre_of_mass.z.raw());
  }
  EXPECT_TRUE(estimator.state().gyro_known);
  EXPECT_EQ(digest.value(), 0xA70F'2FD8'1E07'8EABu);
}

}  // namespace
}  // namespace koboshi::estimation
