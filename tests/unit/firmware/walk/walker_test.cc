#include "firmware/walk/walker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/tuned_gait.h"
#include "tests/unit/firmware/robot/test_robot.h"
#include "tests/unit/firmware/walk/walking_robot.h"

namespace koboshi::walk {
namespace {

using fixed::Angle;
using fixed::to_double;
using hal::Side;
using test::kTickLength_s;
using test::rigid;
using test::WalkingRobot;

constexpr int kBlendTicks = 25;
constexpr double kWidth_m = 0.066;
constexpr double kStep_s = 0.26;

TEST(Walker, IsIdleBeforeItIsStarted) {
  const robot::RobotModel model = test::load_test_robot();
  Walker walker(model);
  EXPECT_FALSE(walker.running());
  walker.advance({100, 0, 0}, {});
  EXPECT_FALSE(walker.running());
}

// The standing pose fades into that of the plan, without a jump, while the weight is shifted.
TEST(Walker, BendsItsKneesWhileItBegins) {
  constexpr double kFastest_rad_per_s = 2 * 7.48;
  WalkingRobot robot;
  EXPECT_EQ(robot.targets(), robot.standing);
  std::vector<Angle> last = robot.standing;
  for (int tick = 0; tick < kBlendTicks; ++tick) {
    robot.advance();
    for (std::size_t joint = 0; joint < last.size(); ++joint)
      ASSERT_LE(std::abs(to_double(robot.targets()[joint] - last[joint])), kFastest_rad_per_s * kTickLength_s)
          << "joint " << joint << ", tick " << tick;
    last = robot.targets();
  }
  EXPECT_NEAR(robot.posed().com(robot.swing_side() == Side::kLeft ? Side::kRight : Side::kLeft).z, 0.17,
              2e-3);
}

TEST(Walker, LiftsAFootWithin400MillisecondsOfItsStart) {
  for (const auto& parameters : {rigid(), test::tuned_gait()}) {
    WalkingRobot robot(parameters);
    while (!robot.walker.swing_foot() && robot.tick < 100) robot.advance();
    EXPECT_LE(robot.tick, 40);
  }
}

TEST(Walker, ShiftsItsWeightToTheLeftAndStepsWithTheRightFirst) {
  WalkingRobot robot;
  double furthest_right_m = 0.0;
  while (!robot.walker.swing_foot()) {
    ASSERT_LT(robot.tick, kBlendTicks + 60);
    robot.advance();
    furthest_right_m = std::min(furthest_right_m, robot.posed().com(Side::kLeft).y + kWidth_m / 2);
  }
  EXPECT_EQ(robot.walker.swing_foot(), Side::kRight);
  EXPECT_GT(robot.posed().com(Side::kLeft).y, -kWidth_m / 2);
  EXPECT_GT(furthest_right_m, -3e-3);  // the mass first moves towards the support foot, not away from it
}

TEST(Walker, MarchesOnTheSpotInTime) {
  WalkingRobot robot;
  for (int step = 0; step < 20; ++step) ASSERT_TRUE(robot.advance_until_landing());
  for (std::size_t i = 1; i < robot.landings.size(); ++i) {
    const auto& landing = robot.landings[i];
    EXPECT_EQ(landing.side, other(robot.landings[i - 1].side));
    EXPECT_EQ(landing.tick - robot.landings[i - 1].tick, 26);
    EXPECT_NEAR(landing.p.x, 0.0, 50e-6);
    EXPECT_NEAR(std::abs(landing.p.y), kWidth_m, 50e-6);
    EXPECT_NEAR(landing.yaw_rad, 0.0, 1e-6);
  }
}

// In single support the planned ZMP is that under the support foot: 8 mm in front of the ankle, 2 mm inwards.
TEST(Walker, PlansItsZmpUnderTheSupportFoot) {
  WalkingRobot robot;
  EXPECT_FALSE(Walker(robot.model).planned_zmp());
  for (int step = 0; step < 4; ++step) {
    do robot.advance();
    while (!robot.swing_side());
    const auto planned = robot.walker.planned_zmp();
    ASSERT_TRUE(planned);
    const Side support = other(*robot.swing_side());
    EXPECT_EQ(planned->sole, support);
    EXPECT_NEAR(to_double(planned->p.x), 8e-3, 1e-6);
    EXPECT_NEAR(to_double(planned->p.y), support == Side::kLeft ? -2e-3 : 2e-3, 1e-6);
    // The plan goes on without a jump when the other sole becomes its frame.
    ASSERT_TRUE(robot.advance_until_landing());
    const auto landed = robot.walker.planned_zmp();
    ASSERT_TRUE(landed);
    EXPECT_EQ(landed->sole, other(support));
    EXPECT_NEAR(std::abs(to_double(landed->p.y)), kWidth_m - 2e-3, 100e-6);
  }
  robot.walker.stop();
  while (robot.walker.running()) robot.advance();
  EXPECT_FALSE(robot.walker.planned_zmp());
}

// For any duration of double support, the next step corrects a deviation from the planned one.
TEST(Walker, MarchesOnTheSpotWithAnyDoubleSupport) {
  for (const int permille : {0, 100, 200, 300, 400, 500}) {
    auto parameters = rigid();
    parameters.step.double_support = static_cast<std::int16_t>(permille);
    WalkingRobot robot(parameters);
    for (int step = 0; step < 20; ++step) ASSERT_TRUE(robot.advance_until_landing()) << permille;
    for (std::size_t i = 2; i < robot.landings.size(); ++i) {
      EXPECT_NEAR(std::abs(robot.landings[i].p.y), kWidth_m, 50e-6) << permille;
    }
  }
}

// Checks the displacement and the turn of each pair of steps once the velocity is reached.
void expect_pace(const Velocity& command, double forward_m_per_s, double left_m_per_s,
                 double turn_rad_per_s) {
  WalkingRobot robot;
  for (int step = 0; step < 30; ++step) ASSERT_TRUE(robot.advance_until_landing(command));
  for (std::size_t i = 20; i + 1 < robot.landings.size(); i += 2) {
    const auto& first = robot.landings[i];
    const auto& second = robot.landings[i + 1];
    EXPECT_NEAR(first.p.x + second.p.x, 2 * kStep_s * forward_m_per_s, 0.1e-3);
    EXPECT_NEAR(first.p.y + second.p.y, 2 * kStep_s * left_m_per_s, 0.1e-3);
    EXPECT_NEAR(first.yaw_rad + second.yaw_rad, 2 * kStep_s * turn_rad_per_s, 1e-5);
  }
}

TEST(Walker, ReachesTheCommandedVelocity) {
  expect_pace({200, 0, 0}, 0.2, 0, 0);
  expect_pace({-150, 0, 0}, -0.15, 0, 0);
  expect_pace({0, 80, 0}, 0, 0.08, 0);
  expect_pace({0, -80, 0}, 0, -0.08, 0);
  expect_pace({100, 50, 0}, 0.1, 0.05, 0);
}

TEST(Walker, TurnsAtTheCommandedRate) {
  for (const std::int16_t turn_mrad_per_s : {std::int16_t{1'000}, std::int16_t{-1'000}}) {
    WalkingRobot robot;
    for (int step = 0; step < 30; ++step) ASSERT_TRUE(robot.advance_until_landing({0, 0, turn_mrad_per_s}));
    for (std::size_t i = 20; i + 1 < robot.landings.size(); i += 2) {
      const double turned_rad = robot.landings[i].yaw_rad + robot.landings[i + 1].yaw_rad;
      EXPECT_NEAR(turned_rad, 2 * kStep_s * 1e-3 * turn_mrad_per_s, 1e-5);
    }
  }
}

// A hundred steps with velocities that change at random times.
template <typename Check>
void walk_at_random(WalkingRobot& robot, std::uint32_t seed, const Velocity& most, const Check& check) {
  std::mt19937 random(seed);
  const auto draw = [&](int most_of_it) {
    return static_cast<std::int16_t>(std::uniform_int_distribution(-most_of_it, most_of_it)(random));
  };
  Velocity command;
  while (robot.tick < 100 + 100 * 26) {
    if (draw(25) == 0)
      command = {draw(most.forward_mm_per_s), draw(most.left_mm_per_s), draw(most.turn_mrad_per_s)};
    robot.advance(command);
    ASSERT_NO_FATAL_FAILURE(check()) << "seed " << seed << ", tick " << robot.tick;
  }
}

void expect_within_limits(const WalkingRobot& robot) {
  for (std::size_t joint = 0; joint < robot.model.joint_count; ++joint) {
    ASSERT_GE(robot.walker.targets()[joint], robot.model.joints[joint].lower) << "joint " << joint;
    ASSERT_LE(robot.walker.targets()[joint], robot.model.joints[joint].upper) << "joint " << joint;
  }
}

// All velocities within the limits.
TEST(Walker, KeepsToTheJointsLimitsAtAnyVelocity) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    WalkingRobot robot;
    walk_at_random(robot, seed, {300, 100, 1000}, [&] { expect_within_limits(robot); });
  }
}

