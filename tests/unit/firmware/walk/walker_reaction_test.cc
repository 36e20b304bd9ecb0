// Reactions of the walker to sensor readings.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "tests/unit/firmware/walk/walking_robot.h"

namespace koboshi::walk {
namespace {

using fixed::Angle;
using fixed::Force;
using fixed::from_double;
using fixed::Length;
using fixed::to_double;
using hal::Side;
using test::rigid;
using test::WalkingRobot;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr int kPlanAge = 5;  // cycles

Observation turning(double turn_rad) {
  Observation seen;
  seen.turn = from_double<Angle>(turn_rad);
  return seen;
}

// What a robot senses that follows its plan, but for an error of its DCM.
Observation beside_the_plan(const Walker& walker, double x_m, double y_m) {
  Observation seen;
  seen.dcm = walker.expected_dcm();
  if (!seen.dcm) return seen;
  seen.dcm->p.x += from_double<Length>(x_m);
  seen.dcm->p.y += from_double<Length>(y_m);
  return seen;
}

bool advance_until_landing(WalkingRobot& robot, double x_m, double y_m, const Velocity& command = {}) {
  const std::size_t before = robot.landings.size();
  for (int i = 0; i < 200 && robot.landings.size() == before; ++i)
    robot.advance(command, beside_the_plan(robot.walker, x_m, y_m));
  return robot.landings.size() > before;
}

// Parameters with single support only, so that a foothold moves exactly by the capture term.
WalkParameters capturing(std::int16_t ahead, std::int16_t aside) {
  WalkParameters parameters = rigid();
  parameters.step.double_support = 0;
  parameters.reaction.capture_forward = ahead;
  parameters.reaction.capture_lateral = aside;
  parameters.reaction.dead_band = 50;
  parameters.reaction.smoothing = 0;
  parameters.reaction.plan_age_ms = 10 * kPlanAge;
  return parameters;
}

// A robot that marches on the spot and has just landed on the foot of the other side.
WalkingRobot before_a_step_of(Side side, const WalkParameters& parameters) {
  WalkingRobot robot(parameters);
  for (int step = 0; step < 4; ++step) EXPECT_TRUE(advance_until_landing(robot, 0, 0));
  while (robot.landings.back().side == side) EXPECT_TRUE(advance_until_landing(robot, 0, 0));
  return robot;
}

// Returns the displacement of a landing relative to stepping on the spot, when the DCM is beside the plan
// during the whole step.
test::Point shift(const WalkParameters& parameters, Side side, double x_m, double y_m) {
  WalkingRobot robot = before_a_step_of(side, parameters);
  const test::Point before = robot.landings[robot.landings.size() - 2].p;  // the same foot's last
  EXPECT_TRUE(advance_until_landing(robot, x_m, y_m));
  EXPECT_EQ(robot.landings.back().side, side);
  return robot.landings.back().p - before;
}

TEST(WalkerCapture, MovesTheFootholdForwardTowardsAnError) {
  for (const double error_m : {0.02, -0.02}) {
    const double sign = error_m > 0 ? 1.0 : -1.0;
    const test::Point moved = shift(capturing(500, 300), Side::kLeft, error_m, 0);
    EXPECT_NEAR(moved.x, sign * 0.5 * (0.02 - 0.005), 0.1e-3);
    EXPECT_NEAR(moved.y, 0.0, 0.1e-3);
  }
}

TEST(WalkerCapture, MovesTheFootholdToTheSideTowardsAnError) {
  EXPECT_NEAR(shift(capturing(300, 500), Side::kRight, 0, -0.02).y, -0.5 * 0.015, 0.1e-3);
  EXPECT_NEAR(shift(capturing(300, 500), Side::kLeft, 0, 0.02).y, 0.5 * 0.015, 0.1e-3);
}

TEST(WalkerCapture, StepsNoFurtherForwardOrBackwardThanAllowed) {
  WalkParameters parameters = capturing(1000, 0);
  parameters.step.max_forward = 100;  // 10 mm, less than half of what the error asks for
  for (const double error_m : {0.03, -0.03}) {
    WalkingRobot robot = before_a_step_of(Side::kLeft, parameters);
    ASSERT_TRUE(advance_until_landing(robot, error_m, 0));
    EXPECT_NEAR(robot.landings.back().p.x, error_m > 0 ? 0.01 : -0.01, 0.1e-3);
  }
}

TEST(WalkerCapture, DoesNothingWithinTheDeadBandOrWithoutGain) {
  for (const auto& [parameters, error_m] :
       {std::pair{capturing(1'000, 1'000), 0.0049}, std::pair{capturing(0, 0), 0.03}}) {
    WalkingRobot errs(parameters);
    WalkingRobot walks(parameters);
    for (int tick = 0; tick < 300; ++tick) {
      errs.advance({100, 0, 0}, beside_the_plan(errs.walker, error_m, -error_m));
      walks.advance({100, 0, 0}, beside_the_plan(walks.walker, 0, 0));
      ASSERT_EQ(errs.targets(), walks.targets()) << tick;
    }
  }
}

// The foot that bears a robot which takes steps, and for how many cycles.
struct Step {
  Side support;
  int ticks;
};

// The steps of a robot that was pushed and is beside its plan for a second, until it stands.
std::vector<Step> steps_after_a_push(const WalkParameters& parameters, Side pushed_to) {
  WalkingRobot robot(parameters);
  robot.walker.start(robot.parameters, robot.standing, pushed_to);
  std::vector<Step> steps;
  for (int tick = 0; tick < 1'000 && robot.walker.running(); ++tick) {
    robot.advance({}, beside_the_plan(robot.walker, tick < 100 ? 0.02 : 0.0, 0));
    const auto support = robot.walker.support();
    if (!support) continue;
    if (steps.empty() || steps.back().support != *support) steps.push_back({*support, 0});
    ++steps.back().ticks;
  }
  EXPECT_FALSE(robot.walker.running());
  return steps;
}

TEST(WalkerPushed, TakesFastStepsFromTheFootToWhichItIsPushed) {
  WalkParameters parameters = capturing(500, 500);
  parameters.reaction.pushed_step_time_ms = 180;
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const std::vector<Step> steps = steps_after_a_push(parameters, side);
    ASSERT_GE(steps.size(), 4u);
    EXPECT_EQ(steps.front().support, side);
    for (const Step& step : steps) EXPECT_EQ(step.ticks, 18);
  }
}

TEST(WalkerPushed, StepsAsInAWalkWithoutATimeOfItsOwn) {
  const std::vector<Step> steps = steps_after_a_push(capturing(500, 500), Side::kLeft);
  ASSERT_GE(steps.size(), 3u);
  for (const Step& step : steps) EXPECT_EQ(step.ticks, 26);
}

TEST(WalkerPushed, WalksOnWithTheTimeOfAWalk) {
  WalkParameters parameters = capturing(500, 500);
  parameters.reaction.pushed_step_time_ms = 180;
  WalkingRobot robot(parameters);
  robot.walker.start(robot.parameters, robot.standing, Side::kLeft);
  EXPECT_TRUE(robot.walker.stopping());
  robot.walker.resume();
  EXPECT_FALSE(robot.walker.stopping());
  for (int tick = 0; tick < 200; ++tick) robot.advance({100, 0, 0}, beside_the_plan(robot.walker, 0, 0));
  ASSERT_TRUE(robot.walker.support());
  const Side support = *robot.walker.support();
  while (robot.walker.support() == support) robot.advance({100, 0, 0}, beside_the_plan(robot.walker, 0, 0));
  int ticks = 0;
  for (; robot.walker.support() == other(support); ++ticks)
    robot.advance({100, 0, 0}, beside_the_plan(robot.walker, 0, 0));
  EXPECT_EQ(ticks, 26);
}

// The angle by which both arms are turned back from where the robot holds them.
double arms_back_rad(const WalkingRobot& robot) {
  constexpr std::size_t kLeftShoulder = 12, kRightShoulder = 15;
  const double left_rad = to_double(robot.targets()[kLeftShoulder] - robot.standing[kLeftShoulder]);
  EXPECT_EQ(robot.targets()[kRightShoulder] - robot.standing[kRightShoulder],
            robot.targets()[kLeftShoulder] - robot.standing[kLeftShoulder]);
  return left_rad;
}

TEST(WalkerArms, TurnAgainstAnErrorFastAndReturnSlowly) {
  for (const double sign : {1.0, -1.0}) {
    WalkParameters parameters = capturing(0, 0);
    parameters.reaction.arm_reaction = 5'000;
    WalkingRobot robot = before_a_step_of(Side::kLeft, parameters);
    EXPECT_EQ(arms_back_rad(robot), 0.0);
    const double reached_rad = 50.0 * (0.025 - 0.005);
    for (int tick = 1; tick <= 20; ++tick) {
      robot.advance({}, beside_the_plan(robot.walker, sign * 0.025, 0));
      EXPECT_NEAR(arms_back_rad(robot), sign * std::min(reached_rad, tick * 8.0 * M_PI / 180), 1e-3) << tick;
    }
    for (int tick = 1; tick <= 60; ++tick) {
      robot.advance({}, beside_the_plan(robot.walker, 0, 0));
      EXPECT_NEAR(arms_back_rad(robot), sign * std::max(0.0, reached_rad - tick * 1.5 * M_PI / 180), 1e-3)
          << tick;
    }
  }
}

TEST(WalkerArms, TurnNoFurtherThanTheyCanReturnBeforeAnImpact) {
  WalkParameters parameters = capturing(0, 0);
  parameters.reaction.arm_reaction = 5'000;
  WalkingRobot robot = before_a_step_of(Side::kLeft, parameters);
  for (int tick = 0; tick < 20; ++tick) robot.advance({}, beside_the_plan(robot.walker, -0.05, 0));
  EXPECT_NEAR(arms_back_rad(robot), -60.0 * M_PI / 180, 1e-6);
}

TEST(WalkerArms, StayStillWithinTheDeadBandAndForAnErrorToTheSide) {
  WalkParameters parameters = capturing(0, 0);
  parameters.reaction.arm_reaction = 5'000;
  WalkingRobot robot = before_a_step_of(Side::kLeft, parameters);
  for (int tick = 0; tick < 100; ++tick) {
    robot.advance({}, beside_the_plan(robot.walker, 0.0049, 0.03));
    ASSERT_EQ(arms_back_rad(robot), 0.0) << tick;
  }
}

TEST(WalkerArms, AreWhereTheyBeganInTheNextWalk) {
  WalkParameters parameters = capturing(0, 0);
  parameters.reaction.arm_reaction = 5'000;
  WalkingRobot robot = before_a_step_of(Side::kLeft, parameters);
  for (int tick = 0; tick < 20; ++tick) robot.advance({}, beside_the_plan(robot.walker, 0.025, 0));
  ASSERT_GT(arms_back_rad(robot), 0.9);
  robot.walker.abort();
  robot.walker.start(robot.parameters, robot.standing);
  for (int tick = 0; tick < 50; ++tick) robot.advance({}, beside_the_plan(robot.walker, 0, 0));
  EXPECT_EQ(arms_back_rad(robot), 0.0);
}

TEST(WalkerCapture, DoesNotUseADcmInTheFrameOfTheOtherFoot) {
  WalkingRobot robot(capturing(500, 500));
  WalkingRobot walks(capturing(500, 500));
  for (int tick = 0; tick < 300; ++tick) {
    Observation seen = beside_the_plan(robot.walker, 0.03, 0.03);
    seen.dcm->sole = other(seen.dcm->sole);
    robot.advance({}, seen);
    walks.advance({}, beside_the_plan(walks.walker, 0, 0));
    ASSERT_EQ(robot.targets(), walks.targets()) << tick;
  }
}

// For the age of the plan after a landing, the measurement is still compared in the frame of the old foot.
TEST(WalkerCapture, ComparesWithThePlanOfItsMoment) {
  WalkingRobot robot = before_a_step_of(Side::kLeft, capturing(0, 0));
  const auto support = *robot.walker.support();
  for (int tick = 0; tick < 100; ++tick) {
    ASSERT_TRUE(robot.walker.expected_dcm());
    if (*robot.walker.support() != support) break;
    robot.advance({}, beside_the_plan(robot.walker, 0, 0));
  }
  for (int tick = 0; tick < kPlanAge; ++tick) {
    EXPECT_EQ(robot.walker.expected_dcm()->sole, support) << tick;
    robot.advance({}, beside_the_plan(robot.walker, 0, 0));
  }
  EXPECT_EQ(robot.walker.expected_dcm()->sole, other(support));
}

// The robot is elsewhere now, and the next step does not go back.
TEST(WalkerCapture, TakesWhatAStepHasCaughtOverIntoThePlan) {
  WalkingRobot robot = before_a_step_of(Side::kLeft, capturing(500, 500));
  ASSERT_TRUE(advance_until_landing(robot, 0.025, 0.025));
  EXPECT_NEAR(robot.landings.back().p.x, 0.01, 0.1e-3);
  for (int step = 0; step < 4; ++step) {
    ASSERT_TRUE(advance_until_landing(robot, 0, 0));
    EXPECT_NEAR(robot.landings.back().p.x, 0.0, 0.6e-3) << step;
    EXPECT_NEAR(std::abs(robot.landings.back().p.y), 0.066, 0.6e-3) << step;
  }
}

// What lasts is a slope or the servos' sag. An average over ten steps takes it up.
TEST(WalkerCapture, IgnoresALastingError) {
  WalkingRobot robot(capturing(500, 500));
  while (robot.landings.size() < 80) ASSERT_TRUE(advance_until_landing(robot, 0.015, -0.015));
  const test::Point last = robot.landings.back().p;
  EXPECT_NEAR(last.x, 0.0, 0.1e-3);
  EXPECT_NEAR(std::abs(last.y), 0.066, 0.1e-3);
}

TEST(WalkerCapture, ClampsAnErrorThatNoStepCatches) {
  EXPECT_NEAR(shift(capturing(500, 0), Side::kLeft, 0.5, 0).x, 0.5 * (0.08 - 0.005), 0.1e-3);
}

TEST(WalkerCapture, SmoothsTheError) {
  WalkParameters parameters = capturing(500, 0);
  parameters.reaction.dead_band = 0;
  parameters.reaction.smoothing = 950;
  const test::Point moved = shift(parameters, Side::kLeft, 0.02, 0);
  EXPECT_NEAR(moved.x, 0.5 * 0.02 * (1.0 - std::pow(0.95, 26)), 0.2e-3);
}

TEST(WalkerCapture, TellsTheErrorInShareOfWhatTheStepsCatch) {
  WalkParameters parameters = capturing(0, 0);
  parameters.step.max_forward = 1000;
  WalkingRobot robot = before_a_step_of(Side::kLeft, parameters);
  EXPECT_EQ(robot.walker.error_percent(), 0);
  const double growth = std::exp(0.26 / 0.13166);
  const double sole_m = 0.17 / 4;
  const double ahead_m = 0.1 * (1 + 1 / growth) / (1 - 1 / (growth * growth)) + sole_m;
  robot.advance({}, beside_the_plan(robot.walker, 0.02, 0));
  const double early = 0.02 * std::exp(0.25 / 0.13166) / ahead_m;
  EXPECT_NEAR(*robot.walker.error_percent(), 100 * early, 1.0);
  for (int tick = 0; tick < 20; ++tick) robot.advance({}, beside_the_plan(robot.walker, 0.02, 0));
  const double late = 0.02 * std::exp(0.05 / 0.13166) / ahead_m;
  EXPECT_NEAR(*robot.walker.error_percent(), 100 * late, 1.0);
  // To the side of the swing foot, which lands wider, and to the other one, where it lands narrower.
  const double wider_m = 0.130 - 0.066;
  const double narrower_m = 0.066 - 0.058;
  const auto aside_m = [&](double first_m, double then_m) {
    return (first_m + then_m / growth) / (1 - 1 / (growth * growth)) + sole_m;
  };
  const double later = std::exp(0.04 / 0.13166);
  robot.advance({}, beside_the_plan(robot.walker, 0, 0.02));
  EXPECT_NEAR(*robot.walker.error_percent(), 100 * 0.02 * later / aside_m(wider_m, narrower_m), 1.0);
  robot.advance({}, beside_the_plan(robot.walker, 0, -0.02));
  const double last = std::exp(0.03 / 0.13166);
  EXPECT_NEAR(*robot.walker.error_percent(), 100 * 0.02 * last / aside_m(narrower_m, wider_m), 1.0);
}

// A step is about to be taken, and the fall detector must not give the robot up before.
TEST(WalkerCapture, TellsTheErrorWhileTheWeightShiftsForTheFirstStep) {
  WalkParameters parameters = capturing(0, 0);
  parameters.step.max_forward = 1000;
  WalkingRobot robot(parameters);
  for (int tick = 0; tick < 3; ++tick) robot.advance({}, beside_the_plan(robot.walker, 0, 0));
  EXPECT_EQ(robot.walker.error_percent(), 0);
  robot.advance({}, beside_the_plan(robot.walker, 0.02, 0));
  ASSERT_FALSE(robot.walker.phase()) << "it steps already";
  const double growth = std::exp(0.26 / 0.13166);
  const double ahead_m = 0.1 * (1 + 1 / growth) / (1 - 1 / (growth * growth)) + 0.17 / 4;
  EXPECT_NEAR(*robot.walker.error_percent(), 100 * 0.02 * growth / ahead_m, 1.0);
}

TEST(WalkerCapture, TellsNoErrorThatItDoesNotMeasure) {
  WalkParameters parameters = capturing(500, 500);
  parameters.reaction.plan_age_ms = 0;
  WalkingRobot robot(parameters);
  for (int tick = 0; tick < 200; ++tick) robot.advance();
  EXPECT_FALSE(robot.walker.error_percent());
  EXPECT_FALSE(robot.walker.dcm_error());
  EXPECT_FALSE(robot.walker.expected_dcm());
}

// The joints of the left leg in WalkingRobot: hip yaw, roll and pitch, knee, ankle pitch and roll.
constexpr std::size_t kAnklePitch = 4;
constexpr std::size_t kAnkleRoll = 5;

// The targets of an ankle in a march with an observation less those of an undisturbed one, tick by tick of
// one step of the left foot and of the step after it.
std::vector<double> ankle_difference_rad(const WalkParameters& parameters, std::size_t joint,
                                         const std::function<Observation(const Walker&)>& observe) {
  WalkingRobot robot = before_a_step_of(Side::kLeft, parameters);
  WalkingRobot undisturbed = before_a_step_of(Side::kLeft, parameters);
  const auto leg = robot.model.leg(Side::kLeft);
  std::vector<double> difference;
  for (int tick = 0; tick < 52; ++tick) {
    robot.advance({}, observe(robot.walker));
    undisturbed.advance({}, beside_the_plan(undisturbed.walker, 0, 0));
    difference.push_back(to_double(robot.walker.targets()[leg[joint]]) -
                         to_double(undisturbed.walker.targets()[leg[joint]]));
  }
  return difference;
}

// In the second half of the swing, but for what the slow mean of the lean has taken up: a hundredth a cycle.
// It fades within five cycles of the landing.
TEST(WalkerLevelling, HoldsTheSwingFootsSoleLevelAgainstTheLean) {
  WalkParameters parameters = capturing(0, 0);
  parameters.reaction.level_swing = 900;
  const auto leaning = [](const Walker& walker) {
    Observation seen = beside_the_plan(walker, 0, 0);
    seen.pitch = from_double<Angle>(0.1);  // more than planned
    seen.roll = from_double<Angle>(-0.05);
    return seen;
  };
  const auto pitch = ankle_difference_rad(parameters, kAnklePitch, leaning);
  const auto roll = ankle_difference_rad(parameters, kAnkleRoll, leaning);
  EXPECT_NEAR(pitch[5], 0.0, 1e-6);
  const double share = 0.9 * std::pow(0.99, 24);
  EXPECT_NEAR(pitch[23], -0.1 * share, 0.001);
  EXPECT_NEAR(roll[23], 0.05 * share, 0.001);
  EXPECT_LT(pitch[26], -0.01);
  EXPECT_LT(pitch[26], pitch[28]);
  for (std::size_t tick = 32; tick < 52; ++tick) EXPECT_NEAR(pitch[tick], 0.0, 1e-6) << tick;
}

// The ankle presses where the error is, by the compliance of the servo, and no further than the sole reaches.
TEST(WalkerZmp, MovesTowardsTheErrorWithinTheSole) {
  WalkParameters parameters = capturing(0, 0);
  parameters.posture.pitch_compliance = 1000;
  parameters.posture.roll_compliance = 1000;
  parameters.reaction.zmp_tracking_forward = 500;
  parameters.reaction.zmp_tracking_lateral = 1000;
  parameters.reaction.max_zmp_shift_forward = 150;
  parameters.reaction.max_zmp_shift_lateral = 100;
  const auto ankle_rad = [&](std::size_t joint, double x_m, double y_m) {
    // The second step: the left foot supports.
    return ankle_difference_rad(parameters, joint,
                                [&](const Walker& walker) { return beside_the_plan(walker, x_m, y_m); })[45];
  };
  // What the mean of the step has not taken up: it is the first one in this support.
  EXPECT_NEAR(ankle_rad(kAnklePitch, 0.02, 0), 0.01, 1e-4);
  EXPECT_NEAR(ankle_rad(kAnklePitch, -0.02, 0), -0.01, 1e-4);
  EXPECT_NEAR(ankle_rad(kAnklePitch, 0.05, 0), 0.015, 1e-4);
  EXPECT_NEAR(ankle_rad(kAnkleRoll, 0, 0.005), -0.005, 1e-4);
  EXPECT_NEAR(ankle_rad(kAnkleRoll, 0, 0.03), -0.01, 1e-4);
}

// What the servos take from a step is added to its plan: a share backward and to the side, a length forward.
TEST(WalkerLengthening, AddsToThePlanWhatTheServosTake) {
  WalkParameters parameters = rigid();
  parameters.step.lengthening = 100;
  parameters.step.forward_offset = 50;
  const auto last_two = [&](const Velocity& command) {
    WalkingRobot robot(parameters);
    while (robot.landings.size() < 20 && robot.advance_until_landing(command)) {
    }
    return std::pair{robot.landings.at(18), robot.landings.at(19)};
  };
  constexpr double kTwoSteps_s = 0.52;
  constexpr double kTwoOffsets_m = 0.01;
  const auto forward = last_two({200, 0, 0});
  EXPECT_NEAR(forward.first.p.x + forward.second.p.x, kTwoSteps_s * 0.2 + kTwoOffsets_m, 0.1e-3);
  const auto backward = last_two({-200, 0, 0});
  EXPECT_NEAR(backward.first.p.x + backward.second.p.x, -kTwoSteps_s * 0.22 + kTwoOffsets_m, 0.1e-3);
  const auto left = last_two({0, 60, 0});
  EXPECT_NEAR(left.first.p.y + left.second.p.y, kTwoSteps_s * 0.066, 0.1e-3);
  const auto turn = last_two({0, 0, 500});
  EXPECT_NEAR(turn.first.yaw_rad + turn.second.yaw_rad, kTwoSteps_s * 0.5, 1e-4);
}

TEST(WalkerLengthening, EndsWithTheFeetSideBySide) {
  WalkParameters parameters = rigid();
  parameters.step.forward_offset = 90;
  WalkingRobot robot(parameters);
  for (int tick = 0; tick < 300; ++tick) robot.advance({100, 0, 0});
  robot.walker.stop();
  ASSERT_TRUE(robot.advance_to_the_end());
  EXPECT_NEAR(robot.landings.back().p.x, 0.0, 5e-3);
}

// Ticks between two landings, when the swing foot is loaded with `load_N` from the given tick after the
// first.
int step_ticks(std::int16_t threshold_cN, double load_N, int from_tick) {
  WalkParameters parameters = rigid();
  parameters.reaction.touchdown_load_cN = threshold_cN;
  WalkingRobot robot(parameters);
  while (robot.landings.size() < 4) robot.advance();
  const int begin = robot.landings.back().tick;
  const std::size_t swings = robot.landings.back().side == Side::kLeft ? kRight : kLeft;
  const auto stands_before = other(robot.landings.back().side);
  // The step ends when the other foot lifts off.
  while (robot.tick < begin + 60) {
    Observation seen;
    if (robot.tick - begin >= from_tick) seen.loads[swings] = from_double<Force>(load_N);
    robot.advance({}, seen);
    if (const auto now = robot.swing_side(); now && *now != stands_before) break;
  }
  return robot.tick - begin;
}

TEST(WalkerTouchdown, EndsAStepEarly) {
  const int in_time = step_ticks(200, 0.0, 0);
  EXPECT_EQ(in_time, 26 + 3 + 1);  // one step and the double support of the next
  EXPECT_EQ(step_ticks(200, 3.0, 20), in_time - 26 + 21);
  EXPECT_EQ(step_ticks(200, 1.9, 20), in_time);
  EXPECT_EQ(step_ticks(0, 3.0, 20), in_time);  // off
}

// 0.6 of the 23 cycles of swing, after 3 cycles of double support.
TEST(WalkerTouchdown, IsIgnoredEarlyInTheSwing) {
  EXPECT_EQ(step_ticks(200, 3.0, 0), step_ticks(200, 0.0, 0) - 26 + 17);
}

// The mass has then moved less than planned: the next step lands further out, and the following ones are as
// before.
TEST(WalkerTouchdown, IsCompensatedByTheNextStep) {
  WalkParameters parameters = rigid();
  parameters.reaction.touchdown_load_cN = 200;
  WalkingRobot robot(parameters);
  while (robot.landings.size() < 4) robot.advance();
  const std::size_t swings = robot.landings.back().side == Side::kLeft ? kRight : kLeft;
  for (int tick = 0; tick < 24; ++tick) robot.advance();
  Observation seen;
  seen.loads[swings] = from_double<Force>(3.0);
  robot.advance({}, seen);
  for (int step = 0; step < 6; ++step) ASSERT_TRUE(robot.advance_until_landing());
  EXPECT_GT(std::abs(robot.landings[5].p.y), 0.08);
  for (std::size_t i = 6; i < robot.landings.size(); ++i) {
    EXPECT_EQ(robot.landings[i].tick - robot.landings[i - 1].tick, 26);
    EXPECT_NEAR(std::abs(robot.landings[i].p.y), 0.066, 0.1e-3);
  }
}

// Returns the heading error at the end of a walk that begins with a disturbance of `turned_rad` in yaw. The
// simulated gyro measures the disturbance and the rotation of the trunk over the support foot.
double heading_left_rad(std::int16_t heading_hold, double turned_rad, const Velocity& command = {}) {
  WalkParameters parameters = rigid();
  parameters.reaction.heading_hold = heading_hold;
  WalkingRobot robot(parameters);
  while (robot.landings.size() < 2) robot.advance();
  constexpr int kShoveTicks = 10;
  constexpr double kTick_s = 0.01;
  double heading_rad = 0.0;
  double turn_rad = 0.0;  // in the last tick
  const auto trunk_yaw_rad = [&](Side from) {
    return test::yaw_rad(robot.posed().trunk_axis({1, 0, 0}, from));
  };
  for (int tick = 0; tick < 1'500; ++tick) {
    const double shove_rad = tick < kShoveTicks ? turned_rad / kShoveTicks : 0.0;
    // A foot that still supports after this tick did not move during it.
    const std::array before{trunk_yaw_rad(Side::kLeft), trunk_yaw_rad(Side::kRight)};
    const auto swung = robot.swing_side();
    robot.advance(command, turning(turn_rad + shove_rad));
    const auto swings = robot.swing_side();
    const Side stands = swings ? other(*swings) : swung ? other(*swung) : Side::kLeft;
    turn_rad = trunk_yaw_rad(stands) - before[static_cast<std::size_t>(stands)];
    heading_rad += turn_rad + shove_rad;
  }
  return heading_rad - 1e-3 * command.turn_mrad_per_s * 1'500 * kTick_s;
}

TEST(WalkerHeading, CorrectsADisturbedHeading) {
  EXPECT_NEAR(heading_left_rad(300, 0.3), 0.0, 0.02);
  EXPECT_NEAR(heading_left_rad(300, -0.3), 0.0, 0.02);
}

TEST(WalkerHeading, StaysTurnedWithoutHeadingControl) { EXPECT_NEAR(heading_left_rad(0, 0.3), 0.3, 1e-3); }

// The error is reduced by the lag during a turn.
TEST(WalkerHeading, AlsoHoldsACurve) { EXPECT_NEAR(heading_left_rad(300, 0.3, {0, 0, 300}), 0.0, 0.15); }

}  // namespace
}  // namespace koboshi::walk
