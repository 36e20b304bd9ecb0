#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "sim_board/engine/common/friction.h"
#include "sim_board/engine/make_world.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The law, written once more: the force at a point that slides.
Vector2d sliding_force(const FrictionLaw& law, double normal, const Vector2d& velocity) {
  const Vector2d M(law.mu, law.mu2);
  return -normal * M.cwiseProduct(M).cwiseProduct(velocity) / M.cwiseProduct(velocity).norm();
}

TEST(FrictionRows, AreTheLinearisedLawOfSliding) {
  const FrictionLaw law{0.3, 0.7};
  const double normal_N = 5.0;
  for (int i = 0; i < 8; ++i) {
    const Vector2d velocity = 0.2 * Vector2d(std::cos(0.8 * i), std::sin(0.8 * i));
    const FrictionRows rows =
        friction_rows(law, {.normal = normal_N, .against = -velocity.normalized(), .speed = velocity.norm()});
    const Vector2d force = sliding_force(law, normal_N, velocity);
    EXPECT_NEAR(rows.first.dot(force), rows.bounds[0], 1e-9) << i;
    EXPECT_NEAR(rows.second().dot(force), rows.aside, 1e-9) << i;
    const double aside_m_per_s = 1e-7;
    const Vector2d turned = sliding_force(law, normal_N, velocity + aside_m_per_s * rows.second());
    EXPECT_NEAR(rows.softness * rows.second().dot(turned) + aside_m_per_s, rows.target(), 1e-10) << i;
    EXPECT_NEAR(rows.first.dot(turned - force), 0.0, 1e-9) << i;
  }
}

TEST(FrictionRows, HaveABoundAlongGroovesWithoutFrictionAcross) {
  const FrictionRows rows = friction_rows({0.5, 0.0}, {.normal = 4.0});
  EXPECT_EQ(rows.first, Vector2d::UnitX());
  EXPECT_EQ(rows.bounds, (std::array{2.0, 0.0}));
}

TEST(FrictionError, IsZeroOnlyForTheLaw) {
  const FrictionLaw law{0.3, 0.7};
  const Vector2d velocity(0.1, -0.2);
  const Vector2d force = sliding_force(law, 5.0, velocity);
  EXPECT_LT(friction_error(law, {5.0, force, velocity}, 1.0), 1e-12);
  EXPECT_LT(friction_error(law, {5.0, {1.0, 2.0}, Vector2d::Zero()}, 1.0), 1e-12);  // sticks
  EXPECT_GT(friction_error(law, {4.5, force, velocity}, 1.0), 0.4);                 // too large a force
  EXPECT_GT(friction_error(law, {5.5, force, velocity}, 1.0), 0.1);                 // too small a one
  EXPECT_GT(friction_error(law, {5.0, force, {0.2, -0.1}}, 1.0), 0.1);              // sideways
  EXPECT_GT(friction_error(law, {5.0, {0.0, 0.0}, velocity}, 1.0), 0.1);            // slides without force
}

TEST(FrictionGuess, FollowsFromTheSolution) {
  const FrictionLaw law{0.5, 0.5};
  const FrictionGuess sticks = better_guess(law, {4.0, {0.6, 0.8}, Vector2d::Zero()}, 1.0);
  EXPECT_EQ(sticks.speed, 0.0);
  EXPECT_LT((sticks.against - Vector2d(0.6, 0.8)).norm(), 1e-12);
  const FrictionGuess slides = better_guess(law, {4.0, {1.2, 1.6}, {-0.3, -0.4}}, 1.0);
  EXPECT_NEAR(slides.speed, 0.5, 1e-12);
  EXPECT_LT((slides.against - Vector2d(0.6, 0.8)).norm(), 1e-12);
  EXPECT_EQ(better_guess(law, {-1e-9, {0.0, 0.0}, {0.3, 0.0}}, 1.0).normal, 0.0);  // an open contact
}

constexpr int kDirections = 16;
constexpr double kSettle_s = 0.1;
constexpr double kMeasure_s = 0.1;

