#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim_board/engine/common/normal_row.h"
#include "sim_board/engine/make_world.h"
#include "sim_board/world/ground_truth.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

constexpr double kSteps_s[] = {0.001, 0.0005, 0.00025, 0.000125};

struct Surface {
  const char* name;
  double error_reduction;
  double force_mixing;
};
constexpr Surface kHard{"hard", 0.2, 0.0};
constexpr Surface kDefault{"default", 0.2, 1e-4};  // robots/koboshi
constexpr Surface kSoft{"soft", 0.3, 2e-3};

SurfaceDescription surface_of(const Surface& sole, double restitution) {
  SurfaceDescription surface;
  surface.error_reduction = sole.error_reduction;
  surface.constraint_force_mixing = sole.force_mixing;
  surface.bounce = restitution;
  return surface;
}

// Every stepper, or those that this program was built with.
class BounceInEachStepper : public EachEngine {
 protected:
  static WorldOptions options_of(double step_s) {
    WorldOptions options = EachEngine::options();
    options.step_s = step_s;
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(Steppers, BounceInEachStepper,
                         testing::Values(Stepper::kWorld, Stepper::kLumped, Stepper::kMujoco), engine_name);

// A body that falls on the ground.
struct Fall {
  RobotDescription robot;
  std::unique_ptr<World> world;

  Fall(WorldOptions options, const Vector3d& size_m, const Isometry3d& X_WB,
       const SurfaceDescription& surface)
      : robot(sample_box(1.2, size_m)) {
    robot.links[0].collisions[0].surface = surface;
    options.ground.surface = surface;
    options.X_WB = X_WB;
    world = make_world(robot, options);
  }

  double speed_up() const { return world->body(0).v_WCom_W.z(); }
};

const Vector3d kFoot_m(0.1, 0.056, 0.01);

// Speed after the first impact over the speed before it.
double restitution_of_fall(const WorldOptions& options, double fall_m, const SurfaceDescription& surface) {
  Fall fall(options, kFoot_m, Isometry3d(Translation3d(0, 0, fall_m + 0.5 * kFoot_m.z())), surface);
  double before = 0.0;
  while (fall.world->time_s() < 1.0) {
    before = -fall.speed_up();
    fall.world->step();
    if (fall.speed_up() > 0.0) return fall.speed_up() / before;
  }
  return std::nan("");
}

TEST_P(BounceInEachStepper, LeavesWithTheCoefficientOfRestitutionAtAnyStepAndStiffness) {
  for (const Surface& sole : {kHard, kDefault, kSoft})
    for (const double e : {0.9, 0.5, 0.3})
      for (const double step_s : kSteps_s)
        EXPECT_NEAR(restitution_of_fall(options_of(step_s), 0.1, surface_of(sole, e)), e, 0.01 * e)
            << sole.name << ", step " << step_s;
}

// Largest speed away from the ground after an impact without restitution.
double rebound_m_per_s(Fall& fall) {
  double most = 0.0;
  while (fall.world->time_s() < 0.4) {
    fall.world->step();
    most = std::max(most, fall.speed_up());
  }
  return most;
}

// Rebound of a mass on the four springs and dampers of a sole, which cannot pull, by steps of a microsecond.
double rebound_of_spring_m_per_s(const Surface& sole, double mass_kg, double fall_m) {
  const SurfaceDescription surface = surface_of(sole, 0.0);
  const Softness point = contact_between(surface, surface, 0.001).softness;
  const double stiffness = 4.0 * point.error_reduction / (0.001 * point.constraint_force_mixing);
  const double damping = 4.0 * (1.0 - point.error_reduction) / point.constraint_force_mixing;
  constexpr double kStep_s = 1e-6;
  double z = 0.0, v = -std::sqrt(2.0 * kGravity * fall_m), most = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double free = v - kStep_s * kGravity;
    v = free;
    if (z < 0.0) {  // implicit in the damper, which is very hard
      const double held = (mass_kg * free - kStep_s * stiffness * z) / (mass_kg + kStep_s * damping);
      v = std::max(free, held);
    }
    z += kStep_s * v;
    most = std::max(most, v);
  }
  return most;
}

TEST_P(BounceInEachStepper, ReboundsWithoutRestitutionByNoMoreThanTheSpringGivesBack) {
  for (const double fall_m : {0.0213, 0.1, 0.1137}) {  // impacts at different moments of a step
    for (const Surface& sole : {kHard, kDefault, kSoft}) {
      const double spring_m_per_s = rebound_of_spring_m_per_s(sole, 1.2, fall_m);
      for (const double step_s : kSteps_s) {
        Fall fall(options_of(step_s), kFoot_m, Isometry3d(Translation3d(0, 0, fall_m + 0.005)),
                  surface_of(sole, 0.0));
        const double rebound = rebound_m_per_s(fall);
        EXPECT_LT(rebound, 1.05 * spring_m_per_s + 1e-5)
            << sole.name << ", step " << step_s << ", from " << fall_m;
        // An implicit step damps; the error is of first order.
        EXPECT_GT(rebound, (0.95 - 800.0 * step_s) * spring_m_per_s - 1e-3)
            << sole.name << ", step " << step_s << ", from " << fall_m;
      }
    }
  }
}

// A box that lands on a corner, then on its edges and faces.
Isometry3d tilted(double height_m) {
  return Translation3d(0, 0, height_m) * Eigen::AngleAxisd(0.6, Vector3d(1, 2, 0).normalized());
}

TEST_P(BounceInEachStepper, NeverAddsEnergyToATumblingBox) {
  for (const double e : {0.0, 0.5, 0.9}) {
    for (const double step_s : {0.001, 0.00025}) {
      const WorldOptions options = options_of(step_s);
      Fall fall(options, {0.1, 0.2, 0.3}, tilted(0.5), surface_of(kHard, e));
      // A step of semi-implicit Euler conserves E - (h/2) dV/dt.
      const auto energy = [&] {
        return energy_J(fall.robot, *fall.world, options.gravity_W_m_per_s2) -
               0.5 * step_s * 1.2 * kGravity * fall.speed_up();
      };
      const double start_J = energy();
      const double rounding_J = 1e-4 * start_J;
      // Between impacts the gyroscopic term changes the energy slightly.
      while (fall.world->time_s() < 2.0) {
        const double before_J = energy();
        fall.world->step();
        if (fall.world->contacts().empty()) continue;
        ASSERT_LT(energy(), before_J + rounding_J)
            << e << ", step " << step_s << " at " << fall.world->time_s();
      }
      EXPECT_LT(energy(), 0.9 * start_J);
    }
  }
}

// An impact on one edge of a rod without friction: an impulse (1 + e) v / (1/m + x^2/I).
TEST_P(BounceInEachStepper, TurnsARodThatLandsOnItsEdge) {
  const Vector3d size_m(0.3, 0.05, 0.02);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.5, Vector3d::UnitY()).toRotationMatrix();
  const Vector3d p_edge = R * Vector3d(0.5 * size_m.x(), 0.0, -0.5 * size_m.z());
  for (const Surface& sole : {kHard, kSoft}) {
    for (const double step_s : kSteps_s) {
      Isometry3d X_WB(Translation3d(0, 0, 0.2 - p_edge.z()));
      X_WB.linear() = R;
      SurfaceDescription surface = surface_of(sole, 0.6);
      surface.friction = surface.friction_second = 0.0;
      Fall fall(options_of(step_s), size_m, X_WB, surface);
      double speed = 0.0;
      while (fall.world->body(0).w_WL_W.norm() == 0.0 && fall.world->time_s() < 1.0) {
        speed = -fall.speed_up();
        fall.world->step();
      }
      const double inertia = fall.robot.links[0].I_LCom_L(1, 1);
      const double impulse_a_speed = 1.6 / (1.0 / 1.2 + p_edge.x() * p_edge.x() / inertia);
      EXPECT_NEAR(fall.world->body(0).w_WL_W.y(), -impulse_a_speed * speed * p_edge.x() / inertia,
                  0.01 * impulse_a_speed * speed * p_edge.x() / inertia)
          << sole.name << ", step " << step_s;
    }
  }
}

