#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "tests/closed_loop/run.h"

namespace koboshi::test {
namespace {

constexpr std::uint64_t kDuration_us = 2'500'000;  // booting, enabling, standing on the ground, moving

std::uint64_t hash_of_run(std::uint64_t seed) {
  auto scenario = quick_squat();
  scenario.seed = seed;
  RobotRun run(scenario);
  run.run_until_us(kDuration_us);
  EXPECT_EQ(run.behaviour().state, behaviour::State::kMotion);
  return run.hash();
}

TEST(Determinism, SameSeedGivesTheSameFramesAndBodiesAloneAndFourAtATime) {
  const std::uint64_t alone = hash_of_run(1);
  std::array<std::uint64_t, 4> hashes{};
  {
    std::array<std::jthread, 4> threads;
    for (std::size_t i = 0; i < threads.size(); ++i) {
      threads[i] = std::jthread([&hashes, i] { hashes[i] = hash_of_run(1); });
    }
  }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, alone);
}

TEST(Determinism, AnotherSeedGivesAnotherRun) { EXPECT_NE(hash_of_run(1), hash_of_run(2)); }

}  // namespace
}  // namespace koboshi::test
