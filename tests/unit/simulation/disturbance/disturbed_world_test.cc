// The worlds against the ranges of docs/reference/worlds.md: bounds, independence, scaling, repeatability.

#include "simulation/disturbance/disturbed_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "simulation/assembly/world.h"
#include "simulation/disturbance/world_ranges.h"

namespace koboshi::simulation {
namespace {

constexpr std::uint64_t kSeeds = 4000;
constexpr double kDegree_rad = std::numbers::pi / 180.0;

sim_board::JointDescription joint(const std::string& name, double height_m) {
  sim_board::JointDescription joint;
  joint.name = name;
  joint.p_MJ = {0.0, 0.03, height_m};
  return joint;
}

// A robot with a leg of the reference length, times `size`.
sim_board::RobotDescription small_robot(double size = 1.0) {
  sim_board::RobotDescription robot;
  robot.links.resize(2);
  robot.links[0].name = "trunk";
  robot.links[0].mass_kg = 0.5;
  robot.links[0].I_LCom_L = Eigen::Vector3d(1e-3, 2e-3, 3e-3).asDiagonal();
  robot.links[0].p_LCom_L = {0.001, 0.002, 0.08};
  robot.links[1].name = "foot";
  robot.links[1].mass_kg = 0.05;
  robot.links[1].collisions.resize(1);
  robot.joints = {joint("left_hip_pitch", size * 0.17), joint("left_knee", size * 0.105),
                  joint("left_ankle_pitch", size * 0.04)};
  robot.battery = sim_board::BatteryDescription{.open_circuit_V = 7.6};
  robot.imu.emplace();
  robot.imu->gyro.noise_density = 0.005 * kDegree_rad;
  robot.left_ankle.emplace();
  return robot;
}

// The effect of a factor on the robot or the ground, as a number of docs/reference/worlds.md. It is read
// from the changed descriptions, not from the draw.
struct Applied {
  sim_board::RobotDescription robot;
  Scenario scenario;
};
using Factors = std::map<std::string, std::function<double(const Applied&)>>;

double tilt_rad(const Ground& ground) { return std::hypot(ground.roll_rad, ground.pitch_rad); }

const Factors& factors() {
  static const Factors kFactors{
      {"com x", [](const Applied& a) { return 1e3 * (a.robot.links[0].p_LCom_L.x() - 0.001); }},
      {"com y", [](const Applied& a) { return 1e3 * (a.robot.links[0].p_LCom_L.y() - 0.002); }},
      {"com z", [](const Applied& a) { return 1e3 * (a.robot.links[0].p_LCom_L.z() - 0.08); }},
      {"mass of the trunk", [](const Applied& a) { return 100.0 * (a.robot.links[0].mass_kg / 0.5 - 1.0); }},
      {"mass of the foot", [](const Applied& a) { return 100.0 * (a.robot.links[1].mass_kg / 0.05 - 1.0); }},
      {"servo gain", [](const Applied& a) { return a.robot.joints[1].servo.full_voltage_error_rad / 0.122; }},
      {"load friction", [](const Applied& a) { return a.robot.joints[1].servo.load_friction.motor; }},
      {"motor constant",
       [](const Applied& a) {
         return 100.0 * (a.robot.joints[1].servo.torque_constant_Nm_per_A / 1.0027 - 1.0);
       }},
      {"backlash of the hip", [](const Applied& a) { return 1e3 * a.robot.joints[0].servo.backlash_rad; }},
      {"backlash of the knee", [](const Applied& a) { return 1e3 * a.robot.joints[1].servo.backlash_rad; }},
      {"encoder offset", [](const Applied& a) { return 1e3 * a.robot.joints[1].encoder.offset_rad; }},
      {"sensor latency", [](const Applied& a) { return 1e3 * (a.robot.imu->gyro.delay_s - 0.001); }},
      {"drive latency",
       [](const Applied& a) { return 1.0 * a.robot.joints[1].servo.command.write_delay_ms; }},
      {"tick jitter", [](const Applied& a) { return 1e-3 * static_cast<double>(a.scenario.tick_jitter_us); }},
      {"friction", [](const Applied& a) { return a.robot.links[1].collisions[0].surface.friction; }},
      {"slope", [](const Applied& a) { return tilt_rad(a.scenario.ground) / kDegree_rad; }},
      {"supply", [](const Applied& a) { return 100.0 * (a.robot.battery->open_circuit_V / 7.6 - 1.0); }},
      {"gyro noise", [](const Applied& a) { return a.robot.imu->gyro.noise_density / kDegree_rad; }},
      {"gyro walk", [](const Applied& a) { return 1e6 * a.robot.imu->gyro.random_walk; }}};
  return kFactors;
}

Applied applied(const WorldRanges& ranges, std::uint64_t seed, double size = 1.0) {
  Applied result{small_robot(size), {}};
  result.scenario.world = WorldChoice{ranges, seed};
  const auto world = draw_world(result.scenario, result.robot);
  apply(*world, result.robot);
  apply(*world, result.scenario);
  return result;
}

using Samples = std::map<std::string, std::vector<double>>;

Samples samples(const std::string& world, std::uint64_t seeds) {
  Samples samples;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const Applied one = applied(world_named(world), seed);
    for (const auto& [factor, value] : factors()) samples[factor].push_back(value(one));
  }
  return samples;
}

// The table of docs/reference/worlds.md, written down a second time.
using Table = std::map<std::string, Range>;
Table table_of(const std::string& world) {
  if (world == "mild") {
    return {{"com x", {0, 0}},
            {"com y", {0, 0}},
            {"com z", {0, 0}},
            {"mass of the trunk", {-10, 10}},
            {"mass of the foot", {-10, 10}},
            {"servo gain", {1, 1}},
            {"load friction", {0, 0}},
            {"motor constant", {0, 0}},
            {"backlash of the hip", {0, 10}},
            {"backlash of the knee", {0, 10}},
            {"encoder offset", {-5, 5}},
            {"sensor latency", {0, 0}},
            {"drive latency", {0, 0}},
            {"tick jitter", {0, 0}},
            {"friction", {0.4, 1.0}},
            {"slope", {0, 2}},
            {"supply", {-10, 10}},
            {"gyro noise", {0.005, 0.005}},
            {"gyro walk", {0, 0}}};
  }
  const bool rough = world == "rough";
  const auto either = [rough](Range of_rough, Range of_harsh) { return rough ? of_rough : of_harsh; };
  return {{"com x", either({-5, 5}, {-10, 10})},
          {"com y", either({-5, 5}, {-10, 10})},
          {"com z", either({-5, 5}, {-10, 10})},
          {"mass of the trunk", either({-10, 10}, {-15, 15})},
          {"mass of the foot", either({-10, 10}, {-15, 15})},
          {"servo gain", either({1, 1.5}, {1, 2})},
          {"load friction", either({0, 0.11}, {0, 0.22})},
          {"motor constant", either({-5, 5}, {-10, 10})},
          {"backlash of the hip", either({0, 12}, {0, 20})},
          {"backlash of the knee", either({0, 12}, {0, 20})},
          {"encoder offset", {-5, 5}},
          {"sensor latency", either({0, 10}, {0, 20})},
          {"drive latency", either({0, 5}, {0, 10})},
          {"tick jitter", either({0, 1}, {0, 2})},
          {"friction", either({0.3, 1.2}, {0.2, 1.5})},
          {"slope", either({0, 2.5}, {0, 5})},
          {"supply", either({-10, 10}, {-15, 15})},
          {"gyro noise", either({0.005, 0.0075}, {0.005, 0.01})},
          {"gyro walk", either({0, 20}, {0, 100})}};
}

class Worlds : public testing::TestWithParam<std::string> {};

TEST_P(Worlds, DrawEachFactorUniformlyWithinTheTable) {
  const Samples drawn = samples(GetParam(), kSeeds);
  for (const auto& [factor, range] : table_of(GetParam())) {
    const std::vector<double>& values = drawn.at(factor);
    const double span = range.high - range.low;
    const auto [lowest, highest] = std::ranges::minmax(values);
    EXPECT_GE(lowest, range.low - 1e-9) << factor;
    EXPECT_LE(highest, range.high + 1e-9) << factor;
    EXPECT_LE(lowest, range.low + 0.003 * span + 1e-9) << factor << ": does not use its range";
    EXPECT_GE(highest, range.high - 0.003 * span - 1e-9) << factor << ": does not use its range";
    // Each quarter of a uniform distribution has a quarter of the draws, within five standard deviations.
    // The drives' latency has whole numbers only.
    if (span == 0.0 || factor == "drive latency") continue;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const auto inside = std::ranges::count_if(values, [&](double value) {
        const double part = 4.0 * (value - range.low) / span;
        return part >= quarter && part < quarter + 1;
      });
      EXPECT_NEAR(static_cast<double>(inside) / kSeeds, 0.25, 0.035) << factor << ", quarter " << quarter;
    }
  }
}

