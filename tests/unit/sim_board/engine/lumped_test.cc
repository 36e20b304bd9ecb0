#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "sim_board/description/hinge_tree.h"
#include "sim_board/engine/make_world.h"
#include "sim_board/engine/ode/hinge_chains.h"
#include "sim_board/world/ground_truth.h"
#include "tests/support/sample_robots.h"
#include "tests/unit/sim_board/engine/engines.h"

namespace koboshi::sim_board {
namespace {

using Eigen::Vector3d;

constexpr double kQuarterTurn_rad = 1.5707963267948966;
const Vector3d kAnchor_M(0.01, 0.02, 0.03);

// A bearing, then hinges about z, x and y (the first `hinges` of them) in one point, then a lopsided link.
RobotDescription gimbal(std::size_t hinges, double ring_kg, const Vector3d& ring_com = Vector3d::Zero()) {
  const std::vector<Vector3d> axes{Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::UnitY()};
  RobotDescription robot;
  robot.name = "gimbal";
  LinkDescription link;
  link.name = "bearing";
  link.mass_kg = 1.0;
  robot.links.push_back(link);
  for (std::size_t i = 0; i < hinges; ++i) {
    const bool last = i + 1 == hinges;
    link.name = last ? "bob" : "ring " + std::to_string(i);
    link.mass_kg = last ? 0.1 : ring_kg;
    link.p_LCom_L = last ? Vector3d(0.02, 0.01, -0.06) : ring_com;
    link.I_LCom_L = (last ? Vector3d(1e-4, 2e-4, 3e-4) : Vector3d(1, 1, 1) * 1e-5 * ring_kg).asDiagonal();
    robot.links.push_back(link);
    JointDescription joint;
    joint.name = "hinge " + std::to_string(i);
    joint.parent = static_cast<int>(i);
    joint.child = static_cast<int>(i) + 1;
    joint.p_MJ = kAnchor_M;
    joint.axis_M = axes[i];
    joint.lower_rad = i == 1 ? -kQuarterTurn_rad : -3.0;
    joint.upper_rad = i == 1 ? kQuarterTurn_rad : 3.0;
    robot.joints.push_back(joint);
  }
  return robot;
}

std::unique_ptr<World> hung(const RobotDescription& robot, Stepper stepper,
                            const std::vector<double>& starts_rad, double step_s = 0.001) {
  WorldOptions options;
  options.stepper = stepper;
  options.step_s = step_s;
  options.ground.present = false;
  options.fixed_base = true;
  options.joint_positions_rad = starts_rad;
  return make_world(robot, options);
}

const std::vector<ServoTorque> kServos{
    {.drive_Nm = 0.03, .damping_Nm_s = 0.01, .rotor_inertia_kg_m2 = 0.0004, .friction_Nm = 0.004},
    {.drive_Nm = -0.05, .damping_Nm_s = 0.02, .rotor_inertia_kg_m2 = 0.0006, .friction_Nm = 0.01},
    {.drive_Nm = 0.08, .damping_Nm_s = 0.005, .rotor_inertia_kg_m2 = 0.0008, .friction_Nm = 0.002}};

void drive(World& world, std::size_t hinges) {
  for (std::size_t j = 0; j < hinges; ++j) world.set_servo(static_cast<int>(j), kServos[j]);
}

class Gimbal : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(OfHinges, Gimbal, testing::Values(2, 3), testing::PrintToStringParamName());

TEST_P(Gimbal, IsOneChain) {
  const RobotDescription robot = gimbal(GetParam(), 0.01);
  const auto chains = lumped_hinges(robot, hinge_tree(robot));
  ASSERT_EQ(chains.size(), 1u);
  EXPECT_EQ(chains[0].joints.size(), GetParam());
}

// Both worlds have the same equations, but for what a step leaves out: the difference shrinks with the step.
// The rings are lopsided, so that their centres of mass move as the hinges turn.
double largest_difference_rad(std::size_t hinges, double ring_kg, double step_s) {
  const RobotDescription robot = gimbal(hinges, ring_kg, {0.02, -0.01, 0.015});
  std::vector<double> starts_rad{0.3, 0.9, -0.5};
  starts_rad.resize(hinges);
  const auto lumped = hung(robot, Stepper::kLumped, starts_rad, step_s);
  const auto world = hung(robot, Stepper::kWorld, starts_rad, step_s);
  drive(*lumped, hinges);
  drive(*world, hinges);
  double largest_rad = 0.0;
  for (double t_s = 0.0; t_s < 0.8; t_s += step_s) {
    lumped->step();
    world->step();
    for (int j = 0; j < static_cast<int>(hinges); ++j) {
      largest_rad =
          std::max(largest_rad, std::abs(lumped->joint(j).position_rad - world->joint(j).position_rad));
    }
  }
  EXPECT_GT(std::abs(world->joint(0).position_rad - starts_rad[0]), 0.1);  // it moved
  return largest_rad;
}

TEST_P(Gimbal, MovesLikeSeparateHinges) {
  for (const double ring_kg : {1e-5, 0.05}) {
    const double coarse_rad = largest_difference_rad(GetParam(), ring_kg, 0.0005);
    const double fine_rad = largest_difference_rad(GetParam(), ring_kg, 0.00005);
    EXPECT_LT(coarse_rad, 0.01) << ring_kg;
    EXPECT_LT(fine_rad, 0.15 * coarse_rad + 1e-6) << ring_kg;
  }
}

TEST_P(Gimbal, ReportsThePosesOfTheLinksBetween) {
  const RobotDescription robot = gimbal(GetParam(), 0.01, {0.01, -0.02, 0.005});
  std::vector<double> starts_rad{0.3, 0.9, -0.5};
  starts_rad.resize(GetParam());
  const auto world = hung(robot, Stepper::kLumped, starts_rad);
  drive(*world, GetParam());
  std::vector<BodyState> before;
  for (int i = 0; i < 200; ++i) {
    before.clear();
    for (int l = 0; l < static_cast<int>(robot.links.size()); ++l) before.push_back(world->body(l));
    world->step();
  }
  std::vector<double> positions_rad;
  for (int j = 0; j < static_cast<int>(GetParam()); ++j)
    positions_rad.push_back(world->joint(j).position_rad);
  const auto X_WLs = hinge_tree(robot).poses(world->body(0).X_WL, positions_rad);
  for (std::size_t l = 0; l < X_WLs.size(); ++l) {
    const BodyState body = world->body(static_cast<int>(l));
    EXPECT_LT((body.X_WL.matrix() - X_WLs[l].matrix()).norm(), 1e-4) << l;
    const Vector3d p_LCom_L = robot.links[l].p_LCom_L;
    const Vector3d moved_W = body.X_WL * p_LCom_L - before[l].X_WL * p_LCom_L;
    EXPECT_TRUE((moved_W / 0.001).isApprox(body.v_WCom_W, 0.02) || body.v_WCom_W.norm() < 1e-9) << l;
  }
}

// The weight of each ring is carried by the hinges above it only; at joint zero a ring rides where it is.
TEST_P(Gimbal, CarriesTheWeightBelowEachHinge) {
  const double ring_kg = 0.02;
  const Vector3d ring_com(0.015, 0.0, 0.0);
  const RobotDescription robot = gimbal(GetParam(), ring_kg, ring_com);
  const auto world = hung(robot, Stepper::kLumped, std::vector<double>(GetParam(), 0.0));
  for (int j = 0; j < static_cast<int>(GetParam()); ++j) world->set_servo(j, {.friction_Nm = 1.0});
  for (int i = 0; i < 100; ++i) world->step();
  for (std::size_t j = 0; j < GetParam(); ++j) {
    const double rings = static_cast<double>(GetParam() - 1 - j);
    const Wrench wrench = world->joint_wrench(static_cast<int>(j));
    EXPECT_NEAR(wrench.force_N.z(), -(0.1 + rings * ring_kg) * kGravity, 1e-6) << j;
    const Vector3d arms =
        0.1 * (Vector3d(0.02, 0.01, -0.06) - kAnchor_M) + rings * ring_kg * (ring_com - kAnchor_M);
    EXPECT_TRUE(wrench.torque_Nm.isApprox(arms.cross(Vector3d(0, 0, -kGravity)), 1e-5)) << j;
  }
}

TEST(GimbalLock, KeepsAChainOfThreeFromForming) {
  RobotDescription robot = gimbal(3, 0.01);
  robot.joints[1].upper_rad = 2.0;
  const auto chains = lumped_hinges(robot, hinge_tree(robot));
  ASSERT_EQ(chains.size(), 2u);
  EXPECT_EQ(chains[0].joints.size(), 2u);
}

TEST(GimbalLock, IsBeyondTheStopOfTheMiddleHinge) {
  const RobotDescription robot = gimbal(3, 0.01);
  const auto world = hung(robot, Stepper::kLumped, {0.1, 1.2, 0.1});
  drive(*world, 3);
  world->set_servo(1, {.drive_Nm = 0.3, .damping_Nm_s = 0.1, .rotor_inertia_kg_m2 = 0.001});
  for (int i = 0; i < 2000; ++i) world->step();
  EXPECT_NEAR(world->joint(1).position_rad, 85.0 / 90.0 * kQuarterTurn_rad, 0.01);
}

// The humanoid with nothing but a frame between the hinges of its hips, ankles and shoulders.
RobotDescription framed_humanoid() {
  RobotDescription robot = sample_humanoid();
  for (LinkDescription& link : robot.links) {
    const bool between = link.name.ends_with("hip_yaw") || link.name.ends_with("hip_roll") ||
                         link.name.ends_with("ankle") || link.name.ends_with("shoulder");
    if (between) link.collisions.clear();
  }
  for (JointDescription& joint : robot.joints) {
    if (joint.name.ends_with("hip_roll")) joint.lower_rad = -(joint.upper_rad = kQuarterTurn_rad);
  }
  return robot;
}

TEST(Lumped, MergesHipsAnklesAndShoulders) {
  const RobotDescription robot = framed_humanoid();
  std::vector<std::size_t> sizes(4, 0);
  for (const HingeChain& chain : lumped_hinges(robot, hinge_tree(robot))) ++sizes[chain.joints.size()];
  EXPECT_EQ(sizes[3], 2u);
  EXPECT_EQ(sizes[2], 4u);
  EXPECT_EQ(sizes[1], 6u);
  // With boxes that could collide nothing can be left out.
  const RobotDescription boxed = sample_humanoid();
  EXPECT_EQ(lumped_hinges(boxed, hinge_tree(boxed)).size(), 20u);
}

// Whatever the joints do is internal, and the links between the hinges take part in it where they are.
TEST(Lumped, KeepsTheMomentumOfAFreeRobot) {
  const RobotDescription robot = framed_humanoid();
  WorldOptions options;
  options.stepper = Stepper::kLumped;
  options.ground.present = false;
  for (const double step_s : {0.001, 0.00025}) {
    options.step_s = step_s;
    const auto world = make_world(robot, options);
    double fastest_rad_per_s = 0.0;
    while (world->time_s() < 0.3) {
      for (int j = 0; j < static_cast<int>(robot.joints.size()); ++j) {
        world->set_servo(j, {.drive_Nm = 0.4 * std::sin(40.0 * world->time_s() + j),
                             .damping_Nm_s = 0.01,
                             .rotor_inertia_kg_m2 = 5e-4,
                             .friction_Nm = 0.02});
        fastest_rad_per_s = std::max(fastest_rad_per_s, std::abs(world->joint(j).speed_rad_per_s));
      }
      world->step();
      const Vector3d v_W = centre_of_mass(robot, *world).v_WCom_W;
      ASSERT_LT((v_W - world->time_s() * options.gravity_W_m_per_s2).norm(), 1e-10)
          << "step " << step_s << " at " << world->time_s();
    }
    EXPECT_GT(fastest_rad_per_s, 3.0);
  }
}

class Standing {
 public:
  Standing(Stepper stepper, double friction, double tilt_rad) {
    WorldOptions options;
    options.stepper = stepper;
    options.X_WB.translation().z() = kSampleHumanoidHeight_m;
    options.gravity_W_m_per_s2 = {kGravity * std::sin(tilt_rad), 0.0, -kGravity * std::cos(tilt_rad)};
    options.ground.surface.friction = options.ground.surface.friction_second = friction;
    world_ = make_world(robot_, options);
  }
  World& world() { return *world_; }
  void run(double duration_s, const Vector3d& push_N = Vector3d::Zero()) {
    for (double t_s = 0.0; t_s < duration_s; t_s += 0.001) {
      for (int j = 0; j < 20; ++j) {
        const JointState joint = world_->joint(j);
        world_->set_servo(j, {.drive_Nm = -10.0 * joint.position_rad,
                              .damping_Nm_s = 0.2,
                              .rotor_inertia_kg_m2 = 0.0012,
                              .friction_Nm = 0.03});
      }
      if (!push_N.isZero()) world_->push(0, {0, 0, -0.15}, push_N);
      world_->step();
    }
  }
  Vector3d ground_force_N() const {
    Vector3d sum = Vector3d::Zero();
    for (const Contact& contact : world_->contacts()) sum += contact.f_W;
    return sum;
  }