// Within the reach of the legs at the default parameters: the mass stays between the feet and at its height,
// and no target changes faster than a servo can follow.
TEST(Walker, KeepsItsCentreOfMassOverItsFeetForAHundredStepsAtAnyVelocity) {
  constexpr double kFastest_rad_per_s = 2 * 7.48;
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    WalkingRobot robot;
    auto last = robot.targets();
    walk_at_random(robot, seed, {200, 60, 800}, [&] {
      expect_within_limits(robot);
      const auto swings = robot.swing_side();
      const Side stands = swings ? other(*swings) : Side::kLeft;
      const test::Point com = robot.posed().com(stands);
      ASSERT_NEAR(com.z, robot.tick <= kBlendTicks ? 0.175 : 0.171, 5e-3);
      ASSERT_LT(std::abs(com.x), 0.1);
      ASSERT_LT(std::abs(com.y), 0.08);
      const auto targets = robot.targets();
      for (std::size_t joint = 0; joint < targets.size(); ++joint) {
        const double way_rad = std::abs(to_double(targets[joint] - last[joint]));
        ASSERT_LE(way_rad, kFastest_rad_per_s * kTickLength_s) << "joint " << joint;
      }
      last = targets;
    });
    EXPECT_GE(robot.landings.size(), 99u);
    for (const auto& landing : robot.landings) {
      EXPECT_LE(std::abs(landing.p.x), 0.1301);
      EXPECT_LE(std::abs(landing.p.y), 0.1301);
      EXPECT_GE(std::abs(landing.p.y), 0.0579);
    }
  }
}