TEST_P(Worlds, DrawIndependentFactors) {
  const Samples drawn = samples(GetParam(), kSeeds);
  const auto standard = [](std::vector<double> values) {
    double mean = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    double square = 0.0;
    for (double& value : values) {
      value -= mean;
      square += value * value;
    }
    for (double& value : values) value /= std::sqrt(square);
    return values;
  };
  std::map<std::string, std::vector<double>> standardised;
  for (const auto& [factor, values] : drawn) {
    const auto [lowest, highest] = std::ranges::minmax(values);
    if (highest - lowest > 1e-9) standardised[factor] = standard(values);
  }
  EXPECT_GE(standardised.size(), 7u);
  // Of 171 pairs, none exceeds 4.7 standard deviations of independent ones.
  const double bound = 4.7 / std::sqrt(static_cast<double>(kSeeds));
  for (auto first = standardised.begin(); first != standardised.end(); ++first) {
    for (auto second = std::next(first); second != standardised.end(); ++second) {
      double correlation = 0.0;
      for (std::size_t i = 0; i < kSeeds; ++i) correlation += first->second[i] * second->second[i];
      EXPECT_LT(std::abs(correlation), bound) << first->first << " and " << second->first;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Worlds, testing::Values("mild", "rough", "harsh"),
                         [](const auto& world) { return world.param; });

TEST(World, HasNames) {
  EXPECT_EQ(world_names(), (std::vector<std::string>{"mild", "rough", "harsh"}));
  EXPECT_THROW(static_cast<void>(world_named("bumpy")), std::out_of_range);
}

TEST(World, IsNeverNarrowerThanAGentlerOne) {
  for (const auto& [factor, rough] : table_of("rough")) {
    const Range mild = table_of("mild").at(factor);
    const Range harsh = table_of("harsh").at(factor);
    EXPECT_LE(rough.low, mild.low) << factor;
    EXPECT_GE(rough.high, mild.high) << factor;
    EXPECT_LE(harsh.low, rough.low) << factor;
    EXPECT_GE(harsh.high, rough.high) << factor;
  }
}

TEST(World, TiltsTheGroundInAllDirections) {
  std::array<int, 4> quadrants{};
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Ground ground = applied(world_named("rough"), seed).scenario.ground;
    ++quadrants.at((ground.roll_rad > 0.0 ? 1u : 0u) + (ground.pitch_rad > 0.0 ? 2u : 0u));
  }
  for (const int count : quadrants) EXPECT_GT(count, kSeeds / 5);
}

TEST(World, AddsToTheScenariosOwnSlopeAndJitter) {
  Scenario scenario;
  scenario.ground.pitch_rad = 0.2;
  scenario.tick_jitter_us = 100;
  scenario.world = WorldChoice{world_named("rough"), 3};
  const auto world = draw_world(scenario, small_robot());
  apply(*world, scenario);
  EXPECT_DOUBLE_EQ(scenario.ground.pitch_rad, 0.2 + world->pitch_rad());
  EXPECT_EQ(scenario.tick_jitter_us, 100 + world->tick_jitter_us());
  EXPECT_FALSE(scenario.world) << "it could be drawn twice";
}

TEST(World, DrawsWholeMillisecondsOfTheDrivesLatency) {
  std::map<int, int> counts;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
    ++counts[applied(world_named("rough"), seed).robot.joints[0].servo.command.write_delay_ms];
  ASSERT_EQ(counts.size(), 6u);
  for (const auto& [latency_ms, count] : counts) EXPECT_NEAR(count, kSeeds / 6, 120) << latency_ms;
}

TEST(World, WeakensOneJointIfItIsHarsh) {
  const double half_stall_A = 0.5 * 7.5 / 5.477;
  std::set<std::string> weak;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    int count = 0;
    for (const auto& joint : applied(world_named("harsh"), seed).robot.joints) {
      if (std::isinf(joint.servo.current_limit_A)) continue;
      EXPECT_DOUBLE_EQ(joint.servo.current_limit_A, half_stall_A);
      weak.insert(joint.name);
      ++count;
    }
    EXPECT_EQ(count, 1);
    for (const auto& joint : applied(world_named("rough"), seed).robot.joints)
      EXPECT_TRUE(std::isinf(joint.servo.current_limit_A));
  }
  EXPECT_EQ(weak.size(), 3u);
}