 private:
  const RobotDescription robot_ = framed_humanoid();
  std::unique_ptr<World> world_;
};

TEST(Lumped, HeldSolesEqualContactJoints) {
  Standing lumped(Stepper::kLumped, 0.8, 0.05);
  Standing world(Stepper::kWorld, 0.8, 0.05);
  lumped.run(1.0);
  world.run(1.0);
  const double weight_N = framed_humanoid().total_mass_kg() * kGravity;
  EXPECT_NEAR(lumped.ground_force_N().z(), weight_N * std::cos(0.05), 0.02 * weight_N);
  EXPECT_NEAR(lumped.ground_force_N().x(), -weight_N * std::sin(0.05), 0.02 * weight_N);
  EXPECT_LT((lumped.world().body(0).X_WL.translation() - world.world().body(0).X_WL.translation()).norm(),
            1e-5);
  for (const Contact& contact : lumped.world().contacts()) {
    const double normal_N = contact.f_W.z();
    EXPECT_GE(normal_N, 0.0);
    EXPECT_LE(contact.f_W.head<2>().norm(), 0.8 * normal_N + 1e-9);
  }
}

// A push below the friction's limit moves nothing, one beyond it slides both worlds alike.
TEST(Lumped, HeldSolesAreReleasedWhenFrictionDoesNotSuffice) {
  const double weight_N = framed_humanoid().total_mass_kg() * kGravity;
  for (const double share : {0.8, 1.5}) {
    Standing lumped(Stepper::kLumped, 0.2, 0.0);
    Standing world(Stepper::kWorld, 0.2, 0.0);
    for (Standing* standing : {&lumped, &world}) {
      standing->run(0.5);
      standing->run(0.3, {0.2 * share * weight_N, 0, 0});
    }
    const double travel_m = lumped.world().body(0).X_WL.translation().x();
    const double travel_of_world_m = world.world().body(0).X_WL.translation().x();
    if (share < 1.0) {
      EXPECT_LT(std::abs(travel_m - travel_of_world_m), 1e-4);
    } else {
      EXPECT_GT(travel_m, 0.02);
      EXPECT_NEAR(travel_m, travel_of_world_m, 0.05 * travel_of_world_m);
    }
  }
}

// Four links with three hinges at different places: nothing to merge, so that both steppers have the same
// equations. Later the differences grow with the third power of time: ODE's joints yield by their force
// mixing and correct their position error at the child's image of the anchor.
TEST(Lumped, MovesAFreeTreeAsOdeDoes) {
  RobotDescription robot = gimbal(3, 0.2, {0.01, 0.02, -0.03});
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    robot.joints[j].p_MJ += 0.03 * static_cast<double>(j) * Vector3d(1.0, -1.0, 1.0);
  ASSERT_EQ(lumped_hinges(robot, hinge_tree(robot)).size(), 3u);
  WorldOptions options;
  options.ground.present = false;
  options.joint_positions_rad = {0.3, -0.4, 0.5};
  std::vector<std::unique_ptr<World>> worlds;
  for (const Stepper stepper : {Stepper::kWorld, Stepper::kLumped}) {
    options.stepper = stepper;
    worlds.push_back(make_world(robot, options));
    drive(*worlds.back(), 3);
  }
  for (int i = 0; i < 50; ++i) {
    const double tolerance = i < 5 ? 1e-9 : 2e-7;
    for (const auto& world : worlds) {
      world->push(3, {0.01, 0.0, 0.02}, {0.2, -0.3, 0.1});
      world->step();
    }
    for (int l = 0; l < 4; ++l) {
      const BodyState ode = worlds[0]->body(l);
      const BodyState tree = worlds[1]->body(l);
      EXPECT_LT((tree.v_WCom_W - ode.v_WCom_W).norm(), tolerance) << "step " << i << ", link " << l;
      EXPECT_LT((tree.w_WL_W - ode.w_WL_W).norm(), 10.0 * tolerance) << "step " << i << ", link " << l;
    }
    for (int j = 0; j < 3; ++j) {
      const Wrench ode = worlds[0]->joint_wrench(j);
      const Wrench tree = worlds[1]->joint_wrench(j);
      EXPECT_LT((tree.force_N - ode.force_N).norm(), 1e-5) << "step " << i << ", joint " << j;
      EXPECT_LT((tree.torque_Nm - ode.torque_Nm).norm(), 1e-6) << "step " << i << ", joint " << j;
    }
  }
  EXPECT_GT(worlds[0]->body(3).w_WL_W.norm(), 1.0);  // it moved
}

// A ring is carried by the link whose hinges displace its centre of mass less: on its own hinge's axis by
// none of them.
TEST(Lumped, CutsAChainWhereItsRingsAreDisplacedLeast) {
  const auto cut_of = [](const Vector3d& first_ring_m, const Vector3d& second_ring_m, double half_range_rad) {
    RobotDescription robot = gimbal(3, 0.01);
    robot.links[1].p_LCom_L = kAnchor_M + first_ring_m;
    robot.links[2].p_LCom_L = kAnchor_M + second_ring_m;
    robot.joints[1].lower_rad = -half_range_rad;
    robot.joints[1].upper_rad = half_range_rad;
    const auto chains = lumped_hinges(robot, hinge_tree(robot));
    EXPECT_EQ(chains.size(), 1u);
    return chains.at(0).cut;
  };
  const Vector3d on_z(0.0, 0.0, 0.05);
  const Vector3d on_y(0.0, 0.05, 0.0);
  // The first hinge turns about z, the last about y.
  EXPECT_EQ(cut_of(on_z, on_y, kQuarterTurn_rad), 1u);
  // About x by little: less than by the last one.
  EXPECT_EQ(cut_of(on_z, on_z, 0.3), 2u);
  // The first ring is far from z, and near to the axes of the others.
  EXPECT_EQ(cut_of({0.01, 0.05, 0.0}, on_y, 0.3), 0u);
}

}  // namespace
}  // namespace koboshi::sim_board
