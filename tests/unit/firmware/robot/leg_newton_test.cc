#include "firmware/robot/leg_newton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "tests/unit/firmware/robot/random_leg.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::robot {
namespace {

using test::kRadPerDegree;
using test::LegPlan;
using test::Point;
using test::ReferenceLeg;
using test::SolePose;

constexpr std::uint32_t kSeed = 1966;

// A model with legs of a plan, loaded from its image, and the left or the right leg of it.
struct Leg {
  Leg(const LegPlan& plan, hal::Side side) {
    const RobotModel written = test::make_robot_with(plan);
    loaded = load_model(test::encode(written), model) == ModelStatus::kOk &&
             make_leg_geometry(model, side, geometry);
  }
  LegAngles solve(const SolePose& target, const LegAngles* last = nullptr) const {
    return leg_inverse_kinematics(model, geometry, test::to_fixed(target), last);
  }
  bool within_limits(const LegAngles& solution) const {
    return std::ranges::all_of(geometry.chain(), [&](LegJoint i) {
      const Joint& joint = model.joints[geometry.joints[i]];
      return solution.angles[i] >= joint.lower && solution.angles[i] <= joint.upper;
    });
  }
  double sign(LegJoint i) const { return geometry.signs[i]; }

  RobotModel model;
  LegGeometry geometry;
  bool loaded = false;
};

class NewtonLegTest : public testing::Test {
 protected:
  double uniform(double lower, double upper) {
    return std::uniform_real_distribution<>(lower, upper)(random_);
  }
  hal::Side side() { return random_() % 2 == 0 ? hal::Side::kLeft : hal::Side::kRight; }

  // Angles between standing with slightly bent knees and a deep squat with a long step and a turn.
  ReferenceLeg::Angles draw_angles(const Leg& leg) {
    const double straight = -fixed::to_double(leg.geometry.shank_tilt - leg.geometry.thigh_tilt);
    const double bend = uniform(8, 100) * kRadPerDegree;
    ReferenceLeg::Angles angles{};
    angles[kHipYaw] = leg.geometry.can_turn() ? uniform(-25, 25) * kRadPerDegree : 0.0;
    angles[kHipRoll] = uniform(-20, 20) * kRadPerDegree;
    angles[kHipPitch] = -bend / 2 + uniform(-20, 20) * kRadPerDegree;
    angles[kKnee] = straight + bend;
    angles[kAnklePitch] = -bend / 2 + uniform(-20, 20) * kRadPerDegree;
    angles[kAnkleRoll] = uniform(-20, 20) * kRadPerDegree;
    for (const LegJoint i : leg.geometry.chain()) angles[i] *= leg.sign(i);
    return angles;
  }