TEST(Walker, EndsAtTheStandingTargetsOnStop) {
  for (const int after_ticks : {0, 20, 60, 75, 130, 300, 307, 314, 321}) {
    WalkingRobot robot{test::tuned_gait()};
    for (int tick = 0; tick < after_ticks; ++tick) robot.advance({200, 50, 300});
    ASSERT_TRUE(robot.walker.running());
    EXPECT_NE(robot.targets(), after_ticks == 0 ? std::vector<Angle>() : robot.standing);
    robot.walker.stop();
    ASSERT_TRUE(robot.advance_to_the_end({200, 50, 300})) << after_ticks;  // regardless of other commands
    EXPECT_EQ(robot.targets(), robot.standing) << after_ticks;
  }
}

TEST(Walker, PutsItsFeetSideBySideBeforeItEnds) {
  WalkingRobot robot;
  for (int tick = 0; tick < 400; ++tick) robot.advance({200, 60, 500});
  robot.walker.stop();
  ASSERT_TRUE(robot.advance_to_the_end());
  const auto& last = robot.landings.back();
  EXPECT_NEAR(last.p.x, 0.0, 5e-3);
  EXPECT_NEAR(std::abs(last.p.y), kWidth_m, 5e-3);
  EXPECT_NEAR(last.yaw_rad, 0.0, 0.02);
}

