#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <thread>

#include "sim_board/engine/make_world.h"
#include "sim_board/world/ground_truth.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

// A humanoid whose legs do squats of a second each, `depth_rad` deep at the hip; voltage servos with a
// position loop.
class Humanoid {
 public:
  explicit Humanoid(WorldOptions options = {}, double depth_rad = 0.0) : depth_rad_(depth_rad) {
    options.X_WB.translation().z() = kSampleHumanoidHeight_m;
    world_ = make_world(robot_, options);
  }

  World& world() { return *world_; }
  const RobotDescription& robot() const { return robot_; }

  void run(double duration_s) {
    const auto steps = std::lround(duration_s / world_->step_s());
    for (long i = 0; i < steps; ++i) {
      for (int j = 0; j < 20; ++j) command(j);
      world_->step();
    }
  }

  // FNV-1a over the bits of all positions and velocities.
  std::uint64_t hash() const {
    std::uint64_t hash = 0xcbf29ce484222325U;
    const auto add = [&hash](double value) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3U;
    };
    for (int l = 0; l < 21; ++l) {
      const BodyState body = world_->body(l);
      for (int i = 0; i < 3; ++i) {
        add(body.X_WL.translation()[i]);
        add(body.v_WCom_W[i]);
        add(body.w_WL_W[i]);
      }
    }
    return hash;
  }

 private:
  void command(int joint) {
    const double bend = 0.5 * depth_rad_ * (1.0 - std::cos(2 * kPi * world_->time_s()));
    const std::string& name = robot_.joints[static_cast<std::size_t>(joint)].name;
    const auto is = [&name](const char* part) { return name.find(part) != std::string::npos; };
    const double target = is("thigh") || is("ankle") ? -bend : is("shank") ? 2 * bend : 0.0;
    const double volt = std::clamp((target - world_->joint(joint).position_rad) * 7.5 / 0.122, -7.5, 7.5);
    world_->set_servo(joint, {.drive_Nm = 1.0027 * volt / 5.477,
                              .damping_Nm_s = 1.0027 * 1.0027 / 5.477 + 0.0033,
                              .rotor_inertia_kg_m2 = 0.00116,
                              .friction_Nm = 0.0275});
  }

  RobotDescription robot_ = sample_humanoid();
  double depth_rad_;
  std::unique_ptr<World> world_;
};

class StandingInEachEngine : public EachEngine {};

int foot(const RobotDescription& robot, const char* name) {
  for (std::size_t l = 0; l < robot.links.size(); ++l)
    if (robot.links[l].name == name) return static_cast<int>(l);
  return -1;
}

TEST_P(StandingInEachEngine, CarriesTheWeightThroughTheAnkles) {
  Humanoid humanoid(options());
  humanoid.run(1.0);
  double mass_kg = 0.0;
  for (const LinkDescription& link : humanoid.robot().links) mass_kg += link.mass_kg;
  double ground_N = 0.0;
  for (const Contact& contact : humanoid.world().contacts()) ground_N += contact.f_W.z();
  EXPECT_NEAR(ground_N, mass_kg * kGravity, 1e-3);
  double ankles_N = 0.0;
  for (const char* side : {"left_foot", "right_foot"})
    ankles_N += humanoid.world().joint_wrench(foot(humanoid.robot(), side) - 1).force_N.z();
  EXPECT_NEAR(ankles_N, (mass_kg - 2 * 0.06) * kGravity, 1e-3);  // up, without the feet below the joint
  EXPECT_EQ(humanoid.world().solver_warnings(), 0U);
}

