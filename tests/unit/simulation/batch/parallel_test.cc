#include "simulation/batch/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <stdexcept>
#include <vector>

namespace koboshi::simulation {
namespace {

TEST(Parallel, DoesEachTaskOnce) {
  for (const std::size_t jobs : {1u, 2u, 7u, 100u}) {
    std::vector<std::atomic<int>> done(50);
    EXPECT_EQ(for_each_parallel(done.size(), jobs, [&](std::size_t task) { ++done[task]; }), done.size());
    for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
  }
}

TEST(Parallel, RunsTheRequestedNumberAtATime) {
  // Deadlocks with fewer threads.
  std::latch together(3);
  for_each_parallel(3, 3, [&](std::size_t) { together.arrive_and_wait(); });
  SUCCEED();
}

TEST(Parallel, StartsNoMoreTasksOnceStopped) {
  int asked = 0;
  std::vector<int> done(10);
  const std::size_t started = for_each_parallel(
      done.size(), 1, [&](std::size_t task) { done[task] = 1; }, [&] { return ++asked <= 4; });
  EXPECT_EQ(started, 4u);
  EXPECT_EQ(done, (std::vector<int>{1, 1, 1, 1, 0, 0, 0, 0, 0, 0}));
}

TEST(Parallel, RethrowsTheExceptionOfTheFirstTask) {
  std::latch together(2);
  const auto fail = [&](std::size_t task) {
    if (task >= 2) return;
    together.arrive_and_wait();
    throw std::runtime_error("task " + std::to_string(task));
  };
  try {
    for_each_parallel(100, 2, fail);
    FAIL() << "nothing thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "task 0");
  }
}

}  // namespace
}  // namespace koboshi::simulation
