#include "lab/trial/perturbation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_board/world/surface_contact.h"

namespace koboshi::tools {
namespace {

constexpr int kSeeds = 2000;

sim_board::RobotDescription two_links() {
  sim_board::RobotDescription robot;
  robot.links.resize(2);
  robot.links[0].name = "trunk";
  robot.links[0].mass_kg = 0.5;
  robot.links[0].I_LCom_L = Eigen::Vector3d(1e-3, 2e-3, 3e-3).asDiagonal();
  robot.links[1].name = "foot";
  robot.links[1].mass_kg = 0.05;
  return robot;
}

double tilt_rad(const simulation::Ground& ground) {
  const Eigen::Vector3d normal =
      Eigen::AngleAxisd(ground.pitch_rad, Eigen::Vector3d::UnitY()) *
      (Eigen::AngleAxisd(ground.roll_rad, Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ());
  return std::acos(std::min(1.0, normal.z()));
}

TEST(Perturbation, KeepsMassesWithinTheirBoundsAndUsesAllOfThem) {
  double lowest = 1.0;
  double highest = 1.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    sim_board::RobotDescription robot = two_links();
    perturb_robot(robot, {}, seed);
    const double trunk = robot.links[0].mass_kg / 0.5;
    const double foot = robot.links[1].mass_kg / 0.05;
    lowest = std::min({lowest, trunk, foot});
    highest = std::max({highest, trunk, foot});
    EXPECT_NE(trunk, foot) << "every link has an error of its own";
    EXPECT_NEAR(robot.links[0].I_LCom_L(1, 1), 2e-3 * trunk, 1e-12);
  }
  EXPECT_GE(lowest, 0.95);
  EXPECT_LT(lowest, 0.951);
  EXPECT_LE(highest, 1.05);
  EXPECT_GT(highest, 1.049);
}

// Where robot and ground meet, not of the ground alone: the robot's own soles would cut it off at 0.8.
TEST(Perturbation, AppliesTheDrawnFriction) {
  double lowest = 1.0;
  double highest = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    sim_board::RobotDescription robot = two_links();
    robot.links[1].collisions.resize(1);
    simulation::Scenario scenario;
    perturb_robot(robot, {}, seed);
    perturb_scenario(scenario, {}, seed);
    sim_board::SurfaceDescription ground;
    ground.friction = ground.friction_second = scenario.ground.friction.value();
    const sim_board::SurfaceContact contact =
        sim_board::contact_between(robot.links[1].collisions[0].surface, ground, 0.001);
    EXPECT_DOUBLE_EQ(contact.friction, ground.friction);
    EXPECT_FALSE(contact.has_direction());
    lowest = std::min(lowest, contact.friction);
    highest = std::max(highest, contact.friction);
  }
  EXPECT_LT(lowest, 0.501);
  EXPECT_GT(highest, 0.999);
}

TEST(Perturbation, DrawsBacklashAndEncoderOffsetPerServo) {
  double largest_rad = 0.0;
  double farthest_rad = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    sim_board::RobotDescription robot = two_links();
    robot.joints.resize(2);
    robot.joints[0].name = "hip";
    robot.joints[1].name = "knee";
    sim_board::RobotDescription nominal = robot;
    perturb_robot(nominal, {}, seed);
    EXPECT_EQ(nominal.joints[0].servo.backlash_rad, 0.0) << "unless told otherwise";
    EXPECT_EQ(nominal.joints[0].encoder.offset_rad, 0.0);
    perturb_robot(robot, kRoughWorld, seed);
    const double backlash_rad = robot.joints[0].servo.backlash_rad;
    EXPECT_NE(backlash_rad, robot.joints[1].servo.backlash_rad);
    EXPECT_GE(backlash_rad, 0.0);
    largest_rad = std::max(largest_rad, backlash_rad);
    farthest_rad = std::max(farthest_rad, std::abs(robot.joints[1].encoder.offset_rad));
  }
  EXPECT_LE(largest_rad, 0.01);
  EXPECT_GT(largest_rad, 0.0099);
  EXPECT_LE(farthest_rad, 0.005);
  EXPECT_GT(farthest_rad, 0.00495);
}

TEST(Perturbation, TiltsTheScenariosOwnSlope) {
  simulation::Scenario scenario;
  scenario.ground.pitch_rad = 0.2;
  perturb_scenario(scenario, {.tilt_rad = 0.01}, 1);
  EXPECT_NEAR(scenario.ground.pitch_rad, 0.2, 0.01);
  EXPECT_NE(scenario.ground.pitch_rad, 0.2);
}

