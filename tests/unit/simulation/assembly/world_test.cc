// A simulation in a world.

#include "simulation/assembly/world.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "simulation/assembly/simulation.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {
namespace {

const std::string kSquatInWorld = KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml";

Scenario in_world(const std::vector<Override>& overrides) { return read_scenario(kSquatInWorld, overrides); }

TEST(SimulationInAWorld, ChangesRobotAndGroundAndNotTheModel) {
  const Simulation as_described(in_world({}));
  EXPECT_EQ(as_described.world(), nullptr);
  const Simulation drawn(in_world({{"world", "rough"}, {"seed", "7"}}));
  ASSERT_NE(drawn.world(), nullptr);
  EXPECT_EQ(drawn.world()->seed, 7u);
  EXPECT_EQ(drawn.model().image, as_described.model().image);
  EXPECT_DOUBLE_EQ(drawn.robot().links[0].mass_kg,
                   drawn.world()->mass_factors[0] * as_described.robot().links[0].mass_kg);
  EXPECT_DOUBLE_EQ(drawn.board().ground().surface.friction, *drawn.world()->friction);
  EXPECT_LT(drawn.board().ground().normal_W.z(), 1.0);
  EXPECT_EQ(drawn.scenario().ground.roll_rad, 0.0) << "played.yaml would tilt the ground twice";
}

TEST(SimulationInAWorld, DrawsItBySeedOfItsOwnOrOfTheRun) {
  Simulation drawn(in_world({{"world", "rough"}, {"seed", "7"}}));
  const Simulation eight(in_world({{"world", "rough"}, {"seed", "8"}}));
  const double mass_kg = eight.robot().total_mass_kg();
  EXPECT_NE(drawn.robot().total_mass_kg(), mass_kg);
  drawn.reset(8);
  EXPECT_EQ(drawn.world()->seed, 8u);
  EXPECT_EQ(drawn.robot().total_mass_kg(), mass_kg);
  Simulation fixed(in_world({{"world", "{name: rough, seed: 8}"}, {"seed", "7"}}));
  EXPECT_EQ(fixed.robot().total_mass_kg(), mass_kg);
  fixed.reset(9);
  EXPECT_EQ(fixed.robot().total_mass_kg(), mass_kg);
}

}  // namespace
}  // namespace koboshi::simulation