TEST(World, ScalesLengthsWithTheLegAndNothingElse) {
  EXPECT_NEAR(leg_length_m(small_robot()), kReferenceLeg_m, 1e-12);
  EXPECT_NEAR(leg_length_m(small_robot(2.0)), 2.0 * kReferenceLeg_m, 1e-12);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Applied one = applied(world_named("harsh"), seed);
    const Applied two = applied(world_named("harsh"), seed, 2.0);
    for (const auto& [factor, value] : factors()) {
      const double scale = factor.starts_with("com") ? 2.0 : 1.0;
      EXPECT_NEAR(value(two), scale * value(one), 1e-9) << factor;
    }
  }
}

TEST(World, OfARobotWithoutSuchALegHasTheReferencesLengths) {
  sim_board::RobotDescription robot = small_robot();
  robot.joints.clear();
  EXPECT_EQ(leg_length_m(robot), kReferenceLeg_m);
  EXPECT_FALSE(draw_world(world_named("harsh"), robot, 1).weak_joint);
}

TEST(World, ScalesTheSupplyOfServosWithoutABattery) {
  sim_board::RobotDescription robot = small_robot();
  robot.battery.reset();
  const DisturbedWorld world = draw_world(world_named("rough"), robot, 4);
  apply(world, robot);
  for (const auto& joint : robot.joints) EXPECT_DOUBLE_EQ(joint.servo.supply_V, 7.5 * world.supply_factor);
}