TEST(Perturbation, KeepsTheGroundWithinItsBoundsAndUsesAllOfThem) {
  double lowest = 1.0;
  double highest = 0.5;
  double steepest_rad = 0.0;
  std::array<int, 4> quadrants{};
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    simulation::Scenario scenario;
    perturb_scenario(scenario, {}, seed);
    EXPECT_EQ(scenario.seed, seed);
    lowest = std::min(lowest, *scenario.ground.friction);
    highest = std::max(highest, *scenario.ground.friction);
    steepest_rad = std::max(steepest_rad, tilt_rad(scenario.ground));
    ++quadrants.at((scenario.ground.roll_rad > 0.0 ? 1u : 0u) + (scenario.ground.pitch_rad > 0.0 ? 2u : 0u));
  }
  EXPECT_GE(lowest, 0.5);
  EXPECT_LT(lowest, 0.51);
  EXPECT_LT(highest, 1.0);
  EXPECT_GT(highest, 0.99);
  EXPECT_LE(steepest_rad, std::numbers::pi / 180.0);
  EXPECT_GT(steepest_rad, 0.99 * std::numbers::pi / 180.0);
  for (const int count : quadrants) EXPECT_GT(count, kSeeds / 5);
}

TEST(Perturbation, KeepsTheGroundHardByDefault) {
  simulation::Scenario scenario;
  perturb_scenario(scenario, {}, 1);
  EXPECT_FALSE(scenario.ground.softness);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    perturb_scenario(scenario, {.softest_N_per_m = 1000.0, .stiffest_N_per_m = 5000.0}, seed);
    ASSERT_TRUE(scenario.ground.softness);
    EXPECT_GE(scenario.ground.softness->stiffness_N_per_m, 1000.0);
    EXPECT_LE(scenario.ground.softness->stiffness_N_per_m, 5000.0);
    EXPECT_GT(scenario.ground.softness->damping_N_s_per_m, 0.0);
  }
}

TEST(Perturbation, IsTheSameForTheSameSeedAndOnEveryMachine) {
  simulation::Scenario scenario;
  sim_board::RobotDescription robot = two_links();
  perturb_scenario(scenario, {}, 7);
  perturb_robot(robot, {}, 7);
  // Worked out once from the generators' definitions, in Python.
  EXPECT_DOUBLE_EQ(*scenario.ground.friction, 0.6712480173769515);
  EXPECT_DOUBLE_EQ(robot.links[0].mass_kg, 0.4822691125601258);
  sim_board::RobotDescription more_links = two_links();
  more_links.links.insert(more_links.links.begin(), sim_board::LinkDescription{});
  perturb_robot(more_links, {}, 7);
  EXPECT_EQ(more_links.links[1].mass_kg, robot.links[0].mass_kg);
}

TEST(Pushes, AreDrawnWithinTheirBounds) {
  simulation::Scenario scenario;
  scenario.duration_us = 600'000'000;
  const PushBounds bounds{.first_s = 2.0,
                          .shortest_s = 1.0,
                          .longest_s = 3.0,
                          .lowest_N_s = 0.02,
                          .highest_N_s = 0.1,
                          .duration_s = 0.05};
  add_pushes(scenario, "trunk", 4'000'000, bounds, 3);
  ASSERT_GT(scenario.pushes.size(), 250u);  // one in 2 s
  EXPECT_LT(scenario.pushes.size(), 350u);
  EXPECT_EQ(scenario.pushes.front().at_us, 6'000'000u);
  std::uint64_t last_us = 5'000'000;
  Eigen::Vector3d sum_N_s = Eigen::Vector3d::Zero();
  for (const simulation::Push& push : scenario.pushes) {
    EXPECT_EQ(push.link.text, "trunk");
    EXPECT_GE(push.at_us - last_us, 1'000'000u);
    EXPECT_LE(push.at_us - last_us, 3'000'000u);
    last_us = push.at_us;
    // Over 0.1 s, which holds the whole push.
    const Eigen::Vector3d impulse_N_s = 0.1 * push.mean_force_W_N(push.at_us, push.at_us + 100'000);
    EXPECT_GE(impulse_N_s.norm(), 0.02 - 1e-12);
    EXPECT_LE(impulse_N_s.norm(), 0.1 + 1e-12);
    EXPECT_EQ(impulse_N_s.z(), 0.0);
    sum_N_s += impulse_N_s;
  }
  EXPECT_LT(sum_N_s.norm() / static_cast<double>(scenario.pushes.size()), 0.01) << "from all sides";
}

}  // namespace
}  // namespace koboshi::tools