// A foot that lands half on a block.
TEST_P(BounceInEachStepper, LandsOnTheEdgeOfABlockWithoutAKick) {
  for (const double step_s : kSteps_s) {
    WorldOptions options = options_of(step_s);
    options.ground.boxes.push_back(
        {.X_WG = Isometry3d(Translation3d(-0.1, 0, 0.05)), .size_m = {0.24, 0.2, 0.1}, .surface = {}});
    Fall fall(options, kFoot_m, Isometry3d(Translation3d(0, 0, 0.2)), surface_of(kDefault, 0.0));
    EXPECT_LT(rebound_m_per_s(fall), 0.02) << step_s;
  }
}

// A lid on a hinge that falls on its base. Two more hinges, which stick, lie between them, so that they
// collide.
RobotDescription lid_on_base(const SurfaceDescription& surface) {
  RobotDescription robot = sample_box(1.0, {0.3, 0.1, 0.02});
  robot.links.push_back(sample_box(0.01, {0.02, 0.02, 0.02}).links[0]);
  robot.links[1].collisions.clear();
  robot.links.push_back(robot.links[1]);
  robot.links.push_back(sample_box(0.3, {0.02, 0.1, 0.02}).links[0]);
  const Vector3d p_hinge(0.0, 0.0, 0.05);
  for (std::size_t l = 1; l < robot.links.size(); ++l) {
    robot.links[l].X_ML.translation() = p_hinge;
    JointDescription joint;
    joint.parent = static_cast<int>(l) - 1;
    joint.child = static_cast<int>(l);
    joint.p_MJ = p_hinge;
    joint.axis_M = Vector3d::UnitY();
    joint.lower_rad = -1.0;
    joint.upper_rad = 1.0;
    robot.joints.push_back(joint);
  }
  robot.links[3].X_ML.translation().x() = 0.1;
  for (const std::size_t l : {0U, 3U}) robot.links[l].collisions[0].surface = surface;
  return robot;
}

