#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "sim_board/engine/bodies/bounce_law.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

constexpr double kRadius_m = 0.0325;

FreeBodyDescription ball(double height_m, double bounce = 0.5) {
  FreeBodyDescription body{.name = "ball", .size_m = Vector3d::Constant(2.0 * kRadius_m), .mass_kg = 0.058};
  body.bounce = bounce;
  body.X_WF.translation() = Vector3d(3.0, 0.0, height_m);
  return body;
}

// Balls and boxes beside a robot of one box, which rests far from them, in each stepper.
class FreeBodies : public EachEngine {
 protected:
  static WorldOptions options_with(const FreeBodyDescription& body) {
    WorldOptions options = EachEngine::options();
    options.ground.surface.friction = options.ground.surface.friction_second = 1.0;
    options.X_WB.translation().z() = 0.05;
    options.free_bodies = {body};
    return options;
  }
  static std::unique_ptr<World> make(const WorldOptions& options, double robot_kg = 1.0) {
    return make_world(sample_box(robot_kg, Vector3d::Constant(0.1)), options);
  }
};
INSTANTIATE_TEST_SUITE_P(Steppers, FreeBodies,
                         testing::Values(Stepper::kWorld, Stepper::kLumped, Stepper::kMujoco), engine_name);

TEST_P(FreeBodies, FallAsGalileoSays) {
  const auto world = make(options_with(ball(2.0)));
  run(*world, 0.5);
  // Semi-implicit Euler falls half a part of a step more at each: g t dt / 2.
  EXPECT_NEAR(world->free_bodies()[0].X_WF.translation().z(), 2.0 - 0.5 * kGravity * 0.25, 2e-4);
  EXPECT_NEAR(world->free_bodies()[0].v_WF_W.z(), -0.5 * kGravity, 1e-9);
}

TEST_P(FreeBodies, BounceByTheCoefficientOfRestitutionForTheTimeOfAContact) {
  for (const double e : {0.3, 0.5, 0.9}) {
    const double fall_m = 0.5;
    const auto world = make(options_with(ball(fall_m + kRadius_m, e)));
    const double impact_m_per_s = std::sqrt(2.0 * kGravity * fall_m);
    double left_m_per_s = 0.0;
    double touched_s = 0.0;
    while (world->time_s() < 1.0 && left_m_per_s == 0.0) {
      world->step();
      const FreeBodyState& state = world->free_bodies()[0];
      const bool touches = state.X_WF.translation().z() < kRadius_m;
      if (touches) touched_s += world->step_s();
      if (!touches && touched_s > 0.0) left_m_per_s = state.v_WF_W.z();
    }
    // The weight acts during the contact, and the flight goes on for up to a step.
    EXPECT_NEAR(left_m_per_s, e * impact_m_per_s, 0.02) << e;
    EXPECT_NEAR(touched_s, 0.005, 0.0016) << e;
  }
}

TEST_P(FreeBodies, BouncedHeightsFallByTheSquareOfTheRestitution) {
  const double e = 0.8;
  const auto world = make(options_with(ball(0.5 + kRadius_m, e)));
  std::array<double, 3> highest_m{};
  std::size_t bounces = 0;
  bool touched = false;
  while (world->time_s() < 3.0 && bounces <= 2) {
    world->step();
    const double height_m = world->free_bodies()[0].X_WF.translation().z() - kRadius_m;
    if (height_m < 0.0 && !touched) ++bounces;
    touched = height_m < 0.0;
    if (bounces > 0 && bounces <= 2) highest_m[bounces] = std::max(highest_m[bounces], height_m);
  }
  EXPECT_NEAR(highest_m[1], 0.5 * std::pow(e, 2), 0.005);
  EXPECT_NEAR(highest_m[2], 0.5 * std::pow(e, 4), 0.005);
}

// A ball that slides begins to roll after 2 v / (7 mu g), at 5/7 of its speed.
TEST_P(FreeBodies, SlidingTurnsIntoRollingAtFiveSeventhsOfTheSpeed) {
  FreeBodyDescription body = ball(kRadius_m);
  body.friction = 0.3;
  body.v_WF_W.x() = 1.4;
  const auto world = make(options_with(body));
  const double rolls_s = 2.0 * 1.4 / (7.0 * 0.3 * kGravity);
  run(*world, std::floor(800.0 * rolls_s) * 0.001);
  const FreeBodyState early = world->free_bodies()[0];
  EXPECT_NEAR(early.v_WF_W.x(), 1.4 - 0.3 * kGravity * world->time_s(), 0.01);
  EXPECT_GT(early.v_WF_W.x() - early.w_WF_W.y() * kRadius_m, 0.1) << "still slides";
  run(*world, 1.0);
  const FreeBodyState state = world->free_bodies()[0];
  EXPECT_NEAR(state.v_WF_W.x(), 1.0, 0.005);
  EXPECT_NEAR(state.w_WF_W.y() * kRadius_m, state.v_WF_W.x(), 0.002);
  EXPECT_NEAR(state.v_WF_W.y(), 0.0, 1e-9);
}

