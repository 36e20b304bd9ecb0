#include "studio/run/snapshot_store.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "simulation/assembly/simulation.h"
#include "simulation/scenario/reader.h"

namespace koboshi::studio {
namespace {

// Fills a store as a run of this length does.
void fill(SnapshotStore& store, simulation::Simulation& simulation, std::uint64_t until_us) {
  for (; simulation.board().now_us() <= until_us; simulation.advance())
    if (store.due(simulation.board().now_us())) store.add(simulation.snapshot());
}

TEST(SnapshotStore, GivesTheLastSnapshotBeforeAMoment) {
  simulation::Simulation simulation(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml"));
  SnapshotStore store;
  fill(store, simulation, 4'000'000);
  EXPECT_EQ(store.count(), 5U);
  EXPECT_EQ(store.before(0).time_us(), 0U);
  EXPECT_EQ(store.before(2'999'999).time_us(), 2'000'000U);
  EXPECT_EQ(store.before(3'000'000).time_us(), 3'000'000U);
  EXPECT_EQ(store.before(99'000'000).time_us(), 4'000'000U);
  store.truncate_after(3'000'000);
  EXPECT_EQ(store.before(99'000'000).time_us(), 3'000'000U);
}

TEST(SnapshotStore, DoublesItsIntervalWithinTheBudget) {
  simulation::Simulation simulation(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml"));
  const std::size_t one_bytes = simulation.snapshot().size_bytes();
  SnapshotStore store(one_bytes * 4);
  fill(store, simulation, 8'000'000);
  EXPECT_LE(store.size_bytes(), one_bytes * 4);
  EXPECT_EQ(store.interval_us(), 4'000'000U);
  EXPECT_EQ(store.before(3'999'999).time_us(), 0U);
  EXPECT_EQ(store.before(7'999'999).time_us(), 4'000'000U);
  EXPECT_EQ(store.before(8'000'000).time_us(), 8'000'000U);
}

TEST(SnapshotStore, NeverDropsTheFirst) {
  simulation::Simulation simulation(simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml"));
  SnapshotStore store(1);
  fill(store, simulation, 3'000'000);
  EXPECT_EQ(store.before(0).time_us(), 0U);
  store.truncate_after(0);
  EXPECT_EQ(store.count(), 1U);
}

}  // namespace
}  // namespace koboshi::studio
