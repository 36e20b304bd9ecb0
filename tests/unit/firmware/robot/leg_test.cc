#include "firmware/robot/leg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "tests/unit/firmware/robot/random_leg.h"
#include "tests/unit/firmware/robot/reference.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::robot {
namespace {

using fixed::from_double;
using test::kRadPerDegree;
using test::Point;
using test::SolePose;
using test::to_base;
using test::to_fixed;

constexpr std::uint32_t kLegSeed = 1966;
constexpr std::array<Point, 3> kUnits{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

using Angles = std::array<double, kMaxJoints>;

class LegTest : public testing::TestWithParam<hal::Side> {
 protected:
  void SetUp() override { load(test::make_test_robot()); }

  void load(const RobotModel& written) {
    ASSERT_EQ(load_model(test::encode(written), model_), ModelStatus::kOk);
    ASSERT_TRUE(make_leg_geometry(model_, GetParam(), leg_));
  }

  // Draws angles uniformly within the limits, and one in eight at a limit. Hip roll avoids the gimbal lock.
  Angles draw_angles() {
    Angles angles{};
    for (std::size_t i = 0; i < kLegJoints; ++i) {
      const Joint& joint = model_.joints[leg_.joints[i]];
      const double lower = fixed::to_double(joint.lower);
      const double upper = fixed::to_double(joint.upper);
      const double fraction = std::uniform_real_distribution<>(0.0, 1.0)(random_);
      const auto choice = random_() % 16;
      angles[leg_.joints[i]] = choice == 0 ? lower : choice == 1 ? upper : lower + fraction * (upper - lower);
    }
    double& roll = angles[leg_.joints[1]];
    roll = std::clamp(roll, -89.9 * kRadPerDegree, 89.9 * kRadPerDegree);
    if (!is_well_conditioned(angles)) keep_off_limits(angles);
    return angles;
  }

  // Returns the position of the hip relative to the ankle in the foot's frame.
  double lean(const Angles& angles) const {
    const double shank_tilt = fixed::to_double(leg_.shank_tilt);
    const double knee = angles[leg_.joints[3]] - fixed::to_double(leg_.thigh_tilt) + shank_tilt;
    const double thigh = fixed::to_double(leg_.thigh);
    return angles[leg_.joints[4]] - shank_tilt +
           std::atan2(thigh * std::sin(knee), fixed::to_double(leg_.shank) + thigh * std::cos(knee));
  }

  // False if the leg is nearly straight, hip yaw and hip pitch have nearly the same axis, or the hip is on
  // the ankle's roll axis.
  bool is_well_conditioned(const Angles& angles) const {
    const double knee = angles[leg_.joints[3]];
    return std::abs(knee) >= 5.0 * kRadPerDegree &&
           std::abs(angles[leg_.joints[1]]) <= 75.0 * kRadPerDegree &&
           std::abs(std::cos(lean(angles))) > 0.25;
  }

  // Elsewhere the rounding of a pose to 60 nm corresponds to a tenth of a degree in some joint, and may
  // exceed its limit.
  void keep_off_limits(Angles& angles) const {
    for (const std::size_t i : {0u, 1u, 2u, 4u, 5u}) {
      const Joint& joint = model_.joints[leg_.joints[i]];
      const double margin = 0.5 * kRadPerDegree;
      double& angle = angles[leg_.joints[i]];
      angle =
          std::clamp(angle, fixed::to_double(joint.lower) + margin, fixed::to_double(joint.upper) - margin);
    }
  }

  SolePose sole(const Angles& angles) const {
    const auto foot = static_cast<int>(leg_.joints[5]);
    SolePose pose{to_base(model_, angles, foot, {0, 0, -fixed::to_double(leg_.ankle_height)}), {}};
    for (std::size_t i = 0; i < 3; ++i) pose.axes[i] = to_base(model_, angles, foot, kUnits[i], true);
    return pose;
  }

  Angles to_angles(const LegAngles& solution) const {
    Angles angles{};
    for (std::size_t i = 0; i < kLegJoints; ++i)
      angles[leg_.joints[i]] = fixed::to_double(solution.angles[i]);
    return angles;
  }

  bool within_limits(const LegAngles& solution) const {
    for (std::size_t i = 0; i < kLegJoints; ++i) {
      const Joint& joint = model_.joints[leg_.joints[i]];
      if (solution.angles[i] < joint.lower || solution.angles[i] > joint.upper) return false;
    }
    return true;
  }

  // Checks the error bounds over the whole workspace, for the given leg geometry.
  void check_workspace(int rounds) {
    double worst_m = 0.0;
    double worst_direction = 0.0;
    double worst_knee_rad = 0.0;
    for (int round = 0; round < rounds; ++round) {
      const Angles wanted = draw_angles();
      if (std::abs(std::cos(lean(wanted))) < 0.01)
        continue;  // the hip is on the ankle's roll axis: any roll is a solution
      const SolePose target = sole(wanted);
      const LegAngles solution = leg_inverse_kinematics(model_, leg_, to_fixed(target));
      ASSERT_TRUE(solution.reached) << "seed " << kLegSeed << " round " << round;
      ASSERT_TRUE(within_limits(solution));
      const Angles found = to_angles(solution);
      const SolePose reached = sole(found);
      worst_m = std::max(worst_m, norm(reached.p - target.p));
      for (std::size_t i = 0; i < 3; ++i) {
        worst_direction = std::max(worst_direction, norm(reached.axes[i] - target.axes[i]));
      }
      const std::size_t knee = leg_.joints[3];
      if (std::abs(wanted[knee]) >= 5.0 * kRadPerDegree) {
        worst_knee_rad = std::max(worst_knee_rad, std::abs(found[knee] - wanted[knee]));
      }
    }
    EXPECT_LT(worst_m, 20e-6) << "seed " << kLegSeed;
    EXPECT_LT(worst_direction, 2e-5) << "seed " << kLegSeed;
    EXPECT_LT(worst_knee_rad, 0.01 * kRadPerDegree) << "seed " << kLegSeed;
    EXPECT_GT(worst_m, 1e-9);
    RecordProperty("worst_um", std::to_string(worst_m * 1e6));
    RecordProperty("worst_knee_deg", std::to_string(worst_knee_rad / kRadPerDegree));
  }

  RobotModel model_;
  LegGeometry leg_;
  std::mt19937 random_{kLegSeed};
};

TEST_P(LegTest, ReachesItsTargetInTheWholeWorkspace) { check_workspace(100000); }

TEST_P(LegTest, SupportsAnySignOfItsAxes) {
  RobotModel written = test::make_test_robot();
  for (const auto side : {hal::Side::kLeft, hal::Side::kRight}) {
    for (const JointIndex index : written.leg(side)) {
      Joint& joint = written.joints[index];
      joint.axis = -joint.axis;
      std::swap(joint.lower, joint.upper);
      joint.lower = -joint.lower;
      joint.upper = -joint.upper;
    }
  }
  load(written);
  check_workspace(10000);
}

TEST_P(LegTest, SupportsKneesOffTheLineFromHipToAnkle) {
  RobotModel written = test::make_test_robot();
  for (const auto side : {hal::Side::kLeft, hal::Side::kRight}) {
    const auto joints = written.leg(side);
    written.joints[joints[3]].anchor = test::position(0.008, 0, -0.06);
    written.joints[joints[4]].anchor = test::position(-0.006, 0, -0.07);
    // The limits of the equivalent straight leg. Beyond them the knee would bend past the straight line.
    written.joints[joints[3]].lower = test::degrees(13);
  }
  load(written);
  check_workspace(10000);
}

TEST_P(LegTest, ReturnsAllAnglesWhereWellConditioned) {
  for (int round = 0; round < 20000; ++round) {
    const Angles wanted = draw_angles();
    if (!is_well_conditioned(wanted)) continue;
    const Angles found = to_angles(leg_inverse_kinematics(model_, leg_, to_fixed(sole(wanted))));
    for (const JointIndex joint : leg_.joints) {
      ASSERT_NEAR(found[joint], wanted[joint], 0.01 * kRadPerDegree)
          << "seed " << kLegSeed << " round " << round << " joint " << std::size_t{joint};
    }
  }
}

TEST_P(LegTest, PointsAtATargetBeyondItsReach) {
  const double y = GetParam() == hal::Side::kLeft ? 0.03 : -0.03;
  Pose target;
  target.p = test::position(0.05, y, -0.3);
  const LegAngles solution = leg_inverse_kinematics(model_, leg_, target);
  EXPECT_FALSE(solution.reached);
  const SolePose sole_pose = sole(to_angles(solution));
  // The leg extended along the line from the hip to the desired ankle, with the sole level.
  const Point p_HAnkle = sole_pose.p + Point{0, 0, 0.04} - Point{0, y, 0};
  EXPECT_NEAR(norm(p_HAnkle), 0.13, 1e-6);
  EXPECT_NEAR(p_HAnkle.x / p_HAnkle.z, 0.05 / -0.26, 1e-4);
  EXPECT_NEAR(sole_pose.axes[2].z, 1.0, 1e-7);
}

// The hip turns the sole level again, and yet the sole is not where it should be.
TEST_P(LegTest, DoesNotReachBesideTheLimitOfItsAnkleRoll) {
  RobotModel written = test::make_test_robot();
  for (const auto side : {hal::Side::kLeft, hal::Side::kRight}) {
    Joint& roll = written.joints[written.leg(side)[5]];
    roll.lower = test::degrees(-20);
    roll.upper = test::degrees(20);
  }
  load(written);
  const auto reaches = [this](double roll_deg) {
    Pose target;
    target.p = leg_.p_BH_B - Position{.x = {}, .y = {}, .z = leg_.ankle_height} +
               test::position(0.0, 0.1 * std::tan(roll_deg * kRadPerDegree), -0.1);
    return leg_inverse_kinematics(model_, leg_, target).reached;
  };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(reaches(sign * 19.9)) << sign;
    EXPECT_FALSE(reaches(sign * 20.1)) << sign;
  }
}

TEST_P(LegTest, FoldsForATargetAtTheHip) {
  Pose target;
  target.p = leg_.p_BH_B - Position{.x = {}, .y = {}, .z = leg_.ankle_height};
  const LegAngles solution = leg_inverse_kinematics(model_, leg_, target);
  EXPECT_FALSE(solution.reached);
  EXPECT_EQ(solution.angles[3], model_.joints[leg_.joints[3]].upper);
}

TEST_P(LegTest, StaysWithinLimitsForAnyTarget) {
  for (int round = 0; round < 20000; ++round) {
    const auto length = [&] {
      return fixed::Length::from_raw(static_cast<std::int32_t>(random_()) >> (random_() % 24));
    };
    const auto angle = [&] { return fixed::Angle::from_raw(static_cast<std::int32_t>(random_())); };
    Pose target;
    target.p = {length(), length(), length()};
    target.R =
        rotation_about(kAxisZ, angle()) * rotation_about(kAxisX, angle()) * rotation_about(kAxisY, angle());
    ASSERT_TRUE(within_limits(leg_inverse_kinematics(model_, leg_, target))) << "seed " << kLegSeed;
  }
}

TEST_P(LegTest, IgnoresYawInGimbalLock) {
  const double roll = GetParam() == hal::Side::kLeft ? 90 : -90;
  Angles wanted{};
  wanted[leg_.joints[1]] = roll * kRadPerDegree;
  wanted[leg_.joints[2]] = -0.5;
  wanted[leg_.joints[3]] = 1.0;
  const LegAngles solution = leg_inverse_kinematics(model_, leg_, to_fixed(sole(wanted)));
  EXPECT_TRUE(solution.reached);
  EXPECT_EQ(solution.angles[0], fixed::Angle());
  EXPECT_LT(norm(sole(to_angles(solution)).p - sole(wanted).p), 20e-6);
}

INSTANTIATE_TEST_SUITE_P(Sides, LegTest, testing::Values(hal::Side::kLeft, hal::Side::kRight),
                         [](const auto& info) { return info.param == hal::Side::kLeft ? "Left" : "Right"; });

}  // namespace
}  // namespace koboshi::robot