TEST(World, NeverMakesAGyroBetterThanItsFile) {
  sim_board::RobotDescription robot = small_robot();
  robot.imu->gyro.noise_density = 0.02 * kDegree_rad;
  robot.imu->gyro.random_walk = 5e-5;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    EXPECT_FALSE(draw_world(world_named("harsh"), robot, seed).gyro_noise_density);
    EXPECT_GE(draw_world(world_named("harsh"), robot, seed).gyro_random_walk.value(), 5e-5);
  }
}

TEST(World, IsTheSameForTheSameSeedAndOnEveryMachine) {
  const Applied world = applied(world_named("mild"), 7);
  // Worked out once from the generators' definitions, in Python.
  EXPECT_DOUBLE_EQ(*world.scenario.ground.friction, 0.6054976208523418);
  EXPECT_DOUBLE_EQ(world.robot.links[0].mass_kg, 0.4645382251202516);
  sim_board::RobotDescription more_links = small_robot();
  more_links.links.push_back(sim_board::LinkDescription{});
  const DisturbedWorld drawn = draw_world(world_named("mild"), more_links, 7);
  EXPECT_EQ(0.5 * drawn.mass_factors[0], world.robot.links[0].mass_kg);
  EXPECT_NE(draw_world(world_named("mild"), more_links, 8).mass_factors[0], drawn.mass_factors[0]);
}

// A factor alone, at the ends of its range.
TEST(World, DrawsTheEndsOfARangeIfAskedTo) {
  const WorldRanges ranges{.com_m = symmetric(0.02), .tilt_rad = {0.05, 0.05}, .ends_only = true};
  int high = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Applied one = applied(ranges, seed);
    const double x_mm = factors().at("com x")(one);
    EXPECT_NEAR(std::abs(x_mm), 20.0, 1e-9);
    high += x_mm > 0.0 ? 1 : 0;
    EXPECT_NEAR(tilt_rad(one.scenario.ground), 0.05, 1e-12);
    EXPECT_EQ(one.robot.links[0].mass_kg, 0.5);
    EXPECT_EQ(one.robot.links[1].collisions[0].surface.friction, 0.8);
    EXPECT_EQ(one.robot.joints[0].servo.backlash_rad, 0.0);
    EXPECT_EQ(one.robot.joints[0].encoder.offset_rad, 0.0);
    EXPECT_FALSE(one.scenario.ground.friction);
  }
  EXPECT_NEAR(high, 200, 50);
}

}  // namespace
}  // namespace koboshi::simulation
