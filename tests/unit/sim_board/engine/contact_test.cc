#include <gtest/gtest.h>

#include <cmath>

#include "sim_board/engine/make_world.h"
#include "sim_board/world/ground_truth.h"
#include "sim_board/world/surface_contact.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Vector3d;

double force_on_ground_N(const World& world) {
  double force_N = 0.0;
  for (const Contact& contact : world.contacts()) force_N += contact.f_W.z();
  return force_N;
}

class ContactInEachEngine : public EachEngine {};

// A foot-sized box of 1.2 kg on ground that is tilted about y by slope_rad.
struct Slope {
  RobotDescription robot = sample_box(1.2, {0.1, 0.056, 0.01});
  std::unique_ptr<World> world;

  Slope(WorldOptions options, double slope_rad, double friction) {
    options.ground.normal_W = {std::sin(slope_rad), 0.0, std::cos(slope_rad)};
    options.ground.surface.friction = options.ground.surface.friction_second = friction;
    options.X_WB = Eigen::AngleAxisd(slope_rad, Vector3d::UnitY()) * Eigen::Translation3d(0, 0, 0.005);
    world = make_world(robot, options);
  }
};

TEST_P(ContactInEachEngine, CarriesTheWeightWithoutSinking) {
  Slope flat(options(), 0.0, 0.8);
  run(*flat.world, 1.0);
  EXPECT_EQ(flat.world->contacts().size(), 4U);
  for (const Contact& contact : flat.world->contacts()) {
    EXPECT_EQ(contact.link, 0);
    EXPECT_EQ(contact.other_link, -1);
    EXPECT_NEAR(contact.f_W.z(), 1.2 * kGravity / 4, 1e-3);
  }
  EXPECT_NEAR(force_on_ground_N(*flat.world), 1.2 * kGravity, 1e-6);
  EXPECT_NEAR(flat.world->body(0).X_WL.translation().z(), 0.005, 1e-4);
  EXPECT_EQ(flat.world->solver_warnings(), 0U);
}

TEST_P(ContactInEachEngine, HoldsOnASlopeBelowTheFrictionAngle) {
  Slope slope(options(), std::atan(0.75), 0.8);
  run(*slope.world, 0.1);
  const Vector3d start = slope.world->body(0).X_WL.translation();
  run(*slope.world, 2.0);
  EXPECT_LT((slope.world->body(0).X_WL.translation() - start).norm(), 1e-5);
}

TEST_P(ContactInEachEngine, SlidesOnASlopeBeyondTheFrictionAngle) {
  const double slope_rad = std::atan(0.9);
  Slope slope(options(), slope_rad, 0.5);
  run(*slope.world, 0.5);
  const double expected = kGravity * (std::sin(slope_rad) - 0.5 * std::cos(slope_rad)) * 0.5;
  EXPECT_NEAR(slope.world->body(0).v_WCom_W.norm(), expected, 0.01 * expected);
}

TEST(Contact, UsesTheLowerFrictionOfTwoSurfaces) {
  SurfaceDescription ice, rubber;
  ice.friction = 0.05;
  rubber.friction = 1.5;
  EXPECT_EQ(contact_between(ice, rubber, 0.001).friction, 0.05);
  EXPECT_EQ(contact_between(rubber, ice, 0.001).friction, 0.05);
}

TEST(Contact, KeepsSpringAndDamperAtAnyStep) {
  SurfaceDescription soft;
  soft.error_reduction = 0.3;
  soft.constraint_force_mixing = 2e-3;
  soft.reference_step_s = 0.001;
  for (const double step_s : {0.001, 0.0005, 0.0001}) {
    const Softness contact = contact_between(soft, soft, step_s).softness;
    const double kp = contact.error_reduction / (step_s * contact.constraint_force_mixing);
    const double kd = (1.0 - contact.error_reduction) / contact.constraint_force_mixing;
    EXPECT_NEAR(kp, 0.5 * 0.3 / (0.001 * 2e-3), 1e-6) << step_s;  // two springs in series: half of one
    EXPECT_NEAR(kd, 0.5 * 0.7 / 2e-3, 1e-6) << step_s;
  }
  // At its reference step, against itself, it is twice as soft as the file says and has the same ERP.
  EXPECT_NEAR(contact_between(soft, soft, 0.001).softness.constraint_force_mixing, 4e-3, 1e-12);
  EXPECT_NEAR(contact_between(soft, soft, 0.001).softness.error_reduction, 0.3, 1e-12);
}