Vector2d direction(int index) {
  const double angle_rad = 2.0 * kPi * index / kDirections;
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

RobotDescription rough(RobotDescription robot) {
  for (LinkDescription& link : robot.links)
    for (BoxDescription& box : link.collisions) box.surface.friction = box.surface.friction_second = 2.0;
  return robot;
}

// The centre of mass is above the ground, so that friction shifts the load between the corners.
RobotDescription block() { return rough(sample_box(1.2, {0.2, 0.16, 0.1})); }
constexpr double kBlockHeight_m = 0.05;

// A plane of the given friction, under a gravity that is tilted as on a slope of this angle.
WorldOptions on_slope(Stepper stepper, double step_s, double height_m, double friction, double slope_rad,
                      const Vector2d& downhill) {
  WorldOptions options;
  options.stepper = stepper;
  options.step_s = step_s;
  options.X_WB.translation().z() = height_m;
  options.ground.surface.friction = options.ground.surface.friction_second = friction;
  options.gravity_W_m_per_s2.head<2>() = kGravity * std::sin(slope_rad) * downhill;
  options.gravity_W_m_per_s2.z() = -kGravity * std::cos(slope_rad);
  return options;
}

void hold_joints(World& world, const RobotDescription& robot) {
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    world.set_servo(static_cast<int>(j), {.rotor_inertia_kg_m2 = 0.0012, .friction_Nm = 20.0});
}

// The friction of a robot that slides on a slope beyond the friction angle, by its acceleration.
double sliding_friction(const RobotDescription& robot, const WorldOptions& options) {
  const auto world = make_world(robot, options);
  hold_joints(*world, robot);
  run(*world, kSettle_s);
  const Vector2d before_m_per_s = world->body(0).v_WCom_W.head<2>();
  run(*world, kMeasure_s);
  const Vector2d gained_m_per_s = world->body(0).v_WCom_W.head<2>() - before_m_per_s;
  const Vector3d& g = options.gravity_W_m_per_s2;
  return (g.head<2>().norm() - g.head<2>().normalized().dot(gained_m_per_s) / kMeasure_s) / -g.z();
}

// Speed of a robot that sticks on a slope, after it has settled.
double creep_m_per_s(const RobotDescription& robot, const WorldOptions& options) {
  const auto world = make_world(robot, options);
  hold_joints(*world, robot);
  run(*world, kSettle_s);
  const Vector3d before_m = world->body(0).X_WL.translation();
  run(*world, kMeasure_s);
  return (world->body(0).X_WL.translation() - before_m).head<2>().norm() / kMeasure_s;
}

struct Case {
  Stepper stepper;
  double step_ms;
};

std::string name_of_case(const testing::TestParamInfo<Case>& info) {
  return std::string(name_of(info.param.stepper)) + "At" +
         std::to_string(std::lround(1000.0 * info.param.step_ms)) + "us";
}

class FrictionOfABlock : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    if (GetParam().stepper == Stepper::kMujoco && !has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  }
  static WorldOptions slope(double friction, double share, int downhill) {
    return on_slope(GetParam().stepper, 0.001 * GetParam().step_ms, kBlockHeight_m, friction,
                    std::atan(share * friction), direction(downhill));
  }
};

TEST_P(FrictionOfABlock, IsMuInEveryDirectionOfSliding) {
  for (const double friction : {0.1, 0.3, 1.0})
    for (int i = 0; i < kDirections; ++i)
      EXPECT_NEAR(sliding_friction(block(), slope(friction, 1.05, i)), friction, 0.01 * friction)
          << "mu " << friction << ", direction " << i;
}

TEST_P(FrictionOfABlock, HoldsItBelowTheFrictionAngleInEveryDirection) {
  for (const double friction : {0.1, 0.3, 1.0})
    for (int i = 0; i < kDirections; ++i)
      EXPECT_LT(creep_m_per_s(block(), slope(friction, 0.99, i)), 1e-4)
          << "mu " << friction << ", direction " << i;
}