TEST_P(FreeBodies, RollDownASlopeAtFiveSeventhsOfTheSlidingAcceleration) {
  const double slope_rad = 0.1;
  WorldOptions options = options_with(ball(0.0));
  options.ground.normal_W = Vector3d(std::sin(slope_rad), 0.0, std::cos(slope_rad));
  options.free_bodies[0].X_WF.translation() = kRadius_m * options.ground.normal_W;
  options.X_WB.translation() = Vector3d(-2.0, 0.0, 2.0);
  const auto world = make(options);
  run(*world, 1.0);
  const double expected_m_per_s = 5.0 / 7.0 * kGravity * std::sin(slope_rad);
  EXPECT_NEAR(world->free_bodies()[0].v_WF_W.norm(), expected_m_per_s, 0.01 * expected_m_per_s);
}

// With the resistance c, a ball slows down by 5/7 c g, and holds on a slope whose tangent is less than c.
TEST_P(FreeBodies, RollingFrictionStopsABallAndHoldsItOnASlope) {
  FreeBodyDescription body = ball(kRadius_m);
  body.rolling_friction = 0.05;
  body.v_WF_W.x() = 1.0;
  WorldOptions options = options_with(body);
  const auto level = make(options);
  run(*level, 0.3);  // it rolls
  const double before_m_per_s = level->free_bodies()[0].v_WF_W.x();
  run(*level, 0.5);
  const double slowing = 5.0 / 7.0 * 0.05 * kGravity;
  EXPECT_NEAR(before_m_per_s - level->free_bodies()[0].v_WF_W.x(), 0.5 * slowing, 0.01);
  run(*level, 3.0);
  EXPECT_LT(level->free_bodies()[0].v_WF_W.norm(), 1e-3);

  options.free_bodies[0].v_WF_W.setZero();
  options.ground.normal_W = Vector3d(0.04, 0.0, 1.0).normalized();
  options.free_bodies[0].X_WF.translation() = kRadius_m * options.ground.normal_W;
  options.X_WB.translation() = Vector3d(-2.0, 0.0, 2.0);
  const auto slope = make(options);
  run(*slope, 2.0);
  EXPECT_LT((slope->free_bodies()[0].X_WF.translation() - options.free_bodies[0].X_WF.translation()).norm(),
            1e-3);
}

// A box holds below the friction angle and slides by g (sin - mu cos) beyond it.
TEST_P(FreeBodies, ABoxHoldsOnASlopeUpToTheFrictionAngle) {
  const double mu = 0.4;
  for (const double slope_rad : {0.3, 0.5}) {
    FreeBodyDescription box{.name = "box", .shape = FreeBodyDescription::Shape::kBox};
    box.size_m = Vector3d(0.1, 0.08, 0.03);
    box.mass_kg = 0.2;
    box.friction = mu;
    WorldOptions options = options_with(box);
    options.ground.normal_W = Vector3d(std::sin(slope_rad), 0.0, std::cos(slope_rad));
    options.free_bodies[0].X_WF =
        AngleAxisd(slope_rad, Vector3d::UnitY()) * Translation3d(0.0, 0.0, 0.5 * box.size_m.z());
    options.X_WB.translation() = Vector3d(-2.0, 0.0, 2.0);
    const auto world = make(options);
    const Vector3d from = world->free_bodies()[0].X_WF.translation();
    run(*world, 0.5);
    const double way_m = (world->free_bodies()[0].X_WF.translation() - from).norm();
    const double slides = kGravity * (std::sin(slope_rad) - mu * std::cos(slope_rad));
    if (slides < 0.0) {
      EXPECT_LT(way_m, 1e-4);
    } else {
      EXPECT_NEAR(way_m, 0.5 * slides * 0.25, 0.02 * way_m);
    }
  }
}

// Without gravity and ground, a ball of 58 g meets the robot at 2 m/s. The link's velocity lags by half a
// step in a contact of some 4 ms, which takes a share of the restitution: the more the lighter the robot is,
// and in proportion to the step.
TEST_P(FreeBodies, AndTheRobotPartWithTheCoefficientOfRestitutionAndTheirMomentum) {
  const auto restitution = [](double robot_kg, double step_s) {
    WorldOptions options = options_with(ball(0.0));
    options.step_s = step_s;
    options.ground.present = false;
    options.gravity_W_m_per_s2.setZero();
    options.X_WB = Isometry3d::Identity();
    options.free_bodies[0].X_WF.translation() = Vector3d(0.2, 0.0, 0.0);
    options.free_bodies[0].v_WF_W = Vector3d(-2.0, 0.0, 0.0);
    const auto world = make(options, robot_kg);
    bool touched = false;
    while (world->time_s() < 0.2) {
      world->step();
      touched = touched || world->links_at_free_bodies()[0] == 0;
    }
    EXPECT_TRUE(touched);
    EXPECT_EQ(world->links_at_free_bodies()[0], -1) << "apart again";
    const double ball_m_per_s = world->free_bodies()[0].v_WF_W.x();
    const double robot_m_per_s = world->body(0).v_WCom_W.x();
    EXPECT_NEAR(0.058 * ball_m_per_s + robot_kg * robot_m_per_s, -0.116, 1e-6) << robot_kg;
    return (ball_m_per_s - robot_m_per_s) / 2.0;
  };
  EXPECT_NEAR(restitution(3.0, 0.001), 0.5, 0.01);
  EXPECT_NEAR(restitution(0.3, 0.001), 0.5, 0.05);
  const double coarse = 0.5 - restitution(0.1, 0.001);
  EXPECT_NEAR(coarse, 0.083, 0.01);
  EXPECT_NEAR(0.5 - restitution(0.1, 0.0005), 0.5 * coarse, 0.3 * coarse);
  EXPECT_NEAR(restitution(0.1, 0.000125), 0.5, 0.015);
}

