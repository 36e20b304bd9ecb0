#include <gtest/gtest.h>

#include <bit>
#include <functional>

#include "sim_board/random/random_stream.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

class SavedWorld : public EachEngine {
 protected:
  static WorldOptions options() {
    WorldOptions options = EachEngine::options();
    options.X_WB.translation().z() = kSampleHumanoidHeight_m;
    return options;
  }
  static const RobotDescription& robot() {
    static const RobotDescription robot = sample_humanoid();
    return robot;
  }

  static std::unique_ptr<World> make(const WorldOptions& options) {
    std::unique_ptr<World> world = make_world(robot(), options);
    for (std::size_t j = 0; j < robot().joints.size(); ++j)
      world->set_servo(static_cast<int>(j), servo(0.0, 0.03));
    return world;
  }

  // Steps with servos that ask for this and that and pushes on the trunk. Returns the bits of all that a
  // world tells, after each step.
  static std::vector<std::uint64_t> step(World& world, int steps, RandomStream& random) {
    std::vector<std::uint64_t> bits;
    for (int i = 0; i < steps; ++i) {
      if (i % 7 == 0) {
        const int joint = static_cast<int>(random.bits() % robot().joints.size());
        world.set_servo(joint, servo(random.within(0.5), 0.03 + random.within(0.03)));
      }
      if (i % 50 < 10) world.push(0, Eigen::Vector3d::Zero(), {random.within(3.0), random.within(3.0), 0.0});
      world.step();
      tell(world, bits);
    }
    return bits;
  }

 private:
  static ServoTorque servo(double drive_Nm, double friction_Nm) {
    return {
        .drive_Nm = drive_Nm, .damping_Nm_s = 0.2, .rotor_inertia_kg_m2 = 0.001, .friction_Nm = friction_Nm};
  }
  static void tell(const World& world, std::vector<std::uint64_t>& bits) {
    const auto add = [&](double value) { bits.push_back(std::bit_cast<std::uint64_t>(value)); };
    const auto add_all = [&](const auto& values) {
      for (const double value : values.reshaped()) add(value);
    };
    add(world.time_s());
    for (std::size_t l = 0; l < robot().links.size(); ++l) {
      const BodyState body = world.body(static_cast<int>(l));
      add_all(body.X_WL.matrix());
      add_all(body.v_WCom_W);
      add_all(body.w_WL_W);
    }
    for (std::size_t j = 0; j < robot().joints.size(); ++j) {
      const JointState joint = world.joint(static_cast<int>(j));
      add(joint.position_rad);
      add(joint.speed_rad_per_s);
      add(joint.servo_Nm);
      const Wrench wrench = world.joint_wrench(static_cast<int>(j));
      add_all(wrench.force_N);
      add_all(wrench.torque_Nm);
    }
    for (const Contact& contact : world.contacts()) {
      add(contact.link);
      add_all(contact.p_W);
      add_all(contact.f_W);
    }
    bits.push_back(world.solver_warnings());
    bits.push_back(world.unsettled_steps());
  }
};

// A robot that sinks down, sticks and slides; between, another run of it.
TEST_P(SavedWorld, ContinuesWithTheSameBits) {
  const auto world = make(options());
  RandomStream random(1, "saved world");
  for (const int steps : {0, 1, 30, 170}) {
    step(*world, steps, random);
    const SavedState saved = StateArchive::save(*world, random);
    const std::vector<std::uint64_t> first = step(*world, 60, random);
    step(*world, 40, random);
    StateArchive::restore(saved, *world, random);
    EXPECT_EQ(step(*world, 60, random), first) << "after " << steps << " steps";
  }
}

TEST_P(SavedWorld, HangsOnItsStandAgain) {
  WorldOptions hanging = options();
  hanging.fixed_base = true;
  const auto world = make(hanging);
  RandomStream random(2, "saved world");
  const auto hang_and_fall = [&] {
    std::vector<std::uint64_t> bits = step(*world, 20, random);
    world->release_base();
    const std::vector<std::uint64_t> falling = step(*world, 30, random);
    bits.insert(bits.end(), falling.begin(), falling.end());
    return bits;
  };
  step(*world, 10, random);
  const SavedState saved = StateArchive::save(*world, random);
  const std::vector<std::uint64_t> first = hang_and_fall();
  const SavedState fallen = StateArchive::save(*world, random);
  const std::vector<std::uint64_t> on = step(*world, 20, random);
  StateArchive::restore(saved, *world, random);
  EXPECT_EQ(hang_and_fall(), first);
  StateArchive::restore(saved, *world, random);
  StateArchive::restore(fallen, *world, random);
  EXPECT_EQ(step(*world, 20, random), on);
}

INSTANTIATE_TEST_SUITE_P(, SavedWorld, testing::Values(Stepper::kWorld, Stepper::kLumped, Stepper::kMujoco),
                         engine_name);

}  // namespace
}  // namespace koboshi::sim_board
