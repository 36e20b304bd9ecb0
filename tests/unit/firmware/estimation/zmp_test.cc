#include "firmware/estimation/zmp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/robot/kinematics.h"
#include "tests/unit/firmware/estimation/random_posture.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::estimation {
namespace {

using test::kGravity;

using fixed::to_double;
using test::Point;
using test::RandomPosture;

constexpr double kSameComputation_m = 0.1e-3;

using Counts = std::array<std::int16_t, 6>;

struct Reference {
  double load_N = 0.0;
  double x_m = 0.0;
  double y_m = 0.0;
};

// Wrench of the ground in double, with the foot as a free body that is level and at rest.
Reference reference(const robot::RobotModel& model, hal::Side side, const Counts& counts) {
  const robot::Foot& geometry = model.feet[static_cast<std::size_t>(side)];
  const robot::Joint& foot = model.joints[model.leg(side)[5]];
  const double force = to_double(model.scales.ankle_force) / 32768;
  const double torque = to_double(model.scales.ankle_torque) / 32768;
  const Point sensor = test::to_point(geometry.sensor);
  const Point com = test::to_point(foot.centre_of_mass) + Point{0, 0, to_double(geometry.ankle_height)};
  const Point weight{0, 0, -to_double(foot.mass) * kGravity};
  const Point f = Point{counts[0] * force, counts[1] * force, counts[2] * force} - weight;
  const Point tau =
      Point{counts[3] * torque, counts[4] * torque, counts[5] * torque} - cross(com - sensor, weight);
  return {f.z, sensor.x + (-tau.y - f.x * sensor.z) / f.z, sensor.y + (tau.x - f.y * sensor.z) / f.z};
}

class ZmpTest : public testing::Test {
 protected:
  // Returns a wrench typical of walking: up to 30 N, with the ZMP on the foot or somewhat outside it.
  Counts draw() {
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution(low, high)(robot.random);
    };
    const double load_N = std::exp(uniform(std::log(0.2), std::log(30.0)));
    const auto force = [&](double newton) {
      return count(newton / to_double(robot.model.scales.ankle_force));
    };
    const auto torque = [&](double Nm) { return count(Nm / to_double(robot.model.scales.ankle_torque)); };
    return {
        force(uniform(-0.6, 0.6) * load_N),    force(uniform(-0.6, 0.6) * load_N),  force(load_N),
        torque(uniform(-0.06, 0.06) * load_N), torque(uniform(-0.1, 0.1) * load_N), torque(uniform(-1, 1))};
  }
  static std::int16_t count(double share) { return static_cast<std::int16_t>(std::lround(share * 32768)); }
  FootPressure pressure(hal::Side side, const Counts& counts) const {
    return FootSensor(robot.model, side).pressure(counts);
  }

  RandomPosture robot;
};

TEST_F(ZmpTest, OfAFootAgreesWithDoublePrecision) {
  double worst_m = 0.0;
  int valid = 0;
  for (int round = 0; round < 100'000; ++round) {
    const hal::Side side = round % 2 == 0 ? hal::Side::kLeft : hal::Side::kRight;
    const Counts counts = draw();
    const FootPressure foot = pressure(side, counts);
    const Reference expected = reference(robot.model, side, counts);
    EXPECT_NEAR(to_double(foot.load), expected.load_N, 3e-5);
    if (!foot.valid) {
      EXPECT_LT(expected.load_N, 1.0 + 3e-5);
      continue;
    }
    ++valid;
    worst_m =
        std::max(worst_m, std::hypot(to_double(foot.x) - expected.x_m, to_double(foot.y) - expected.y_m));
  }
  EXPECT_GT(valid, 50'000);
  EXPECT_LE(worst_m, kSameComputation_m);
  EXPECT_GT(worst_m, 1e-8);
  RecordProperty("worst_um", std::to_string(1e6 * worst_m));
}

TEST_F(ZmpTest, OfBothFeetAgreesWithDoublePrecision) {
  double worst_m = 0.0;
  for (int round = 0; round < 5'000; ++round) {
    robot.draw();
    const std::array<Counts, 2> counts{draw(), draw()};
    const hal::BySide<FootPressure> feet{pressure(hal::Side::kLeft, counts[0]),
                                         pressure(hal::Side::kRight, counts[1])};
    if (!feet[0].valid || !feet[1].valid) continue;
    const Pressure both = combine(feet, robot.posture);
    ASSERT_TRUE(both.valid);

    const std::array expected{reference(robot.model, hal::Side::kLeft, counts[0]),
                              reference(robot.model, hal::Side::kRight, counts[1])};
    ASSERT_EQ(both.frame == hal::Side::kRight, expected[1].load_N > expected[0].load_N);
    Point sum;
    for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
      const Reference& foot = expected[static_cast<std::size_t>(side)];
      const Point p_B = robot.from_sole(side, {foot.x_m, foot.y_m, 0});
      sum = sum + (foot.load_N / (expected[0].load_N + expected[1].load_N)) * robot.to_sole(both.frame, p_B);
    }
    worst_m = std::max(worst_m, std::hypot(to_double(both.x) - sum.x, to_double(both.y) - sum.y));
  }
  EXPECT_LE(worst_m, kSameComputation_m);
  EXPECT_GT(worst_m, 1e-8);
  RecordProperty("worst_um", std::to_string(1e6 * worst_m));
}