TEST_P(ContactInEachEngine, SinksEquallyAtHalfTheStep) {
  for (const double step_s : {0.001, 0.0005, 0.00025}) {
    WorldOptions options = this->options();
    options.step_s = step_s;
    options.ground.surface.error_reduction = 0.3;
    options.ground.surface.constraint_force_mixing = 2e-3;  // kp 150 kN/m a point
    RobotDescription box = sample_box(1.2, {0.1, 0.056, 0.01});
    box.links[0].collisions[0].surface = options.ground.surface;
    options.X_WB.translation().z() = 0.005;
    const auto world = make_world(box, options);
    run(*world, 1.0);
    const double depth = 0.005 - world->body(0).X_WL.translation().z();
    EXPECT_NEAR(depth, 1.2 * kGravity / (4 * 75e3), 1e-7) << step_s;
  }
}

TEST_P(ContactInEachEngine, BouncesByTheCoefficientOfRestitution) {
  WorldOptions options = this->options();
  options.X_WB.translation().z() = 0.1 + 0.05;
  RobotDescription box = sample_box(1.0, {0.1, 0.1, 0.1});
  box.links[0].collisions[0].surface.bounce = 0.5;
  const auto world = make_world(box, options);
  const double impact = std::sqrt(2 * kGravity * 0.1);
  double fastest_up = 0.0;
  for (int i = 0; i < 300; ++i) {
    world->step();
    fastest_up = std::max(fastest_up, world->body(0).v_WCom_W.z());
  }
  EXPECT_NEAR(fastest_up, 0.5 * impact, 0.05 * impact);
}

TEST_P(ContactInEachEngine, NeverAddsEnergyToATumblingBox) {
  const RobotDescription box = sample_box(1.2, {0.1, 0.2, 0.3});
  WorldOptions options = this->options();
  options.X_WB = Eigen::Translation3d(0, 0, 0.5) * Eigen::AngleAxisd(0.6, Vector3d(1, 2, 0).normalized());
  const auto world = make_world(box, options);
  double energy = energy_J(box, *world, options.gravity_W_m_per_s2);
  const double allowed = 1e-3 * energy;
  double least = energy;
  for (int i = 0; i < 3000; ++i) {
    world->step();
    energy = energy_J(box, *world, options.gravity_W_m_per_s2);
    ASSERT_LT(energy, least + allowed) << i;
    least = std::min(least, energy);
  }
  EXPECT_LT(world->body(0).v_WCom_W.norm(), 1e-3);  // it has come to rest
}

TEST_P(ContactInEachEngine, IgnoresLinksWithinTwoJointsAndFindsFartherOnes) {
  // A chain of boxes in one place.
  for (const int joints : {2, 3}) {
    RobotDescription chain = sample_box(0.1, {0.02, 0.02, 0.02});
    for (int j = 0; j < joints; ++j) {
      chain.links.push_back(chain.links[0]);
      JointDescription joint;
      joint.parent = j;
      joint.child = j + 1;
      joint.lower_rad = -1.0;
      joint.upper_rad = 1.0;
      chain.joints.push_back(joint);
    }
    WorldOptions options = this->options();
    options.ground.present = false;
    const auto world = make_world(chain, options);
    world->step();
    EXPECT_EQ(world->contacts().empty(), joints == 2);
    for (const Contact& contact : world->contacts()) {
      EXPECT_EQ(contact.link, 0);
      EXPECT_EQ(contact.other_link, 3);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, ContactInEachEngine, testing::ValuesIn(engines()), engine_name);

}  // namespace
}  // namespace koboshi::sim_board