TEST_P(FreeBodies, OfEqualMassExchangeTheirSpeeds) {
  WorldOptions options = options_with(ball(0.0, 1.0));
  options.ground.present = false;
  options.gravity_W_m_per_s2.setZero();
  options.free_bodies[0].v_WF_W = Vector3d(1.0, 0.0, 0.0);
  options.free_bodies.push_back(ball(0.0, 1.0));
  options.free_bodies[1].X_WF.translation().x() += 0.1;
  const auto world = make(options);
  run(*world, 0.2);
  EXPECT_NEAR(world->free_bodies()[0].v_WF_W.x(), 0.0, 0.002);
  EXPECT_NEAR(world->free_bodies()[1].v_WF_W.x(), 1.0, 0.002);
}

TEST_P(FreeBodies, LieStillOnEachOther) {
  FreeBodyDescription box{.name = "box", .shape = FreeBodyDescription::Shape::kBox};
  box.size_m = Vector3d(0.2, 0.2, 0.1);
  box.X_WF.translation() = Vector3d(3.0, 0.0, 0.05);
  WorldOptions options = options_with(box);
  options.free_bodies.push_back(ball(0.1 + kRadius_m + 0.02));
  const auto world = make(options);
  run(*world, 2.0);
  EXPECT_NEAR(world->free_bodies()[1].X_WF.translation().z(), 0.1 + kRadius_m, 1e-3);
  EXPECT_LT(world->free_bodies()[1].v_WF_W.norm(), 1e-3);
  EXPECT_NEAR(world->free_bodies()[0].X_WF.translation().z(), 0.05, 1e-3);
}

TEST_P(FreeBodies, ContinueWithTheSameBitsAfterASnapshot) {
  FreeBodyDescription thrown = ball(0.2);
  thrown.X_WF.translation().x() = 0.4;
  thrown.v_WF_W = Vector3d(-2.5, 0.1, 0.0);
  const auto world = make(options_with(thrown));
  const auto bits = [&] {
    std::vector<std::uint64_t> all;
    for (int i = 0; i < 150; ++i) {
      world->step();
      for (const Eigen::Matrix4d& pose :
           {world->free_bodies()[0].X_WF.matrix(), world->body(0).X_WL.matrix()}) {
        for (Eigen::Index k = 0; k < pose.size(); ++k)
          all.push_back(std::bit_cast<std::uint64_t>(pose.data()[k]));
      }
    }
    return all;
  };
  run(*world, 0.14);  // about to hit the robot
  const SavedState saved = StateArchive::save(*world);
  const auto first = bits();
  StateArchive::restore(saved, *world);
  EXPECT_EQ(bits(), first);
}

TEST_P(FreeBodies, RefuseGroundsThatTheyDoNotKnow) {
  WorldOptions options = options_with(ball(0.2));
  options.ground.patches.emplace_back();
  EXPECT_THROW(static_cast<void>(make(options)), std::invalid_argument);
  options.ground.patches.clear();
  options.free_bodies[0].mass_kg = 0.0;
  EXPECT_THROW(static_cast<void>(make(options)), std::invalid_argument);
}

// The first integral of the law's motion, at both ends of the contact.
TEST(BounceLaw, ReturnsTheRestitutionWhateverTheMassAndSpeedAre) {
  for (const double e : {0.02, 0.1, 0.5, 0.9, 0.99}) {
    const double lambda = bounce_damping(e);
    const double stiffness = 2.0e4;
    for (const double mass_kg : {0.05, 2.0}) {
      for (const double speed_m_per_s : {0.1, 5.0}) {
        const double part_s = 1e-3 * std::sqrt(mass_kg / stiffness);
        double depth_m = 0.0;
        double rate = speed_m_per_s;
        do {
          const double force_N = stiffness * depth_m * (1.0 + lambda * rate / speed_m_per_s);
          EXPECT_GE(force_N, 0.0);
          rate -= part_s * force_N / mass_kg;
          depth_m += part_s * rate;
        } while (depth_m > 0.0);
        EXPECT_NEAR(-rate / speed_m_per_s, e, 0.002) << mass_kg << " kg, " << speed_m_per_s << " m/s";
      }
    }
  }
  EXPECT_EQ(bounce_damping(1.0), 0.0);
}

}  // namespace
}  // namespace koboshi::sim_board