// 5.9 N act on the sole 20 mm in front of and 10 mm to the left of the point below the sensor, with a forward
// friction force.
TEST_F(ZmpTest, HasTheSignsOfThePaper) {
  const robot::Joint& foot = robot.model.joints[robot.model.leg(hal::Side::kLeft)[5]];
  const double load_N = 5.9;
  const double drag_N = 1.2;
  const double weight_N = to_double(foot.mass) * kGravity;
  const double d_m = to_double(robot.model.feet[0].sensor.z);
  const Point p{0.02, 0.01, -d_m};  // relative to the sensor
  const Point com =
      test::to_point(foot.centre_of_mass) + Point{0, 0, to_double(robot.model.feet[0].ankle_height) - d_m};
  const Point f = Point{drag_N, 0, load_N} - Point{0, 0, weight_N};
  const Point tau = cross(p, {drag_N, 0, load_N}) - cross(com, {0, 0, weight_N});
  const auto force = [&](double newton) { return count(newton / to_double(robot.model.scales.ankle_force)); };
  const auto torque = [&](double Nm) { return count(Nm / to_double(robot.model.scales.ankle_torque)); };
  const FootPressure zmp = pressure(
      hal::Side::kLeft, {force(f.x), force(f.y), force(f.z), torque(tau.x), torque(tau.y), torque(tau.z)});
  ASSERT_TRUE(zmp.valid);
  EXPECT_NEAR(to_double(zmp.load), load_N, 3e-3);
  EXPECT_NEAR(to_double(zmp.x), 0.02, 1e-4);  // resolution of the counts
  EXPECT_NEAR(to_double(zmp.y), 0.01, 1e-4);
}

TEST_F(ZmpTest, IsInvalidBelowTheMinimumLoad) {
  const double weight_N = to_double(robot.model.joints[robot.model.leg(hal::Side::kLeft)[5]].mass) * kGravity;
  const auto at_load = [&](double load_N) {
    const std::int16_t z = count((load_N - weight_N) / to_double(robot.model.scales.ankle_force));
    return pressure(hal::Side::kLeft, {0, 0, z, 100, 100, 100});
  };
  const double min_load_N = to_double(robot::total_mass(robot.model)) * kGravity / 12.0;
  EXPECT_FALSE(at_load(0.99 * min_load_N).valid);
  EXPECT_TRUE(at_load(1.01 * min_load_N).valid);
  EXPECT_FALSE(at_load(-5.0).valid);
}

TEST_F(ZmpTest, OfBothFeetIsThatOfTheLoadedOne) {
  robot.draw();
  const FootPressure none{.load = {}, .valid = false, .x = {}, .y = {}};
  FootPressure some = none;
  some.load = fixed::from_double<fixed::Force>(6.0);
  some.valid = true;
  some.x = fixed::from_double<fixed::Length>(0.03);
  const Pressure left = combine({some, none}, robot.posture);
  EXPECT_TRUE(left.valid);
  EXPECT_EQ(left.frame, hal::Side::kLeft);
  EXPECT_EQ(left.x, some.x);
  const Pressure right = combine({none, some}, robot.posture);
  EXPECT_EQ(right.frame, hal::Side::kRight);
  EXPECT_EQ(right.x, some.x);
  EXPECT_FALSE(combine({none, none}, robot.posture).valid);
}

}  // namespace
}  // namespace koboshi::estimation