TEST(Walker, ContinuesWhenTheStopIsRevoked) {
  WalkingRobot robot;
  for (int tick = 0; tick < 200; ++tick) robot.advance({200, 0, 0});
  robot.walker.stop();
  for (int tick = 0; tick < 30; ++tick) robot.advance({200, 0, 0});
  robot.walker.resume();
  EXPECT_FALSE(robot.advance_to_the_end({200, 0, 0}));
  const auto& landings = robot.landings;
  EXPECT_NEAR(landings[landings.size() - 1].p.x + landings[landings.size() - 2].p.x, 2 * kStep_s * 0.2,
              0.1e-3);
}

TEST(Walker, StopsOnceTheFeetAreSideBySide) {
  WalkingRobot robot;
  for (int tick = 0; tick < 200; ++tick) robot.advance();
  robot.walker.stop();
  ASSERT_TRUE(robot.advance_until_landing());
  robot.advance();
  robot.walker.resume();
  EXPECT_TRUE(robot.advance_to_the_end());
}

TEST(Walker, KeepsItsTargetsAfterAnAbort) {
  WalkingRobot robot;
  for (int tick = 0; tick < 200; ++tick) robot.advance({100, 0, 0});
  robot.walker.abort();
  EXPECT_FALSE(robot.walker.running());
  const auto targets = robot.targets();
  robot.advance({100, 0, 0});
  EXPECT_EQ(robot.targets(), targets);
}

