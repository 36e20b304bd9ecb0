#include "tools/run/interrupt.h"

#include <gtest/gtest.h>

#include <unistd.h>

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
