// Feet with pressure cells, with contact switches, and without sensors.

#include <gtest/gtest.h>

#include <random>

#include "firmware/estimation/estimator.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/robot/abilities.h"
#include "firmware/robot/kinematics.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using fixed::from_double;
using fixed::to_double;
using hal::AnkleKind;
using hal::Side;

constexpr double kCellScale_N = 40.0;

robot::RobotModel robot_with(AnkleKind kind) {
  robot::RobotModel model = test::make_test_robot();
  model.ankle_kind = kind;
  if (kind == AnkleKind::kPressureCells) {
    model.scales.ankle_force = from_double<fixed::Force>(4 * kCellScale_N);
    model.scales.ankle_torque = from_double<fixed::Torque>(4 * kCellScale_N * 0.06);
    for (robot::Foot& foot : model.feet) {
      const auto cell = [](double x, double y) {
        return robot::Cell{from_double<fixed::Length>(x), from_double<fixed::Length>(y)};
      };
      foot.cells = {cell(0.05, 0.02), cell(0.06, -0.02), cell(-0.03, 0.025), cell(-0.035, -0.02)};
    }
  }
  return model;
}

// The centre of pressure and the load in double precision.
TEST(PressureCells, AreTheirSumAndTheirMean) {
  const robot::RobotModel model = robot_with(AnkleKind::kPressureCells);
  const FootSensor sensor(model, Side::kLeft);
  std::mt19937 random(45);
  for (int trial = 0; trial < 2'000; ++trial) {
    std::array<int, 4> cells{};
    double load_N = 0.0;
    double x = 0.0;
    double y = 0.0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i] = std::uniform_int_distribution(0, 10'000)(random);
      const double force_N = kCellScale_N * cells[i] / 32768;
      load_N += force_N;
      x += force_N * to_double(model.feet[0].cells[i].x);
      y += force_N * to_double(model.feet[0].cells[i].y);
    }
    const auto raw = [&](std::size_t i) { return static_cast<std::int16_t>(cells[i]); };
    const FootPressure foot =
        sensor.pressure(sensor.wrench({.force_raw = {raw(0), raw(1), raw(2)}, .torque_raw = {raw(3), 0, 0}}));
    EXPECT_NEAR(to_double(foot.load), load_N, 0.003);
    ASSERT_EQ(foot.contact, foot.valid);
    if (!foot.valid) continue;
    EXPECT_NEAR(to_double(foot.x), x / load_N, 0.003 / load_N);
    EXPECT_NEAR(to_double(foot.y), y / load_N, 0.003 / load_N);
  }
}

TEST(PressureCells, HaveNoCountOfAnyOtherKind) {
  for (const AnkleKind kind : {AnkleKind::kContactSwitch, AnkleKind::kNone}) {
    const robot::RobotModel model = robot_with(kind);
    for (const std::int16_t count : FootSensor(model, Side::kLeft).wrench({.force_raw = {1, 2, 3}}))
      EXPECT_EQ(count, FootSensor::kNoCount);
  }
}

class SensorlessFeet : public testing::Test {
 protected:
  const RobotState& update(Estimator& estimator, int cycles = 1) {
    const std::array<fixed::Angle, robot::kMaxJoints> angles{};
    for (int i = 0; i < cycles; ++i)
      estimator.update({angles.data(), model_.joint_count}, false, now_us_ += 10'000,
                       {.torques_permille = torques_, .walks = walks_, .swing = swing_});
    return estimator.state();
  }
  // Sets the torque of one joint of each leg.
  void set_torques(int left, int right) {
    torques_[model_.leg(Side::kLeft)[3]] = static_cast<std::int16_t>(left);
    torques_[model_.leg(Side::kRight)[3]] = static_cast<std::int16_t>(right);
  }

  robot::RobotModel model_ = robot_with(AnkleKind::kNone);
  std::array<std::int16_t, robot::kMaxJoints> torques_{};
  std::uint64_t now_us_ = 0;
  bool walks_ = false;
  std::optional<Side> swing_;
};