std::vector<Case> cases(std::initializer_list<Stepper> steppers) {
  std::vector<Case> all;
  for (const Stepper stepper : steppers)
    for (const double step_ms : {1.0, 0.25}) all.push_back({stepper, step_ms});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Steppers, FrictionOfABlock,
                         testing::ValuesIn(cases({Stepper::kWorld, Stepper::kLumped, Stepper::kMujoco})),
                         name_of_case);

// The robot's centre of mass is high, and two legs share the load.
class FrictionOfARobot : public FrictionOfABlock {
 protected:
  static WorldOptions slope(double share, int downhill) {
    return on_slope(GetParam().stepper, 0.001 * GetParam().step_ms, kSampleHumanoidHeight_m, kFriction,
                    std::atan(share * kFriction), direction(downhill));
  }
  static constexpr double kFriction = 0.3;
};

TEST_P(FrictionOfARobot, IsMuToTheSide) {
  for (const int i : {3, 4})
    EXPECT_NEAR(sliding_friction(rough(sample_humanoid()), slope(1.05, i)), kFriction, 0.01 * kFriction);
}

TEST_P(FrictionOfARobot, HoldsItBelowTheFrictionAngle) {
  for (const int i : {3, 4})
    EXPECT_LT(creep_m_per_s(rough(sample_humanoid()), slope(0.99, i)), 1e-4) << "direction " << i;
}

INSTANTIATE_TEST_SUITE_P(Steppers, FrictionOfARobot,
                         testing::ValuesIn(cases({Stepper::kWorld, Stepper::kLumped, Stepper::kMujoco})),
                         name_of_case);

// The force of a material with two coefficients lies on an ellipse and dissipates the most.
class FrictionOfGrooves : public FrictionOfABlock {
 protected:
  static constexpr double kAlong = 0.2;
  static constexpr double kAcross = 0.5;
  static constexpr double kTurned_rad = 0.4;
  static Vector2d along() { return {std::cos(kTurned_rad), std::sin(kTurned_rad)}; }
  static Vector2d across() { return {-along().y(), along().x()}; }
  static Vector2d scaled(const Vector2d& vector, double power) {
    return std::pow(kAlong, power) * along().dot(vector) * along() +
           std::pow(kAcross, power) * across().dot(vector) * across();
  }
  // Friction of the ellipse in this direction.
  static double radius(const Vector2d& direction) { return 1.0 / scaled(direction, -1.0).norm(); }
  static WorldOptions slope(double share, int downhill) {
    const double slope_rad = std::atan(share * radius(direction(downhill)));
    WorldOptions options = on_slope(GetParam().stepper, 0.001 * GetParam().step_ms, kBlockHeight_m, kAlong,
                                    slope_rad, direction(downhill));
    options.ground.surface.friction_second = kAcross;
    options.ground.surface.friction_direction = Vector3d(along().x(), along().y(), 0.0);
    return options;
  }
};

TEST_P(FrictionOfGrooves, IsTheForceOfTheEllipseThatDissipatesMost) {
  for (int i = 0; i < kDirections; ++i) {
    const auto world = make_world(block(), slope(1.3, i));
    run(*world, kSettle_s + kMeasure_s);
    Vector3d force_N = Vector3d::Zero();
    for (const Contact& contact : world->contacts()) force_N += contact.f_W;
    const Vector2d v = world->body(0).v_WCom_W.head<2>();
    const Vector2d expected_N = -force_N.z() * scaled(v, 2.0) / scaled(v, 1.0).norm();
    EXPECT_GT(v.norm(), 0.01) << i;
    EXPECT_LT((force_N.head<2>() - expected_N).norm(), 0.01 * expected_N.norm()) << i;
  }
}

TEST_P(FrictionOfGrooves, HoldsWithinTheEllipse) {
  for (int i = 0; i < kDirections; ++i) EXPECT_LT(creep_m_per_s(block(), slope(0.99, i)), 1e-4) << i;
}

INSTANTIATE_TEST_SUITE_P(Steppers, FrictionOfGrooves,
                         testing::ValuesIn(cases({Stepper::kWorld, Stepper::kLumped})), name_of_case);

}  // namespace
}  // namespace koboshi::sim_board