// The wrench at the ankle and the contacts below it tell the same centre of pressure, moving or not.
TEST_P(StandingInEachEngine, AgreesWithTheContactsOnTheWrenchAtTheAnkle) {
  Humanoid humanoid(options(), 0.4);
  const int left = foot(humanoid.robot(), "left_foot");
  const LinkDescription& link = humanoid.robot().links[static_cast<std::size_t>(left)];
  for (int i = 0; i < 20; ++i) {
    humanoid.run(0.05);
    const BodyState before = humanoid.world().body(left);
    humanoid.run(0.001);
    const BodyState after = humanoid.world().body(left);
    const Eigen::Vector3d anchor = before.X_WL.translation();  // the foot's frame is at its joint
    // Newton and Euler for the foot: contacts + weight - what it exerts on the ankle = change of momentum.
    const Eigen::Vector3d p_com = before.X_WL * link.p_LCom_L - anchor;
    const Eigen::Vector3d inertial = link.mass_kg * (after.v_WCom_W - before.v_WCom_W) / 0.001;
    const Eigen::Vector3d weight(0, 0, -link.mass_kg * kGravity);
    Eigen::Vector3d force = weight - inertial;
    Eigen::Vector3d torque =
        p_com.cross(weight - inertial) - link.I_LCom_L * (after.w_WL_W - before.w_WL_W) / 0.001;
    for (const Contact& contact : humanoid.world().contacts()) {
      if (contact.link != left) continue;
      force += contact.f_W;
      torque += (contact.p_W - anchor).cross(contact.f_W);
    }
    const Wrench wrench = humanoid.world().joint_wrench(left - 1);
    ASSERT_LT((wrench.force_N - force).norm(), 1e-3) << humanoid.world().time_s();
    ASSERT_LT((wrench.torque_Nm - torque).norm(), 1e-4) << humanoid.world().time_s();
  }
}

TEST_P(StandingInEachEngine, SquatsWithoutSlipOrWarning) {
  Humanoid humanoid(options(), 0.4);
  humanoid.run(0.1);
  const int left = foot(humanoid.robot(), "left_foot");
  const Eigen::Vector3d start = humanoid.world().body(left).X_WL.translation();
  for (int i = 0; i < 30; ++i) {
    humanoid.run(0.1);
    ASSERT_LT((humanoid.world().body(left).X_WL.translation() - start).norm(), 1e-4);
  }
  EXPECT_EQ(humanoid.world().solver_warnings(), 0U);
}

TEST(Standing, IsTheSameForBothFrictionSolvers) {
  WorldOptions rows;
  rows.friction = FrictionMethod::kRows;
  Humanoid one(rows, 0.4);
  Humanoid other({}, 0.4);
  for (int i = 0; i < 15; ++i) {
    one.run(0.1);
    other.run(0.1);
    for (int j = 0; j < 20; ++j)
      ASSERT_NEAR(one.world().joint(j).position_rad, other.world().joint(j).position_rad, 1e-6)
          << i << " " << j;
  }
}

TEST_P(StandingInEachEngine, ConvergesOnTheFineStep) {
  WorldOptions fine = options();
  fine.step_s = 0.00025;
  Humanoid one(fine, 0.4);
  Humanoid other(options(), 0.4);
  one.run(0.5);
  other.run(0.5);
  EXPECT_NEAR(one.world().body(0).X_WL.translation().z(), other.world().body(0).X_WL.translation().z(), 2e-4);
}

class SeveralWorlds : public EachEngine {};

TEST_P(SeveralWorlds, InParallelAreBitIdenticalToOneAlone) {
  const auto squat = [] {
    Humanoid humanoid(options(), 0.4);
    humanoid.run(0.3);
    return humanoid.hash();
  };
  const std::uint64_t alone = squat();
  std::array<std::uint64_t, 4> parallel{};
  std::vector<std::thread> threads;
  for (std::uint64_t& hash : parallel) threads.emplace_back([&hash, &squat] { hash = squat(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t hash : parallel) EXPECT_EQ(hash, alone);
}

INSTANTIATE_TEST_SUITE_P(Steppers, SeveralWorlds,
                         testing::Values(Stepper::kWorld, Stepper::kLumped, Stepper::kMujoco), engine_name);

TEST(SeveralWorlds, InOneThreadAreIndependent) {
  WorldOptions options;
  options.stepper = Stepper::kLumped;
  Humanoid alone(options, 0.4), one(options, 0.4), other(options, 0.4);
  alone.run(0.1);
  for (int i = 0; i < 100; ++i) {
    one.run(0.001);
    other.run(0.001);
  }
  EXPECT_EQ(one.hash(), alone.hash());
  EXPECT_EQ(other.hash(), alone.hash());
}

TEST(SeveralWorlds, MayMoveFromThreadToThread) {
  Humanoid alone({}, 0.4), moved({}, 0.4);
  alone.run(0.1);
  moved.run(0.05);
  std::thread([&moved] { moved.run(0.05); }).join();
  EXPECT_EQ(moved.hash(), alone.hash());
}

INSTANTIATE_TEST_SUITE_P(Engines, StandingInEachEngine, testing::ValuesIn(engines()), engine_name);

}  // namespace
}  // namespace koboshi::sim_board
