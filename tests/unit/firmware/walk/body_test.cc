#include "firmware/walk/body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "firmware/fixed/radians.h"
#include "tests/unit/firmware/robot/random_leg.h"
#include "tests/unit/firmware/walk/posed.h"

namespace koboshi::walk {
namespace {

using fixed::Angle;
using fixed::from_double;
using fixed::Length;
using fixed::Ratio;
using fixed::to_double;
using hal::Side;
using test::Posed;

constexpr std::array kSides{Side::kLeft, Side::kRight};
constexpr test::Point kUp{0, 0, 1};
constexpr test::Point kAhead{1, 0, 0};

class BodyTest : public testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random); }
  Length length(double low_m, double high_m) { return from_double<Length>(uniform(low_m, high_m)); }

  // Returns a random stance typical of walking, at a height that both legs reach.
  Stance draw() {
    Stance stance;
    stance.yaw = from_double<Angle>(uniform(-3.0, 3.0));
    const Point middle{length(-0.2, 0.2), length(-0.2, 0.2)};
    for (const Side side : kSides) {
      const auto i = static_cast<std::size_t>(side);
      const double out = side == Side::kLeft ? 1.0 : -1.0;
      const Point from_middle{length(-0.03, 0.03), from_double<Length>(out * uniform(0.026, 0.05))};
      stance.soles[i] = {.p = middle + turned(from_middle, stance.yaw),
                         .yaw = stance.yaw + from_double<Angle>(uniform(-0.3, 0.3))};
    }
    stance.heights[uniform(0, 1) < 0.5 ? 0 : 1] = length(0.0, 0.03);
    const Point com = middle + turned({length(-0.02, 0.03), length(-0.03, 0.03)}, stance.yaw);
    stance.centre_of_mass = {com.x, com.y, length(0.159, 0.162)};
    stance.pitch = from_double<Angle>(uniform(-0.05, 0.2));
    stance.load_shares = {fixed::kOne / 2, fixed::kOne / 2};
    return stance;
  }
  // Returns a stance of a straight walk at the default height.
  Stance draw_straight() {
    Stance stance;
    const double ahead = uniform(-1, 1);  // position of the swing foot; it is highest next to the support
                                          // foot
    stance.soles = {
        Foothold{.p = {from_double<Length>(0.02 * ahead), from_double<Length>(0.033)}, .yaw = {}},
        Foothold{.p = {from_double<Length>(-0.02 * ahead), from_double<Length>(-0.033)}, .yaw = {}}};
    stance.heights[uniform(0, 1) < 0.5 ? 0 : 1] = from_double<Length>(0.02 * (1 - ahead * ahead));
    stance.centre_of_mass = {length(-0.01, 0.01), length(-0.015, 0.015), length(0.167, 0.17)};
    stance.pitch = from_double<Angle>(0.05);
    return stance;
  }
  std::array<Angle, robot::kMaxJoints> solve(const Stance& stance, const Compliance& compliance = {}) const {
    std::array<Angle, robot::kMaxJoints> targets{};
    Body(model).solve(stance, compliance, targets);
    return targets;
  }

  robot::RobotModel model = test::load_test_robot();
  std::mt19937 random{20081};
};