TEST_F(SensorlessFeet, AreInContactUntilTheTorquesTellOtherwise) {
  Estimator estimator(model_);
  const double weight_N = to_double(robot::total_mass(model_)) * 9.80665;
  const RobotState& state = update(estimator);
  EXPECT_EQ(state.ankle_age_us, (hal::BySide<std::uint32_t>{0, 0}));
  EXPECT_TRUE(state.feet[0].contact && state.feet[1].contact);
  EXPECT_NEAR(to_double(state.feet[0].load), weight_N / 2, 1e-3);
  EXPECT_FALSE(state.measures_loads);
  set_torques(-900, 100);
  update(estimator, 40);
  EXPECT_TRUE(state.feet[0].contact);
  EXPECT_FALSE(state.feet[1].contact);
  EXPECT_NEAR(to_double(state.feet[0].load), weight_N, 1e-3);
  EXPECT_EQ(state.feet[1].load, fixed::Force());
  EXPECT_EQ(state.zmp.frame, Side::kLeft);
  EXPECT_FALSE(state.zmp.valid || state.feet[0].valid || state.feet[1].valid);
  // The hysteresis: a share of 0.3 does not regain contact, one of 0.4 does.
  set_torques(700, -300);
  EXPECT_FALSE(update(estimator, 40).feet[1].contact);
  set_torques(600, -400);
  EXPECT_TRUE(update(estimator, 40).feet[1].contact);
}

// The torques of a swing tell nothing: the plan does.
TEST_F(SensorlessFeet, FollowThePlanOfAWalk) {
  Estimator estimator(model_);
  update(estimator);
  set_torques(100, 900);
  walks_ = true;
  swing_ = Side::kRight;
  EXPECT_FALSE(update(estimator).feet[1].contact);
  swing_.reset();
  EXPECT_TRUE(update(estimator).feet[1].contact);
  EXPECT_TRUE(estimator.state().feet[0].contact);
}

TEST_F(SensorlessFeet, OfASwitchFollowIt) {
  model_ = robot_with(AnkleKind::kContactSwitch);
  Estimator estimator(model_);
  EXPECT_EQ(update(estimator).ankle_age_us[0], RobotState::kNever);
  estimator.add(Side::kRight, {.force_raw = {0, 0, 1}}, now_us_);
  EXPECT_FALSE(update(estimator).feet[0].contact);
  EXPECT_TRUE(estimator.state().feet[1].contact);
  EXPECT_FALSE(estimator.state().zmp.valid);
  EXPECT_EQ(estimator.state().zmp.frame, Side::kRight);
}

TEST(Abilities, AreLostWithSensorsAndJoints) {
  using enum robot::Ability;
  const auto bits = [](std::initializer_list<robot::Ability> abilities) {
    unsigned mask = 0;
    for (const robot::Ability ability : abilities) mask |= 1u << static_cast<unsigned>(ability);
    return mask;
  };
  EXPECT_EQ(robot::lost_abilities(robot_with(AnkleKind::kSixAxis)), 0u);
  EXPECT_EQ(robot::lost_abilities(robot_with(AnkleKind::kPressureCells)), 0u);
  EXPECT_EQ(robot::lost_abilities(robot_with(AnkleKind::kContactSwitch)), bits({kZmp, kFootLoads}));
  EXPECT_EQ(robot::lost_abilities(robot_with(AnkleKind::kNone)),
            bits({kZmp, kFootLoads, kContactSensing, kEarlyTouchdown}));
  robot::RobotModel model = robot_with(AnkleKind::kSixAxis);
  model.joints[model.find(robot::JointRole::kLeftKnee).value()].role = robot::JointRole::kOther;
  EXPECT_EQ(robot::lost_abilities(model), bits({kEarlyTouchdown, kWalking, kTurning, kArmSwing}));
}

}  // namespace
}  // namespace koboshi::estimation
