#include "simulation/disturbance/world_text.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "sim_board/description/load.h"

namespace koboshi::simulation {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

const sim_board::RobotDescription& koboshi() {
  static const sim_board::RobotDescription robot =
      sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  return robot;
}

Pairs drawn(const DisturbedWorld& world) {
  Pairs pairs;
  for (const FactorText& text : drawn_texts(world, koboshi())) pairs.emplace_back(text.factor, text.text);
  return pairs;
}

TEST(WorldText, NamesEachFactorThatWasDrawnInItsUnit) {
  DisturbedWorld world;
  world.com_m = {0.0012, -0.003, 0.0};
  world.mass_factors = {1.05, 0.98, 1.0};
  world.backlash_rad = {0.0123, std::nullopt};
  world.encoder_offset_rad = {0.0045, -0.0021};
  world.servo_gain_divisor = 1.25;
  world.load_friction = 0.1;
  world.motor_constant_factor = 0.93;
  world.supply_factor = 1.02;
  world.sensor_latency_s = 0.0015;
  world.drive_latency_ms = 2;
  world.tick_jitter_s = 0.00075;
  world.friction = 0.654;
  world.tilt_rad = 0.05;
  world.gyro_noise_density = 0.001;
  world.gyro_random_walk = 0.00025;
  world.weak_joint = 2;
  EXPECT_EQ(drawn(world), (Pairs{{"CoM of the trunk, mm", "+1.20 -3.00 +0.00"},
                                 {"link masses, %", "+5.0 -2.0 +0.0"},
                                 {"backlash, mrad", "12.3 -"},
                                 {"encoder offset, mrad", "+4.5 -2.1"},
                                 {"servo gain divided by", "1.250"},
                                 {"load-dependent friction, beyond the nominal", "0.100"},
                                 {"motor constant, %", "-7.0"},
                                 {"extra latency of the sensors, ms", "1.5"},
                                 {"extra latency of the drives, ms", "2"},
                                 {"tick jitter, ms", "0.75"},
                                 {"friction", "0.65"},
                                 {"slope about x and y, degrees", "+2.86 +0.00"},
                                 {"supply, %", "+2.0"},
                                 {"gyro white noise, deg/s/sqrt(Hz)", "0.05730"},
                                 {"gyro random walk, rad/s/sqrt(s)", "0.00025"},
                                 {"half torque", koboshi().joints[2].name}}));
}

TEST(WorldText, LeavesOutWhatIsAsInTheFiles) {
  DisturbedWorld world;
  world.mass_factors = {1.0, 1.0};
  world.backlash_rad = {std::nullopt, std::nullopt};
  world.encoder_offset_rad = {0.0, 0.0};
  EXPECT_EQ(drawn(world), Pairs{});
}

}  // namespace
}  // namespace koboshi::simulation
