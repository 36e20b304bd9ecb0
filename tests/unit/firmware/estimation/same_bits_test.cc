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
    digest.add(static_cast<int>(state.com.sole));
    digest.add(state.com.valid);
    digest.add(state.com.position.x.raw());
    digest.add(state.com.position.y.raw());
    digest.add(state.com.height.raw());
    digest.add(state.com.velocity.x.raw());
    digest.add(state.com.velocity.y.raw());
    digest.add(state.com.dcm.x.raw());
    digest.add(state.com.dcm.y.raw());
  }
  EXPECT_TRUE(estimator.state().gyro_known);
  EXPECT_EQ(digest.value(), 0xB8E7'090E'0A6A'C43Du);
}

// Every other field of the state, and every other way to it: feet of each kind, an inertial unit in the head,
// a walk with its plan, and times in which the robot stands still.
std::uint64_t digest_of_estimates(hal::AnkleKind kind, bool unit_in_head) {
  robot::RobotModel model;
  if (load_model(test::encode(test::make_test_robot()), model) != robot::ModelStatus::kOk) return 0;
  model.ankle_kind = kind;
  if (unit_in_head) model.imu_link = robot::LinkIndex(robot::JointIndex(test::kHeadTilt));
  for (robot::Foot& foot : model.feet) {
    const auto cell = [](std::int32_t x_mm, std::int32_t y_mm) {
      return robot::Cell{fixed::Length::from_raw(x_mm * 16'777), fixed::Length::from_raw(y_mm * 16'777)};
    };
    foot.cells = {cell(50, 20), cell(60, -20), cell(-30, 25), cell(-35, -20)};
  }
  Estimator estimator(model);
  std::array<fixed::Angle, robot::kMaxJoints> angles{};
  std::array<std::int16_t, robot::kMaxJoints> torques{};
  test::Digest digest;
  std::mt19937 random(4'301);
  std::uint64_t now_us = 0;
  const auto noise = [&random](std::int32_t most) {
    return static_cast<std::int16_t>(
        static_cast<std::int32_t>(random() % (2 * static_cast<std::uint32_t>(most) + 1)) - most);
  };
  LegEvidence legs{.torques_permille = torques};
  std::array<std::int32_t, robot::kMaxJoints> speeds_raw{};
  int touchdowns = 0;
  for (int cycle = 0; cycle < 500; ++cycle) {
    const bool rests = cycle < 150;
    const std::int16_t most = rests ? 3 : 1'000;
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
      const bool lifted = cycle / 20 % 3 == (side == hal::Side::kLeft ? 1 : 2);
      hal::AnkleSample sample;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sample.force_raw[axis] = static_cast<std::int16_t>(lifted ? 0 : 2'500 + noise(2'500));
        sample.torque_raw[axis] = static_cast<std::int16_t>(lifted ? 0 : noise(800));
      }
      if (cycle % 7 != 0) estimator.add(side, sample, now_us);
    }
    // Joints that swing about zero, faster in their turn.
    for (std::size_t joint = 0; joint < model.joint_count; ++joint) {
      speeds_raw[joint] += noise(2'000) * 512 - angles[joint].raw() / 64;
      angles[joint] = angles[joint] + fixed::Angle::from_raw(speeds_raw[joint]);
      torques[joint] = static_cast<std::int16_t>(noise(500) * (cycle / 30 % 2 == 0 ? 1 : joint < 6 ? 2 : 0));
    }
    legs.walks = cycle / 100 == 2;
    legs.swing.reset();
    if (legs.walks && cycle / 10 % 3 != 0)
      legs.swing = cycle / 10 % 3 == 1 ? hal::Side::kLeft : hal::Side::kRight;
    legs.reference.reset();
    if (legs.walks) legs.reference = cycle / 15 % 2 == 0 ? hal::Side::kLeft : hal::Side::kRight;
    legs.stands_still = cycle / 50 % 4 == 3;
    const RobotState& state =
        estimator.update(std::span(angles).first(model.joint_count), rests, now_us, legs);
    for (const std::int64_t number : {std::int64_t{state.up_B.x.raw()},
                                      std::int64_t{state.up_B.y.raw()},
                                      std::int64_t{state.up_B.z.raw()},
                                      std::int64_t{state.roll.raw()},
                                      std::int64_t{state.pitch.raw()},
                                      std::int64_t{state.rates_B.x.raw()},
                                      std::int64_t{state.rates_B.y.raw()},
                                      std::int64_t{state.rates_B.z.raw()},
                                      std::int64_t{state.accelerations_B.x.raw()},
                                      std::int64_t{state.accelerations_B.y.raw()},
                                      std::int64_t{state.accelerations_B.z.raw()},
                                      std::int64_t{state.measures_loads},
                                      std::int64_t{state.zmp.valid},
                                      std::int64_t{static_cast<int>(state.zmp.frame)},
                                      std::int64_t{state.zmp.x.raw()},
                                      std::int64_t{state.zmp.y.raw()},
                                      std::int64_t{state.com.valid},
                                      std::int64_t{static_cast<int>(state.com.sole)},
                                      std::int64_t{state.com.position.x.raw()},
                                      std::int64_t{state.com.position.y.raw()},
                                      std::int64_t{state.com.velocity.x.raw()},
                                      std::int64_t{state.com.velocity.y.raw()},
                                      std::int64_t{state.com.dcm.x.raw()},
                                      std::int64_t{state.com.dcm.y.raw()},
                                      std::int64_t{state.odometer.x.raw()},
                                      std::int64_t{state.odometer.y.raw()},
                                      std::int64_t{state.odometer.heading.raw()},
                                      std::int64_t{state.ground.valid},
                                      std::int64_t{state.ground.slope_x.raw()},
                                      std::int64_t{state.ground.slope_y.raw()},
                                      std::int64_t{state.ground.zero_x.raw()},
                                      std::int64_t{state.ground.zero_y.raw()}})
      digest.add(number);
    for (const std::size_t side : {0u, 1u}) {
      touchdowns += state.contacts[side].touches && state.contacts[side].since_us < 10'000 ? 1 : 0;
      digest.add(state.feet[side].valid);
      digest.add(state.feet[side].contact);
      digest.add(state.feet[side].load.raw());
      digest.add(state.feet[side].x.raw());
      digest.add(state.feet[side].y.raw());
      digest.add(state.ankle_age_us[side]);
      digest.add(state.contacts[side].touches);
      digest.add(state.contacts[side].since_us);
    }
  }
  const RobotState& state = estimator.state();
  EXPECT_EQ(state.ground.valid, model.measures_loads());
  EXPECT_NE(state.odometer.x, fixed::Length());
  EXPECT_NE(state.odometer.heading, fixed::Angle());
  EXPECT_GT(touchdowns, 1);
  return digest.value();
}

TEST(SameBits, OfEstimatesWithEachKindOfFoot) {
  EXPECT_EQ(digest_of_estimates(hal::AnkleKind::kSixAxis, false), 0xB345'0DBF'D3CD'88D4u);
  EXPECT_EQ(digest_of_estimates(hal::AnkleKind::kPressureCells, false), 0xD624'190C'BE0A'63EFu);
  EXPECT_EQ(digest_of_estimates(hal::AnkleKind::kContactSwitch, false), 0x6EF3'07C8'D3C8'8D83u);
  EXPECT_EQ(digest_of_estimates(hal::AnkleKind::kNone, false), 0x2489'8FE2'751E'E68Cu);
}

TEST(SameBits, OfEstimatesWithAnInertialUnitInTheHead) {
  EXPECT_EQ(digest_of_estimates(hal::AnkleKind::kSixAxis, true), 0xF27E'F925'A624'A999u);
}

}  // namespace
}  // namespace koboshi::estimation