TEST(Walker, RepeatsAWalkAfterAnotherWalk) {
  WalkParameters lively = test::tuned_gait();
  lively.reaction.capture_forward = 500;
  lively.reaction.capture_lateral = 500;
  lively.reaction.touchdown_load_cN = 200;
  lively.reaction.heading_hold = 300;
  const auto play = [](WalkingRobot& robot) {
    std::mt19937 random(7);
    std::vector<std::vector<Angle>> told;
    for (int tick = 0; tick < 600; ++tick) {
      const auto draw = [&](int most) {
        return static_cast<std::int16_t>(std::uniform_int_distribution(-most, most)(random));
      };
      const Observation seen{.roll = Angle::from_raw(draw(30'000) * 1'000),
                             .pitch = Angle::from_raw(draw(30'000) * 1'000),
                             .turn = Angle::from_raw(draw(30'000) * 30),
                             .loads = {fixed::Force::from_raw(draw(30'000) * 10), {}}};
      robot.advance({draw(200), draw(100), draw(800)}, seen);
      told.push_back(robot.targets());
    }
    return told;
  };
  WalkingRobot once{lively};
  const auto told = play(once);
  WalkingRobot again{lively};
  EXPECT_TRUE(play(again) == told);
  again.walker.start(lively, again.standing);  // in the middle of a walk
  EXPECT_TRUE(play(again) == told);
}

// Greatest height of the swing foot above the sole of the other one in the next step, in m.
double lift_m(WalkingRobot& robot) {
  double most_m = 0.0;
  const std::size_t landed = robot.landings.size();
  while (robot.landings.size() == landed) {
    robot.advance();
    if (const auto swing = robot.swing_side())
      most_m = std::max(most_m, robot.posed().sole(*swing, other(*swing)).z);
  }
  return most_m;
}

TEST(Walker, TakesChangedParametersWithinTwoSteps) {
  WalkingRobot robot;
  ASSERT_TRUE(robot.advance_until_landing());
  EXPECT_NEAR(lift_m(robot), 0.020, 0.5e-3);
  for (int tick = 0; tick < 8; ++tick) robot.advance();
  robot.parameters.step.height = 300;
  robot.parameters.step.time_ms = 300;
  robot.parameters.step.width = 700;
  EXPECT_NEAR(lift_m(robot), 0.020, 0.5e-3);  // of the step that had begun
  EXPECT_NEAR(lift_m(robot), 0.020, 0.5e-3);  // whose foot lands for the new one
  EXPECT_NEAR(lift_m(robot), 0.030, 0.5e-3);
  for (int step = 0; step < 6; ++step) ASSERT_TRUE(robot.advance_until_landing());
  const auto& last = robot.landings.back();
  EXPECT_EQ(last.tick - robot.landings[robot.landings.size() - 2].tick, 30);
  EXPECT_NEAR(std::abs(last.p.y), 0.070, 1e-4);
}

// As if the walk had begun with them, once the gait has become periodic.
TEST(Walker, WalksWithChangedParametersAsOneThatBeganWithThem) {
  auto changed = rigid();
  changed.step.time_ms = 240;
  changed.posture.com_height = 1650;
  changed.posture.trunk_pitch = 300;
  changed.posture.zmp_inward = 0;
  WalkingRobot other_robot;
  for (int tick = 0; tick < 200; ++tick) other_robot.advance({100, 0, 0});
  other_robot.parameters = changed;
  WalkingRobot robot(changed);
  const auto last_step_m = [](WalkingRobot& walking) {
    for (int step = 0; step < 20; ++step) EXPECT_TRUE(walking.advance_until_landing({100, 0, 0}));
    return walking.landings.back().p;
  };
  const test::Point one = last_step_m(robot);
  const test::Point two = last_step_m(other_robot);
  EXPECT_NEAR(one.x, two.x, 1e-4);
  EXPECT_NEAR(std::abs(one.y), std::abs(two.y), 1e-4);
  EXPECT_NEAR(to_double(robot.walker.pitch()), to_double(other_robot.walker.pitch()), 1e-9);
}

TEST(Walker, KeepsItsGaitWhileTheParametersAreNone) {
  WalkingRobot changed;
  WalkingRobot robot;
  for (int tick = 0; tick < 400; ++tick) {
    if (tick == 100) {
      changed.parameters.step.height = 300;
      changed.parameters.step.min_lateral =
          static_cast<std::int16_t>(changed.parameters.step.max_lateral + 1);
    }
    changed.advance({100, 0, 0});
    robot.advance({100, 0, 0});
    ASSERT_EQ(changed.targets(), robot.targets()) << tick;
  }
}

// A longer double support with the landing of a shorter one widened the steps by 60 mm; so it is one by 6 mm.
TEST(Walker, LandsForTheChangedParametersBeforeItUsesThem) {
  auto parameters = rigid();
  parameters.step.time_ms = 240;
  parameters.step.double_support = 70;
  WalkingRobot robot(parameters);
  for (int step = 0; step < 10; ++step) ASSERT_TRUE(robot.advance_until_landing({200, 0, 0}));
  robot.parameters.step.double_support = 200;
  for (int step = 0; step < 10; ++step) {
    ASSERT_TRUE(robot.advance_until_landing({200, 0, 0}));
    EXPECT_NEAR(std::abs(robot.landings.back().p.y), kWidth_m, 10e-3) << step;
  }
}

// Each alone, to the other end of what is sensible. By no more than a walk without changes, and 1 rad/s.
TEST(Walker, MovesNoJointByAJumpWhenTheCarriageChanges) {
  const auto change = [](WalkParameters& parameters, int number) {
    switch (number) {
      case 0:
        parameters.posture.com_height = 1600;
        break;
      case 1:
        parameters.posture.trunk_pitch = 1500;
        break;
      case 2:
        parameters.posture.trunk_pitch_by_speed = 2000;
        break;
      case 3:
        parameters.posture.pitch_compliance = 1200;
        break;
      case 4:
        parameters.posture.roll_compliance = 600;
        break;
      default:
        parameters.posture.arm_swing = 1000;
    }
  };
  const auto fastest = [&](int number) {
    WalkingRobot robot;
    for (int tick = 0; tick < 200; ++tick) robot.advance({150, 0, 0});
    if (number >= 0) change(robot.parameters, number);
    std::vector<Angle> last = robot.targets();
    std::vector<double> most_rad_per_s(last.size());
    for (int tick = 0; tick < 100; ++tick) {
      robot.advance({150, 0, 0});
      for (std::size_t joint = 0; joint < last.size(); ++joint)
        most_rad_per_s[joint] = std::max(
            most_rad_per_s[joint], std::abs(to_double(robot.targets()[joint] - last[joint])) / kTickLength_s);
      last = robot.targets();
    }
    return most_rad_per_s;
  };
  const std::vector<double> usual_rad_per_s = fastest(-1);
  for (int number = 0; number < 6; ++number) {
    const std::vector<double> changed_rad_per_s = fastest(number);
    for (std::size_t joint = 0; joint < usual_rad_per_s.size(); ++joint)
      EXPECT_LE(changed_rad_per_s[joint], usual_rad_per_s[joint] + 1.0)
          << "change " << number << ", joint " << joint;
  }
}

TEST(Walker, SwingsEachArmWithTheOppositeFoot) {
  auto parameters = rigid();
  parameters.posture.arm_swing = 1'000;
  WalkingRobot robot(parameters);
  for (int tick = 0; tick < 400; ++tick) {
    robot.advance({200, 0, 0});
    if (robot.tick <= kBlendTicks) continue;
    const double left_ahead_m = robot.posed().sole(Side::kLeft, Side::kRight).x;
    EXPECT_NEAR(to_double(robot.walker.targets()[12] - robot.standing[12]), left_ahead_m, 1e-5);
    EXPECT_NEAR(to_double(robot.walker.targets()[15] - robot.standing[15]), -left_ahead_m, 1e-5);
  }
}

TEST(Walker, SwingsAnArmByTheSignOfItsAxis) {
  auto parameters = rigid();
  parameters.posture.arm_swing = 1'000;
  WalkingRobot usual(parameters);
  robot::RobotModel model = usual.model;
  const std::size_t shoulder = *model.find(robot::JointRole::kLeftShoulderPitch);
  model.joints[shoulder].axis = -model.joints[shoulder].axis;
  Walker opposite(model);
  opposite.start(parameters, usual.standing);
  Angle largest;
  for (int tick = 0; tick < 400; ++tick) {
    usual.advance({200, 0, 0});
    Observation seen;
    seen.pitch = opposite.pitch();
    opposite.advance({200, 0, 0}, seen);
    const Angle swing = usual.walker.targets()[shoulder] - usual.standing[shoulder];
    EXPECT_EQ(opposite.targets()[shoulder] - usual.standing[shoulder], -swing) << tick;
    largest = std::max(largest, swing);
  }
  EXPECT_GT(to_double(largest), 0.01);
}

TEST(Walker, LeansFurtherAtHigherSpeed) {
  auto parameters = rigid();
  parameters.posture.trunk_pitch_by_speed = 0x1000;
  WalkingRobot robot(parameters);
  for (int tick = 0; tick < 400; ++tick) robot.advance({200, 0, 0});
  EXPECT_NEAR(to_double(robot.walker.pitch()), 2.0 * M_PI * (546.0 / 65536 + 0.2 / 16), 1e-6);
  const test::Point up = robot.posed().trunk_axis({0, 0, 1}, Side::kLeft);
  EXPECT_NEAR(std::atan2(up.x, up.z), to_double(robot.walker.pitch()), 1e-4);
}

}  // namespace
}  // namespace koboshi::walk
