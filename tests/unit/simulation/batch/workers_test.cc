#include "simulation/batch/workers.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace koboshi::simulation {
namespace {

TEST(Workers, DoEachTaskOnceInEachRound) {
  for (const std::size_t threads : {1u, 2u, 5u}) {
    Workers workers(threads);
    std::vector<std::atomic<int>> calls(7);
    for (int round = 0; round < 200; ++round) {
      workers.run(calls.size(), [&](std::size_t task) { ++calls[task]; });
      for (const auto& count : calls) ASSERT_EQ(count, round + 1) << threads << " threads";
    }
    workers.run(0, [](std::size_t) { FAIL() << "there is no task"; });
  }
}

TEST(Workers, DoTheOthersWhenOneThrowsAndRethrowTheFirst) {
  Workers workers(3);
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> calls = 0;
    try {
      workers.run(9, [&](std::size_t task) {
        ++calls;
        if (task % 3 == 2) throw std::runtime_error(std::to_string(task));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "2");
    }
    EXPECT_EQ(calls, 9);
  }
  workers.run(1, [](std::size_t) {});
}

}  // namespace
}  // namespace koboshi::simulation