// One motor turns both hip yaws: the feet of a turning walk have the planned heading relative to each other,
// and their planned places in the trunk's frame.
TEST_F(BodyTest, TurnsTheFeetAgainstEachOtherByOneMotor) {
  model.joints[0].axis = {from_double<Ratio>(0.0), from_double<Ratio>(-std::sqrt(0.5)),
                          from_double<Ratio>(std::sqrt(0.5))};
  model.joints[6].axis = {from_double<Ratio>(0.0), from_double<Ratio>(std::sqrt(0.5)),
                          from_double<Ratio>(std::sqrt(0.5))};
  robot::RobotModel shared;
  ASSERT_EQ(robot::load_model(test::encode(test::with_shared_yaw(model, -1.0)), shared),
            robot::ModelStatus::kOk);
  EXPECT_TRUE(robot::can_turn(shared));
  Body body(shared);
  ASSERT_TRUE(body.has_legs() && body.max_turn());
  EXPECT_NEAR(to_double(*body.max_turn()), 60.0 * test::kRadPerDegree,
              1e-6);  // 1.41 times 90 degrees, clamped
  body.begin_in_parts();
  std::array<Angle, robot::kMaxJoints> targets{};
  double worst_rad = 0.0;
  double largest_rad = 0.0;
  constexpr int kCycles = 200;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    // The feet turn by up to 20 degrees to either side in 0.5 s.
    const double apart_rad = 20.0 * test::kRadPerDegree * std::sin(2.0 * std::numbers::pi * cycle / 100.0);
    Stance stance;
    stance.soles = {
        Foothold{.p = {{}, from_double<Length>(0.033)}, .yaw = from_double<Angle>(0.5 * apart_rad)},
        Foothold{.p = {{}, from_double<Length>(-0.033)}, .yaw = from_double<Angle>(-0.5 * apart_rad)}};
    stance.centre_of_mass = {{}, {}, from_double<Length>(0.160)};
    stance.heights[cycle / 50 % 2 == 0 ? 0 : 1] = from_double<Length>(0.01);
    body.solve(stance, {}, targets);
    if (!body.is_complete() || cycle < 20) continue;
    const Posed posed(shared, targets);
    const double found_rad = test::yaw_rad(posed.sole_axis(Side::kLeft, kAhead, Side::kRight));
    worst_rad = std::max(worst_rad, std::abs(found_rad - apart_rad));
    largest_rad = std::max(largest_rad, std::abs(found_rad));
  }
  EXPECT_LT(worst_rad, 0.2 * test::kRadPerDegree);
  EXPECT_GT(largest_rad, 19.0 * test::kRadPerDegree);
}

// Equal axes at a ratio of 1 turn both feet to the same side, which turns no robot.
TEST_F(BodyTest, KnowsAMotorThatDoesNotTurnTheFeetAgainstEachOther) {
  robot::RobotModel shared;
  ASSERT_EQ(robot::load_model(test::encode(test::with_shared_yaw(model, 1.0)), shared),
            robot::ModelStatus::kOk);
  EXPECT_FALSE(robot::can_turn(shared));
  EXPECT_EQ(Body(shared).max_turn(), Angle());
  ASSERT_EQ(robot::load_model(test::encode(test::with_shared_yaw(model, -1.0)), shared),
            robot::ModelStatus::kOk);
  EXPECT_TRUE(robot::can_turn(shared));
}

// The requested centre of mass relative to the sole `from`.
test::Point asked(const Stance& stance, Side from, Point p, Length height) {
  const auto i = static_cast<std::size_t>(from);
  const Foothold& sole = stance.soles[i];
  const double yaw = to_double(sole.yaw);
  const double x = to_double(p.x - sole.p.x);
  const double y = to_double(p.y - sole.p.y);
  return {x * std::cos(yaw) + y * std::sin(yaw), y * std::cos(yaw) - x * std::sin(yaw),
          to_double(height - stance.heights[i])};
}

// The largest errors of a sole in the frame of the other one: of its place, and of its axes.
struct SoleErrors {
  double worst_m = 0.0;
  double worst_axis = 0.0;

  void take(const Stance& stance, const Posed& posed) {
    for (const Side from : kSides) {
      const Side side = other(from);
      const auto i = static_cast<std::size_t>(side);
      const test::Point expected = asked(stance, from, stance.soles[i].p, stance.heights[i]);
      worst_m = std::max(worst_m, norm(posed.sole(side, from) - expected));
      const double yaw = to_double(stance.soles[i].yaw - stance.soles[static_cast<std::size_t>(from)].yaw);
      const test::Point ahead{std::cos(yaw), std::sin(yaw), 0};
      worst_axis = std::max({worst_axis, norm(posed.sole_axis(side, kUp, from) - kUp),
                             norm(posed.sole_axis(side, kAhead, from) - ahead)});
    }
  }
};

TEST_F(BodyTest, PutsTheSolesAtTheirTargets) {
  SoleErrors errors;
  for (int round = 0; round < 2'000; ++round) {
    const Stance stance = draw();
    errors.take(stance, Posed(model, solve(stance)));
  }
  EXPECT_LT(errors.worst_m, 3e-6);
  EXPECT_GT(errors.worst_m, 1e-8);
  EXPECT_LT(errors.worst_axis, 1e-5);
}

