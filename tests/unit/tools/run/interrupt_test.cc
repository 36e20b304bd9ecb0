#include "tools/run/interrupt.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

namespace koboshi::tools {
namespace {

bool is_blocked(int signal) {
  sigset_t now;
  pthread_sigmask(SIG_BLOCK, nullptr, &now);
  return sigismember(&now, signal) == 1;
}

TEST(Interrupt, IsRequestedOnceForEachSignal) {
  Interrupt interrupt;
  EXPECT_FALSE(interrupt.requested());
  raise(SIGINT);
  EXPECT_TRUE(interrupt.requested());
  EXPECT_FALSE(interrupt.requested());
  raise(SIGTERM);
  EXPECT_TRUE(interrupt.requested());
  EXPECT_FALSE(interrupt.requested());
}

TEST(Interrupt, IsReceivedInAnyThread) {
  Interrupt interrupt;
  bool blocked = false;
  std::thread([&blocked] { blocked = is_blocked(SIGINT) && is_blocked(SIGTERM); }).join();
  EXPECT_TRUE(blocked);
  kill(getpid(), SIGINT);
  EXPECT_TRUE(interrupt.requested());
}

// A wait of an hour ends at once, and the signal is still there to be requested.
TEST(Interrupt, EndsWaits) {
  using namespace std::chrono_literals;
  Interrupt interrupt;
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  raise(SIGINT);
  interrupt.sleep_until(std::chrono::steady_clock::now() + 1h);
  EXPECT_FALSE(interrupt.wait_for_input(pipe[0], 3'600'000'000));
  EXPECT_EQ(interrupt.requested(), SIGINT);
  EXPECT_TRUE(interrupt.wait_for_input(pipe[0], 1));
  ASSERT_EQ(::write(pipe[1], "x", 1), 1);
  EXPECT_TRUE(interrupt.wait_for_input(pipe[0], 3'600'000'000));
  for (const int end : pipe) ::close(end);
}

TEST(Interrupt, CanBeReleased) {
  Interrupt interrupt;
  interrupt.release();
  EXPECT_FALSE(is_blocked(SIGINT));
}

TEST(Interrupt, RestoresTheSignalHandlers) {
  ASSERT_FALSE(is_blocked(SIGINT));
  {
    const Interrupt interrupt;
    EXPECT_TRUE(is_blocked(SIGINT));
  }
  EXPECT_FALSE(is_blocked(SIGINT));
}

}  // namespace
}  // namespace koboshi::tools
