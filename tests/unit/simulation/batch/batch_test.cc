#include "simulation/batch/batch.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "simulation/assembly/operator_input.h"
#include "simulation/scenario/operator_pc.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {
namespace {

Scenario squat() {
  const std::vector<Override> overrides{{"physics.stepper", "lumped"}};
  return read_scenario(std::string(KOBOSHI_SOURCE_DIR) + "/scenarios/squat.yaml", overrides);
}

std::string hash_of(const WatchedSimulation& world) { return world.recorder().summary().state_hash; }

constexpr std::array<std::uint64_t, 3> kSeeds{5, 1, 9};

TEST(Batch, GivesEachWorldTheBitsThatItHasAlone) {
  Batch batch(squat(), kSeeds, 2);
  for (int i = 0; i < 3; ++i) batch.step(100);
  for (std::size_t world = 0; world < kSeeds.size(); ++world) {
    Scenario scenario = squat();
    scenario.seed = kSeeds[world];
    WatchedSimulation alone(scenario);
    alone.step(300);
    EXPECT_EQ(hash_of(batch.at(world)), hash_of(alone)) << "seed " << kSeeds[world];
  }
}

TEST(Batch, RestartsOneWorldAndLeavesTheOthers) {
  Batch batch(squat(), kSeeds, 2);
  batch.step(50);
  batch.reset(1, 5);
  EXPECT_EQ(batch.at(1).now_us(), 0u);
  EXPECT_EQ(batch.at(2).now_us(), 50'000u);
  batch.step(50);
  Batch other(squat(), kSeeds, 1);
  other.step(50);
  EXPECT_EQ(hash_of(batch.at(1)), hash_of(other.at(0)));
}

TEST(Batch, StepsTheOthersWhenOneThrows) {
  Batch batch(squat(), kSeeds, 2);
  batch.step(2500);
  write(batch.at(1).simulation(), "mounting_roll_deg", 1.0);  // refused while the drives have torque
  EXPECT_THROW(batch.step(100), SdoFailed);
  EXPECT_LT(batch.at(1).now_us(), 2'600'000u);
  EXPECT_EQ(batch.at(0).now_us(), 2'600'000u);
  EXPECT_EQ(batch.at(2).now_us(), 2'600'000u);
}

TEST(Batch, RejectsAnEmptySeedListAndZeroThreads) {
  EXPECT_THROW(Batch(squat(), {}, 1), std::invalid_argument);
  EXPECT_THROW(Batch(squat(), kSeeds, 0), std::invalid_argument);
}

}  // namespace
}  // namespace koboshi::simulation