// Hips of the order roll, yaw, pitch with axes 9 and 13 mm apart, ankles of the order roll, pitch with 7 mm.
TEST_F(BodyTest, PutsTheSolesOfLegsWithoutClosedFormAtTheirTargets) {
  test::LegPlan plan;
  plan.hip = {robot::kHipRoll, robot::kHipYaw, robot::kHipPitch};
  plan.ankle = {robot::kAnkleRoll, robot::kAnklePitch};
  plan.offsets[1] = {0.008, 0.004, 0.0};
  plan.offsets[2] = {-0.01, 0.0, -0.008};
  plan.offsets[5] = {0.004, 0.003, -0.005};
  ASSERT_EQ(robot::load_model(test::encode(test::make_robot_with(plan)), model), robot::ModelStatus::kOk);
  SoleErrors errors;
  for (int round = 0; round < 300; ++round) {
    const Stance stance = draw_straight();
    errors.take(stance, Posed(model, solve(stance)));
  }
  EXPECT_LT(errors.worst_m, 3e-6);
  EXPECT_GT(errors.worst_m, 1e-8);
  EXPECT_LT(errors.worst_axis, 2e-5);
}

TEST_F(BodyTest, TurnsAndLeansTheTrunk) {
  double worst = 0.0;
  for (int round = 0; round < 2'000; ++round) {
    const Stance stance = draw();
    const double yaw = to_double(stance.yaw - stance.soles[0].yaw);
    const double pitch = to_double(stance.pitch);
    const test::Point up = Posed(model, solve(stance)).trunk_axis(kUp, Side::kLeft);
    const test::Point expected{std::sin(pitch) * std::cos(yaw), std::sin(pitch) * std::sin(yaw),
                               std::cos(pitch)};
    worst = std::max(worst, norm(up - expected));
  }
  EXPECT_LT(worst, 1e-5);
}

// The solver assumes that the knees are on the line from hip to ankle. At one walking height this gives a
// constant forward offset of the mass, which a parameter compensates; the rest is within two millimetres.
TEST_F(BodyTest, PutsTheCentreOfMassWithinTwoMillimetresOfAConstant) {
  std::vector<test::Point> errors;
  test::Point mean;
  for (int round = 0; round < 2'000; ++round) {
    const Stance stance = draw_straight();
    const auto& com = stance.centre_of_mass;
    const test::Point expected = asked(stance, Side::kLeft, {com.x, com.y}, com.z);
    errors.push_back(Posed(model, solve(stance)).com(Side::kLeft) - expected);
    mean = mean + 1.0 / 2'000 * errors.back();
  }
  double worst_m = 0.0;
  for (const test::Point& error : errors) worst_m = std::max(worst_m, norm(error - mean));
  EXPECT_LT(worst_m, 2e-3);
  EXPECT_GT(worst_m, 1e-4);
  EXPECT_NEAR(mean.x, 3e-3, 1e-3);
  EXPECT_NEAR(mean.y, 0.0, 0.2e-3);
  EXPECT_NEAR(mean.z, 0.5e-3, 1e-3);
}

TEST_F(BodyTest, DoesNotMoveArmsAndHead) {
  std::array<Angle, robot::kMaxJoints> targets;
  targets.fill(test::degrees(12));
  Body(model).solve(draw(), {}, targets);
  for (std::size_t joint = 12; joint < targets.size(); ++joint) EXPECT_EQ(targets[joint], test::degrees(12));
}

TEST_F(BodyTest, StaysWithinJointLimitsForTargetsOutOfReach) {
  int stretched = 0;
  for (int round = 0; round < 2'000; ++round) {
    Stance stance = draw();
    stance.centre_of_mass.z = length(0.05, 0.5);
    stance.soles[0].p.x += length(-0.2, 0.2);
    stance.soles[1].p.y += length(-0.2, 0.2);
    const auto targets = solve(stance);
    for (std::size_t joint = 0; joint < model.joint_count; ++joint) {
      ASSERT_GE(targets[joint], model.joints[joint].lower) << joint;
      ASSERT_LE(targets[joint], model.joints[joint].upper) << joint;
    }
    stretched += targets[3] == Angle() ? 1 : 0;
  }
  EXPECT_GT(stretched, 100);
}

