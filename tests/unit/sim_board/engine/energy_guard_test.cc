#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "sim_board/engine/forwarding_world.h"
#include "sim_board/engine/guarded_world.h"
#include "sim_board/engine/make_world.h"
#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {
namespace {

// A world in which something goes wrong: the robot is thrown up by a force of which the guard hears nothing.
class Cheating final : public ForwardingWorld {
 public:
  Cheating(std::unique_ptr<World> world, double force_N)
      : ForwardingWorld(std::move(world)), force_N_(force_N) {}

  void step() override {
    push(0, Eigen::Vector3d::Zero(), {0, 0, force_N_});
    ForwardingWorld::step();
  }

 private:
  double force_N_;
};

WorldOptions standing_box() {
  WorldOptions options;
  options.X_WB.translation().z() = 0.05;
  return options;
}

void run_about(World& world, double duration_s) {
  for (double t_s = 0.0; t_s < duration_s; t_s += world.step_s()) world.step();
}

TEST(EnergyGuard, StopsAWorldThatGainsEnergyWithTimeBodyAndCause) {
  const RobotDescription box = sample_box(1.0, {0.1, 0.1, 0.1});
  WorldOptions unguarded = standing_box();
  unguarded.energy_tolerance_J_per_kg = 0.0;
  const auto world =
      guard_energy(std::make_unique<Cheating>(make_world(box, unguarded), 20.0), box, standing_box());
  try {
    run_about(*world, 1.0);
    FAIL() << "it went on to " << world->time_s() << " s";
  } catch (const WorldBlewUp& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("gained energy at 0."), std::string::npos) << text;
    EXPECT_NE(text.find("body '" + box.links[0].name + "'"), std::string::npos) << text;
    EXPECT_NE(text.find("it has no contact"), std::string::npos) << text;
  }
  // 20 N on 1 kg: 10.2 m/s^2 and half as much energy a second and second: 0.05 J after 0.07 s.
  EXPECT_LT(world->time_s(), 0.1);
}

TEST(EnergyGuard, TakesPushesIntoAccount) {
  const auto world = make_world(sample_box(1.0, {0.1, 0.1, 0.1}), standing_box());
  for (int i = 0; i < 1000; ++i) {
    world->push(0, {0, 0, 0.05}, {0, 0, 20.0});
    world->step();
  }
  EXPECT_GT(world->body(0).v_WCom_W.z(), 10.0);
}

TEST(EnergyGuard, TakesServosIntoAccount) {
  HingeRig rig;
  rig.arm_m = 0.1;
  WorldOptions options;
  options.ground.present = false;
  options.fixed_base = true;
  const auto world = make_world(sample_hinge(rig), options);
  world->set_servo(0, {.drive_Nm = 0.2, .damping_Nm_s = 0.01, .rotor_inertia_kg_m2 = 0.001});
  EXPECT_NO_THROW(run_about(*world, 3.0));
  EXPECT_GT(world->joint(0).speed_rad_per_s, 10.0);
}

TEST(EnergyGuard, AllowsSoftGroundToReturnItsElasticEnergy) {
  WorldOptions options;
  options.X_WB.translation().z() = 0.25;
  // ERP and CFM of 2 kN/m and 1 N s/m at a point: a trampoline.
  const double step_s = options.ground.surface.reference_step_s;
  const Softness soft = softness(2000.0, 1.0, step_s);
  options.ground.surface.error_reduction = soft.error_reduction;
  options.ground.surface.constraint_force_mixing = soft.constraint_force_mixing;
  const auto world = make_world(sample_box(1.0, {0.1, 0.1, 0.1}), options);
  double highest_m_per_s = 0.0;
  for (int i = 0; i < 2000; ++i) {
    world->step();
    highest_m_per_s = std::max(highest_m_per_s, world->body(0).v_WCom_W.z());
  }
  EXPECT_GT(highest_m_per_s, 0.5);  // it jumps
}

}  // namespace
}  // namespace koboshi::sim_board
