#include "tools/run/pacer.h"

#include <gtest/gtest.h>

namespace koboshi::tools {
namespace {

using std::chrono::milliseconds;

class PacerTest : public testing::Test {
 protected:
  // A Pacer at this test's own wall.
  Pacer make(std::uint64_t now_us, double speed) {
    return Pacer(now_us, speed, {[this] { return wall_; }, [this](WallClock::Time due) { wall_ = due; }});
  }

  const WallClock::Time start_{milliseconds(1'000)};
  WallClock::Time wall_ = start_;
};

TEST_F(PacerTest, WaitsForTheWallClock) {
  Pacer pacer = make(5'000, 1.0);
  pacer.wait_for(5'000);
  EXPECT_EQ(wall_, start_);
  pacer.wait_for(12'000);
  EXPECT_EQ(wall_, start_ + milliseconds(7));
  EXPECT_EQ(pacer.overruns(), 0u);
  EXPECT_EQ(pacer.largest_delay_us(), 0u);
}

TEST_F(PacerTest, RunsAtItsSpeed) {
  Pacer fast = make(0, 10.0);
  fast.wait_for(50'000);
  EXPECT_EQ(wall_, start_ + milliseconds(5));
  Pacer slow = make(0, 0.5);
  slow.wait_for(50'000);
  EXPECT_EQ(wall_, start_ + milliseconds(105));
}

TEST_F(PacerTest, CountsDelaysBeyondItsTolerance) {
  Pacer pacer = make(0, 1.0);
  wall_ = start_ + std::chrono::microseconds(1'000 + Pacer::kTolerance_us);
  pacer.wait_for(1'000);
  EXPECT_EQ(pacer.overruns(), 0u);
  EXPECT_EQ(pacer.largest_delay_us(), Pacer::kTolerance_us);
  wall_ += std::chrono::microseconds(1);
  pacer.wait_for(1'000);
  EXPECT_EQ(pacer.overruns(), 1u);
  EXPECT_EQ(pacer.largest_delay_us(), Pacer::kTolerance_us + 1);
}

TEST_F(PacerTest, ReportsItsLag) {
  Pacer pacer = make(0, 1.0);
  wall_ = start_ + milliseconds(30);
  pacer.wait_for(10'000);
  EXPECT_EQ(pacer.delay_us(), 20'000u);
  pacer.wait_for(40'000);
  EXPECT_EQ(pacer.delay_us(), 0u);
}

TEST_F(PacerTest, CatchesUpAfterADelay) {
  Pacer pacer = make(0, 1.0);
  wall_ = start_ + milliseconds(10);
  for (std::uint64_t now_us = 1'000; now_us <= 10'000; now_us += 1'000) pacer.wait_for(now_us);
  EXPECT_EQ(wall_, start_ + milliseconds(10));
  pacer.wait_for(11'000);
  EXPECT_EQ(wall_, start_ + milliseconds(11));
  EXPECT_EQ(pacer.largest_delay_us(), 9'000u);
}

}  // namespace
}  // namespace koboshi::tools
