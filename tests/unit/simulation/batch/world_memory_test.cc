#include <gtest/gtest.h>
#include <malloc.h>

#include <memory>
#include <string>
#include <vector>

#include "sim_board/engine/make_world.h"
#include "simulation/observe/watched_simulation.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {
namespace {

// Returns the heap in use of the thread that runs the tests, with the blocks that were mapped separately.
std::size_t heap_bytes() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

class MemoryOfAWorld : public testing::TestWithParam<const char*> {
 protected:
  static constexpr std::size_t kWorlds = 4;

  // Returns the heap that each of several worlds on the same files uses after it has stepped.
  static std::size_t bytes() {
    const std::vector<Override> overrides{{"physics.stepper", GetParam()}};
    const auto prepared = std::make_shared<const PreparedScenario>(
        prepare(read_scenario(std::string(KOBOSHI_SOURCE_DIR) + "/scenarios/walk.yaml", overrides)));
    std::vector<std::unique_ptr<WatchedSimulation>> worlds;
    const auto add = [&] {
      worlds.push_back(std::make_unique<WatchedSimulation>(prepared, worlds.size() + 1));
      worlds.back()->step(30);
    };
    add();  // libraries allocate once, with the first world
    const std::size_t before_bytes = heap_bytes();
    for (std::size_t i = 0; i < kWorlds; ++i) add();
    return (heap_bytes() - before_bytes) / kWorlds;
  }
};

// MuJoCo reserves 2.1 MB at once. ODE's memory of a step grows with the contacts, in a fall to 0.9 MB.
TEST_P(MemoryOfAWorld, IsBounded) {
  if (std::string(GetParam()) == "mujoco" && !sim_board::has_mujoco()) GTEST_SKIP() << "built without MuJoCo";
  const std::size_t world_bytes = bytes();
  RecordProperty("bytes", std::to_string(world_bytes));
  EXPECT_LE(world_bytes, 3'000'000u);
  EXPECT_GE(world_bytes, 100'000u);  // it measures something
}

INSTANTIATE_TEST_SUITE_P(Steppers, MemoryOfAWorld, testing::Values("world", "lumped", "mujoco"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace koboshi::simulation