  std::mt19937 random_{kSeed};
};

double largest_difference(const ReferenceLeg::Angles& a, const ReferenceLeg::Angles& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < kLegJoints; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// The largest errors of solutions against their targets and against exact solutions.
struct SolutionErrors {
  double worst_m = 0.0;
  double worst_direction = 0.0;
  double worst_rad = 0.0;

  void take(const ReferenceLeg& reference, const SolePose& target, const ReferenceLeg::Angles& found) {
    worst_m = std::max(worst_m, reference.position_error_m(found, target));
    worst_direction = std::max(worst_direction, reference.direction_error(found, target));
  }
  // `exact` is where the reference begins, and becomes its solution.
  void compare(const ReferenceLeg& reference, const SolePose& target, const ReferenceLeg::Angles& found,
               ReferenceLeg::Angles& exact) {
    ASSERT_LT(reference.solve(target, exact), 1e-9);
    worst_rad = std::max(worst_rad, largest_difference(found, exact));
  }
};

TEST_F(NewtonLegTest, FindsFromBentKneesWhatTheReferenceFinds) {
  SolutionErrors errors;
  int compared = 0;
  int missed = 0;
  for (int round = 0; round < 1500; ++round) {
    const auto which = side();
    const Leg leg(test::draw_leg_plan(random_), which);
    if (!leg.loaded) continue;
    ASSERT_FALSE(leg.geometry.is_standard);
    const ReferenceLeg reference(leg.model, which, leg.geometry);
    const SolePose target = reference.pose(draw_angles(leg));
    const LegAngles solution = leg.solve(target);
    ASSERT_TRUE(leg.within_limits(solution)) << "round " << round;
    ++compared;
    if (!solution.reached) {
      ++missed;
      continue;
    }
    const ReferenceLeg::Angles found = test::to_double(solution);
    errors.take(reference, target, found);
    ReferenceLeg::Angles exact = found;
    ASSERT_NO_FATAL_FAILURE(errors.compare(reference, target, found, exact)) << "round " << round;
  }
  EXPECT_GT(compared, 1450);
  EXPECT_LT(missed, 4);
  EXPECT_LT(errors.worst_m, 3e-6);
  EXPECT_GT(errors.worst_m, 1e-9);
  EXPECT_LT(errors.worst_direction, 2e-5);
  EXPECT_LT(errors.worst_rad, 0.02 * kRadPerDegree);
  RecordProperty("worst_um", std::to_string(errors.worst_m * 1e6));
}

// One motor turns both hip yaws, at any ratio: the other five joints bring the sole where it shall be, and
// the heading follows from the given yaw.
TEST_F(NewtonLegTest, FindsFiveJointsForAYawThatBothLegsShare) {
  SolutionErrors errors;
  double worst_heading_rad = 0.0;
  int asked_headings = 0;
  int compared = 0;
  int missed = 0;
  for (int round = 0; round < 600; ++round) {
    const auto which = side();
    const double multiplier = (random_() % 2 == 0 ? 1.0 : -1.0) * uniform(0.5, 1.2);
    Leg leg(test::draw_leg_plan(random_), which);
    if (!leg.loaded) continue;
    const RobotModel shared = test::with_shared_yaw(leg.model, multiplier);
    leg.loaded = load_model(test::encode(shared), leg.model) == ModelStatus::kOk &&
                 make_leg_geometry(leg.model, which, leg.geometry);
    ASSERT_TRUE(leg.loaded && leg.geometry.shares_yaw && !leg.geometry.can_turn());
    const double ratio = which == hal::Side::kLeft ? 1.0 : fixed::to_double(leg.geometry.yaw_multiplier);
    const fixed::Angle yaw = test::degrees(uniform(-25, 25));
    // The reference's leg is the chain of hinges.
    LegGeometry hinges = leg.geometry;
    hinges.joints = hinges.hinges;
    const ReferenceLeg reference(leg.model, which, hinges);
    ReferenceLeg::Angles asked = draw_angles(leg);
    asked[kHipYaw] = ratio * fixed::to_double(yaw);
    const SolePose target = reference.pose(asked);
    const LegAngles solution = leg_inverse_kinematics(leg.model, leg.geometry, test::to_fixed(target),
                                                      nullptr, FirstSolution::kAtOnce, yaw);
    ++compared;
    if (!solution.reached) {
      ++missed;
      continue;
    }
    ASSERT_EQ(solution.angles[kHipYaw], yaw);
    ReferenceLeg::Angles found = test::to_double(solution);
    found[kHipYaw] = asked[kHipYaw];
    errors.take(reference, target, found);
    const SolePose sole = reference.pose(found);
    const test::Point& normal = target.axes[2];
    const double missing_rad = std::atan2(test::dot(normal, test::cross(sole.axes[0], target.axes[0])),
                                          test::dot(sole.axes[0], target.axes[0]));
    worst_heading_rad =
        std::max(worst_heading_rad, std::abs(fixed::to_double(solution.missing_heading) - missing_rad));
    if (std::abs(missing_rad) < 1e-4) ++asked_headings;
  }
  EXPECT_GT(compared, 560);
  EXPECT_LT(missed, 6);
  EXPECT_LT(errors.worst_m, 3e-6);
  EXPECT_GT(errors.worst_m, 1e-9);
  EXPECT_LT(errors.worst_direction, 2e-5);
  EXPECT_LT(worst_heading_rad, 2e-5);
  EXPECT_GT(worst_heading_rad, 1e-10);
  EXPECT_GT(asked_headings, 540);
}

TEST_F(NewtonLegTest, FindsInPartsWhatItFindsAtOnce) {
  double worst_m = 0.0;
  int compared = 0;
  int missed = 0;
  for (int round = 0; round < 300; ++round) {
    const auto which = side();
    const Leg leg(test::draw_leg_plan(random_), which);
    if (!leg.loaded) continue;
    const ReferenceLeg reference(leg.model, which, leg.geometry);
    const SolePose target = reference.pose(draw_angles(leg));
    if (!leg.solve(target).reached) continue;
    ++compared;
    const LegAngles* last = nullptr;
    LegAngles solution;
    for (int part = 0; part < kFirstSolutionParts; ++part) {
      solution = leg_inverse_kinematics(leg.model, leg.geometry, test::to_fixed(target), last,
                                        FirstSolution::kInParts);
      last = &solution;
      ASSERT_TRUE(leg.within_limits(solution)) << "round " << round;
    }
    if (!solution.reached) {
      ++missed;
      continue;
    }
    worst_m = std::max(worst_m, reference.position_error_m(test::to_double(solution), target));
  }
  EXPECT_GT(compared, 280);
  EXPECT_LT(missed, 2);
  EXPECT_LT(worst_m, 3e-6);
}

// A sole that swings forward by 60 mm and up by 20 mm in 0.3 s while it turns by 12 degrees, below a trunk
// that sways by 15 mm: up to 5 mm and 0.7 degrees in a cycle.
SolePose moved(const SolePose& from, int cycle) {
  const double phase = std::min(1.0, std::max(0.0, (cycle - 20) / 30.0));
  const double smooth = phase - std::sin(2 * std::numbers::pi * phase) / (2 * std::numbers::pi);
  SolePose to = from;
  const Point up{0, 0, 1};
  for (Point& axis : to.axes) axis = test::turned(axis, up, 12 * kRadPerDegree * smooth);
  to.p = to.p + Point{0.06 * (smooth - 0.5), 0.015 * std::sin(cycle * 0.1),
                      0.01 * (1 - std::cos(2 * std::numbers::pi * phase))};
  return to;
}

TEST_F(NewtonLegTest, FollowsAStepByTwoStepsACycle) {
  SolutionErrors errors;
  int followed = 0;
  for (int round = 0; round < 80; ++round) {
    const auto which = side();
    const Leg leg(test::draw_leg_plan(random_), which);
    if (!leg.loaded) continue;
    const ReferenceLeg reference(leg.model, which, leg.geometry);
    ReferenceLeg::Angles exact = draw_angles(leg);
    exact[kKnee] += (70 * kRadPerDegree) * leg.sign(kKnee) - exact[kKnee];  // room for the whole step
    const SolePose middle = reference.pose(exact);
    LegAngles last = leg.solve(moved(middle, 0));
    if (!last.reached) continue;
    exact = test::to_double(last);
    for (int cycle = 1; cycle <= 80; ++cycle) {
      const SolePose target = moved(middle, cycle);
      last = leg.solve(target, &last);
      ASSERT_TRUE(leg.within_limits(last)) << "round " << round;
      if (!last.reached) break;  // out of reach or at a limit
      const ReferenceLeg::Angles found = test::to_double(last);
      errors.take(reference, target, found);
      if (cycle % 8 != 0) continue;
      ASSERT_NO_FATAL_FAILURE(errors.compare(reference, target, found, exact)) << "round " << round;
      if (cycle == 80) ++followed;
    }
  }
  EXPECT_GT(followed, 60);
  EXPECT_LT(errors.worst_m, 20e-6);
  EXPECT_LT(errors.worst_direction, 2e-4);
  EXPECT_LT(errors.worst_rad, 0.05 * kRadPerDegree);
  RecordProperty("worst_um", std::to_string(errors.worst_m * 1e6));
}

// Lowers the sole from bent knees to beyond the reach of the leg and back.
TEST_F(NewtonLegTest, StaysFiniteAndSmoothThroughTheStraightLeg) {
  double worst_rad = 0.0;
  double worst_return_m = 0.0;
  double worst_tilt = 0.0;
  int legs = 0;
  for (int round = 0; round < 200; ++round) {
    const auto which = side();
    const Leg leg(test::draw_leg_plan(random_), which);
    if (!leg.loaded) continue;
    const ReferenceLeg reference(leg.model, which, leg.geometry);
    const double bend_at_zero = fixed::to_double(leg.geometry.shank_tilt - leg.geometry.thigh_tilt);
    ReferenceLeg::Angles bent{};
    bent[kKnee] = leg.sign(kKnee) * (30 * kRadPerDegree - bend_at_zero);
    bent[kHipPitch] = leg.sign(kHipPitch) * -15 * kRadPerDegree;
    bent[kAnklePitch] = leg.sign(kAnklePitch) * -15 * kRadPerDegree;
    const SolePose begin = reference.pose(bent);
    LegAngles last = leg.solve(begin);
    if (!last.reached) continue;
    ++legs;
    constexpr int kCycles = 120;
    for (int cycle = 1; cycle <= 2 * kCycles; ++cycle) {
      const int down = cycle <= kCycles ? cycle : 2 * kCycles - cycle;
      SolePose target = begin;
      target.p.z -= 0.0002 * down;  // 24 mm in all; the knee is straight after about 4 mm
      const ReferenceLeg::Angles before = test::to_double(last);
      last = leg.solve(target, &last);
      const ReferenceLeg::Angles found = test::to_double(last);
      ASSERT_TRUE(leg.within_limits(last));
      worst_rad = std::max(worst_rad, largest_difference(before, found));
      worst_tilt = std::max(worst_tilt, reference.direction_error(found, target));
    }
    worst_return_m = std::max(worst_return_m, reference.position_error_m(test::to_double(last), begin));
  }
  EXPECT_GT(legs, 180);
  // The knee of the exact solution turns by up to 9 degrees in the first 0.2 mm from the straight leg.
  EXPECT_LT(worst_rad, 15 * kRadPerDegree);
  EXPECT_LT(worst_tilt, 0.02);
  EXPECT_LT(worst_return_m, 3e-6);
}

TEST_F(NewtonLegTest, WithoutHipYawSolvesTheRestAndReportsTheHeading) {
  int legs = 0;
  for (int round = 0; round < 1000; ++round) {
    const auto which = side();
    LegPlan plan = test::draw_leg_plan(random_);
    plan.has_yaw = false;
    std::ranges::stable_partition(plan.hip, [](LegJoint i) { return i == kHipYaw; });
    const Leg leg(plan, which);
    if (!leg.loaded) continue;
    ASSERT_FALSE(leg.geometry.can_turn());
    const ReferenceLeg reference(leg.model, which, leg.geometry);
    SolePose target = reference.pose(draw_angles(leg));
    const double turn_rad = uniform(-30, 30) * kRadPerDegree;
    const Point normal = target.axes[2];
    for (Point& axis : target.axes) axis = test::turned(axis, normal, turn_rad);
    const LegAngles solution = leg.solve(target);
    if (!solution.reached) continue;
    ++legs;
    EXPECT_LT(reference.position_error_m(test::to_double(solution), target), 3e-6);
    EXPECT_LT(reference.direction_error(test::to_double(solution), target), 2e-5);
    EXPECT_NEAR(fixed::to_double(solution.missing_heading), turn_rad, 1e-3) << "round " << round;
  }
  EXPECT_GT(legs, 950);
}

TEST_F(NewtonLegTest, WithHipYawMissesNoHeading) {
  const Leg leg(test::draw_leg_plan(random_), hal::Side::kLeft);
  ASSERT_TRUE(leg.loaded);
  EXPECT_EQ(leg.solve(ReferenceLeg(leg.model, hal::Side::kLeft, leg.geometry).pose({})).missing_heading,
            fixed::Angle());
}

TEST_F(NewtonLegTest, StaysWithinLimitsForAnyTarget) {
  for (int round = 0; round < 1000; ++round) {
    LegPlan plan = test::draw_leg_plan(random_);
    plan.has_yaw = random_() % 2 == 0;
    const Leg leg(plan, side());
    if (!leg.loaded) continue;
    const auto length = [&] {
      return fixed::Length::from_raw(static_cast<std::int32_t>(random_()) >> (random_() % 24));
    };
    const auto angle = [&] { return fixed::Angle::from_raw(static_cast<std::int32_t>(random_())); };
    LegAngles last;
    for (int cycle = 0; cycle < 5; ++cycle) {
      Pose target;
      target.p = {length(), length(), length()};
      target.R =
          rotation_about(kAxisZ, angle()) * rotation_about(kAxisX, angle()) * rotation_about(kAxisY, angle());
      last = leg_inverse_kinematics(leg.model, leg.geometry, target, cycle == 0 ? nullptr : &last);
      ASSERT_TRUE(leg.within_limits(last)) << "round " << round;
    }
  }
}

// The closed form and the Newton steps of the same leg.
TEST_F(NewtonLegTest, AgreesWithTheClosedFormOnAStandardLeg) {
  const Leg standard(LegPlan{}, hal::Side::kLeft);
  ASSERT_TRUE(standard.loaded);
  ASSERT_TRUE(standard.geometry.is_standard);
  LegPlan bent = LegPlan{};
  bent.offsets[1].y = 2e-6;  // beyond the tolerance of axes that meet
  const Leg newton(bent, hal::Side::kLeft);
  ASSERT_TRUE(newton.loaded);
  ASSERT_FALSE(newton.geometry.is_standard);
  const ReferenceLeg reference(standard.model, hal::Side::kLeft, standard.geometry);
  for (int round = 0; round < 1000; ++round) {
    const SolePose target = reference.pose(draw_angles(standard));
    const auto closed = test::to_double(standard.solve(target));
    const LegAngles stepped = newton.solve(target);
    ASSERT_TRUE(stepped.reached) << "round " << round;
    EXPECT_LT(largest_difference(closed, test::to_double(stepped)), 0.03 * kRadPerDegree);
  }
}

TEST(LegGeometry, RefusesChainsThatAreNoLeg) {
  const auto makes = [](auto change) {
    RobotModel model = test::make_robot_with(LegPlan{});
    change(model, model.leg(hal::Side::kLeft));
    LegGeometry leg;
    return load_model(test::encode(model), model) == ModelStatus::kOk &&
           make_leg_geometry(model, hal::Side::kLeft, leg);
  };
  using Leg = const std::array<JointIndex, kLegJoints>&;
  EXPECT_TRUE(makes([](RobotModel&, Leg) {}));
  EXPECT_FALSE(makes([](RobotModel& model, Leg leg) { model.joints[leg[kKnee]].role = JointRole::kOther; }));
  EXPECT_FALSE(makes([](RobotModel& model, Leg leg) {  // the knee above the hip pitch
    model.joints[leg[kKnee]].parent = LinkIndex(leg[kHipRoll]);
    model.joints[leg[kHipPitch]].parent = LinkIndex(leg[kKnee]);
    model.joints[leg[kAnklePitch]].parent = LinkIndex(leg[kHipPitch]);
  }));
  EXPECT_FALSE(makes([](RobotModel& model, Leg leg) {  // a branch
    model.joints[leg[kAnkleRoll]].parent = LinkIndex(leg[kKnee]);
  }));
  EXPECT_FALSE(makes([](RobotModel& model, Leg leg) { model.joints[leg[kHipRoll]].axis = kAxisZ; }));
  EXPECT_FALSE(makes([](RobotModel& model, Leg leg) { model.joints[leg[kAnkleRoll]].axis = kAxisY; }));
}

}  // namespace
}  // namespace koboshi::robot