// Compliance compensation: the target minus the desired angle of each joint, in rad.
class CompliantBody : public BodyTest {
 protected:
  static constexpr Compliance kSoft{.pitch = fixed::from_rad(fixed::kOne / 2),
                                    .roll = fixed::from_rad(fixed::kOne / 4)};

  // Returns a stance on `side` at the origin with the other foot in the air.
  static Stance on_one_foot(Side side) {
    const double in = side == Side::kLeft ? -1.0 : 1.0;
    Stance stance;
    const auto stands = static_cast<std::size_t>(side);
    stance.soles[1 - stands].p = {from_double<Length>(0.03), from_double<Length>(0.066 * in)};
    stance.heights[1 - stands] = from_double<Length>(0.02);
    stance.centre_of_mass = test::position(0.01, 0.012 * in, 0.165);
    stance.pitch = from_double<Angle>(0.05);
    stance.load_shares[stands] = fixed::kOne;
    stance.zmp = {from_double<Length>(0.008), from_double<Length>(0.003 * in)};
    return stance;
  }
  double given_rad(const Stance& stance, std::size_t joint) const {
    return to_double(solve(stance, kSoft)[joint] - solve(stance)[joint]);
  }
  // A unit ground reaction force, upwards through the ZMP, turns the part below the joint about its axis by
  // the torque r x f. The target compensates by the opposite angle.
  double expected_rad(const Stance& stance, Side side, std::size_t joint, test::Point zmp) const {
    const Posed posed(model, solve(stance));
    const test::Point torque = cross(zmp - posed.joint(joint, side), kUp);
    const test::Point axis = test::to_point(model.joints[joint].axis);
    const double soft = std::abs(axis.y) > 0.5 ? to_double(kSoft.pitch) : to_double(kSoft.roll);
    return -soft * dot(torque, axis);
  }
};

constexpr double kSameLever_rad = 1e-3;  // the trunk's lean rotates the hip's axes relative to the ground's

TEST_F(CompliantBody, CompensatesTheSagOfLoadedJoints) {
  model.joints[4].axis = -robot::kAxisY;  // must also hold for a reversed joint axis
  for (const Side side : kSides) {
    const Stance stance = on_one_foot(side);
    const test::Point zmp{to_double(stance.zmp.x), to_double(stance.zmp.y), 0};
    const auto leg = model.leg(side);
    EXPECT_EQ(given_rad(stance, leg[0]), 0.0);
    for (std::size_t i = 1; i < leg.size(); ++i) {
      const double expected = expected_rad(stance, side, leg[i], zmp);
      EXPECT_NEAR(given_rad(stance, leg[i]), expected, kSameLever_rad) << "joint " << leg[i];
    }
    EXPECT_GT(std::abs(given_rad(stance, leg[1])), 2 * kSameLever_rad);  // otherwise the test would check
                                                                         // nothing
    EXPECT_GT(std::abs(given_rad(stance, leg[3])), 2 * kSameLever_rad);
  }
}

TEST_F(CompliantBody, DoesNotCorrectAnUnloadedLeg) {
  const Stance stance = on_one_foot(Side::kLeft);
  for (const std::size_t joint : model.leg(Side::kRight)) EXPECT_EQ(given_rad(stance, joint), 0.0);
}

TEST_F(CompliantBody, ScalesTheCorrectionByTheLoadShareInDoubleSupport) {
  Stance stance = on_one_foot(Side::kLeft);
  stance.heights = {};
  stance.load_shares = {fixed::kOne / 4, fixed::kOne - fixed::kOne / 4};
  for (const Side side : kSides) {
    const double share = side == Side::kLeft ? 0.25 : 0.75;
    for (std::size_t i = 1; i < robot::kLegJoints; ++i) {
      const std::size_t joint = model.leg(side)[i];
      EXPECT_NEAR(given_rad(stance, joint), share * expected_rad(stance, side, joint, {}), kSameLever_rad)
          << "joint " << joint;
    }
  }
}

}  // namespace
}  // namespace koboshi::walk