TEST_P(BounceInEachStepper, LinksLeaveEachOtherWithTheCoefficientOfRestitution) {
  for (const Surface& sole : {kHard, kSoft}) {
    for (const double step_s : kSteps_s) {
      WorldOptions options = options_of(step_s);
      options.ground.present = false;
      options.fixed_base = true;
      const auto world = make_world(lid_on_base(surface_of(sole, 0.5)), options);
      for (const int joint : {0, 1}) world->set_servo(joint, {.friction_Nm = 1e4});
      double before = 0.0;
      while (world->joint(2).speed_rad_per_s >= 0.0 && world->time_s() < 1.0) {
        before = world->joint(2).speed_rad_per_s;
        world->step();
      }
      EXPECT_GT(before, 3.0) << sole.name << ", step " << step_s;
      EXPECT_NEAR(world->joint(2).speed_rad_per_s, -0.5 * before, 0.01 * 0.5 * before)
          << sole.name << ", step " << step_s;
    }
  }
}

TEST_P(BounceInEachStepper, LeavesABlockAsItLeavesThePlane) {
  for (const double step_s : kSteps_s) {
    WorldOptions options = options_of(step_s);
    const SurfaceDescription surface = surface_of(kSoft, 0.5);
    options.ground.boxes.push_back(
        {.X_WG = Isometry3d(Translation3d(0, 0, 0.05)), .size_m = {0.06, 0.2, 0.1}, .surface = surface});
    EXPECT_NEAR(restitution_of_fall(options, 0.2, surface), 0.5, 0.005) << step_s;  // 0.1 m above the block
  }
}

// The energy guard ends a run that gains energy.
TEST_P(BounceInEachStepper, ARobotLandsOnOneFootAndComesToRest) {
  for (const double e : {0.0, 0.5, 0.9}) {
    RobotDescription robot = sample_humanoid();
    for (LinkDescription& link : robot.links)
      for (BoxDescription& box : link.collisions) box.surface = surface_of(kDefault, e);
    WorldOptions options = options_of(0.001);
    options.ground.surface = surface_of(kDefault, e);
    options.X_WB =
        Translation3d(0, 0, kSampleHumanoidHeight_m + 0.1) * Eigen::AngleAxisd(0.2, Vector3d::UnitX());
    const auto world = make_world(robot, options);
    for (int j = 0; j < static_cast<int>(robot.joints.size()); ++j)
      world->set_servo(j, {.damping_Nm_s = 0.05, .rotor_inertia_kg_m2 = 1e-3, .friction_Nm = 0.3});
    const double start_J = energy_J(robot, *world, options.gravity_W_m_per_s2);
    EXPECT_NO_THROW(run(*world, 3.0)) << e;
    EXPECT_LT(energy_J(robot, *world, options.gravity_W_m_per_s2), start_J) << e;
    EXPECT_LT(centre_of_mass(robot, *world).v_WCom_W.norm(), 0.3) << e;
  }
}

// The row of a point.
SurfaceContact contact_of(const Surface& sole, double restitution) {
  const SurfaceDescription surface = surface_of(sole, restitution);
  return contact_between(surface, surface, 0.001);
}

TEST(NormalRow, ClosesAGapAndReleasesADepthByItsSpring) {
  const SurfaceContact contact = contact_of(kSoft, 0.0);
  EXPECT_DOUBLE_EQ(normal_row(contact, -0.0005, 1.0, 0.001)->target_m_per_s, -0.5);
  EXPECT_DOUBLE_EQ(normal_row(contact, 0.0005, 1.0, 0.001)->target_m_per_s, 0.15);
  EXPECT_EQ(normal_row(contact, 0.0005, 1.0, 0.001)->force_mixing, contact.softness.constraint_force_mixing);
}

TEST(NormalRow, BouncesInTheStepWhoseMiddleIsNearestToTheImpact) {
  const SurfaceContact contact = contact_of(kSoft, 0.5);
  EXPECT_FALSE(normal_row(contact, -0.0006, 1.0, 0.001));
  for (const double depth_m : {-0.0004, 0.0, 0.0004}) {
    EXPECT_EQ(normal_row(contact, depth_m, 1.0, 0.001)->target_m_per_s, 0.5) << depth_m;
    EXPECT_EQ(normal_row(contact, depth_m, 1.0, 0.001)->force_mixing, kImpactForceMixing) << depth_m;
  }
}

TEST(NormalRow, DoesNotBounceASpringThatIsCompressedFurther) {
  const SurfaceContact contact = contact_of(kSoft, 0.5);
  EXPECT_DOUBLE_EQ(normal_row(contact, 0.002, 1.0, 0.001)->target_m_per_s, 0.6);
}

TEST(NormalRow, LetsABouncingPointGoThatLeaves) {
  EXPECT_FALSE(normal_row(contact_of(kSoft, 0.5), 0.0001, -1.0, 0.001));
  EXPECT_TRUE(normal_row(contact_of(kSoft, 0.0), 0.0001, -1.0, 0.001));
}

}  // namespace
}  // namespace koboshi::sim_board
