#include "studio/run/walk_deadline.h"

#include <gtest/gtest.h>

#include "studio/gamepad/held_walk.h"
#include "studio/run/bus_monitor.h"

namespace koboshi::studio {
namespace {

using canopen::AbortCode;
using State = WalkDeadline::State;

// It comes after the monitor's own time-out, and several velocities may be lost.
static_assert(WalkDeadline::kDeadline_ms * 1000u > BusMonitor::kWalkTimeout_us);
static_assert(WalkDeadline::kDeadline_ms * 1000u >= 5 * HeldWalk::kPeriod_us);

class WalkDeadlineTest : public ::testing::Test {
 protected:
  // Answers what is due as a robot with this event timer does. Returns how many accesses there were.
  int exchange() {
    int accesses = 0;
    while (const auto request = deadline.due(now_us)) {
      ++accesses;
      EXPECT_EQ(request->node_id, 1);
      EXPECT_EQ(request->address, (canopen::ObjectAddress{0x1401, 5}));
      simulation::ObjectAnswer answer{.number = request->number, .abort = abort};
      if (abort != AbortCode::kNone) {
      } else if (request->data.empty()) {
        answer.data = {static_cast<std::uint8_t>(timer_ms), static_cast<std::uint8_t>(timer_ms >> 8)};
      } else {
        timer_ms = request->data.at(0) | request->data.at(1) << 8;
      }
      EXPECT_TRUE(deadline.take(answer, now_us));
    }
    return accesses;
  }

  WalkDeadline deadline;
  int timer_ms = 0;  // in the robot
  AbortCode abort = AbortCode::kNone;
  std::uint64_t now_us = 0;
};

TEST_F(WalkDeadlineTest, AsksNothingByItself) {
  EXPECT_EQ(exchange(), 0);
  deadline.disarm();
  EXPECT_EQ(exchange(), 0);
  EXPECT_FALSE(deadline.restoring());
  EXPECT_EQ(deadline.state(), State::kUnknown);
}

TEST_F(WalkDeadlineTest, IsArmedBeforeAWalkAndGivesTheFormerValueBack) {
  for (int walk = 0; walk < 2; ++walk) {
    deadline.arm();
    EXPECT_FALSE(deadline.permits_walk());
    EXPECT_EQ(exchange(), walk == 0 ? 2 : 1);
    EXPECT_EQ(timer_ms, 500);
    EXPECT_TRUE(deadline.permits_walk());
    EXPECT_EQ(deadline.state(), State::kWorks);
    deadline.disarm();
    EXPECT_EQ(exchange(), 1);
    EXPECT_EQ(timer_ms, 0);
  }
}

TEST_F(WalkDeadlineTest, KeepsAShorterDeadlineAndShortensALongerOne) {
  timer_ms = 300;
  deadline.arm();
  EXPECT_EQ(exchange(), 1);  // reads
  EXPECT_EQ(timer_ms, 300);
  EXPECT_TRUE(deadline.permits_walk());

  deadline = WalkDeadline();
  timer_ms = 2'000;
  deadline.arm();
  exchange();
  EXPECT_EQ(timer_ms, 500);
  deadline.disarm();
  exchange();
  EXPECT_EQ(timer_ms, 2'000);
}

TEST_F(WalkDeadlineTest, PermitsAWalkOfARobotThatRefuses) {
  abort = AbortCode::kSubindexDoesNotExist;
  deadline.arm();
  EXPECT_EQ(exchange(), 1);
  EXPECT_EQ(deadline.state(), State::kRefused);
  EXPECT_TRUE(deadline.permits_walk());
  EXPECT_EQ(exchange(), 0);  // it is not asked again
}

TEST_F(WalkDeadlineTest, PermitsNoWalkOfARobotThatDoesNotAnswer) {
  abort = AbortCode::kTimedOut;
  deadline.arm();
  for (int attempt = 0; attempt < 3; ++attempt) {
    EXPECT_EQ(exchange(), 1);
    EXPECT_EQ(deadline.state(), State::kSilent);
    EXPECT_FALSE(deadline.permits_walk());
    now_us += WalkDeadline::kRetry_us;
  }
  abort = AbortCode::kNone;
  EXPECT_EQ(exchange(), 2);
  EXPECT_TRUE(deadline.permits_walk());
}

// A write whose answer is lost may be in force: it is restored in any case.
TEST_F(WalkDeadlineTest, RestoresAfterALostAnswer) {
  deadline.arm();
  const auto read = deadline.due(0);
  ASSERT_TRUE(read);
  EXPECT_TRUE(deadline.take({.number = read->number, .data = {0x2C, 0x03}}, 0));
  const auto write = deadline.due(0);
  ASSERT_TRUE(write);
  EXPECT_EQ(deadline.restoring()->data, (std::vector<std::uint8_t>{0x2C, 0x03}));  // under way
  EXPECT_TRUE(deadline.take({.number = write->number, .abort = AbortCode::kTimedOut}, 0));
  EXPECT_FALSE(deadline.permits_walk());
  EXPECT_EQ(deadline.restoring()->data, (std::vector<std::uint8_t>{0x2C, 0x03}));
}

TEST_F(WalkDeadlineTest, LeavesAnswersToOthersAlone) {
  deadline.arm();
  ASSERT_TRUE(deadline.due(0));
  EXPECT_FALSE(deadline.take({.number = 1, .data = {0, 0}}, 0));
  EXPECT_FALSE(deadline.permits_walk());
}

}  // namespace
}  // namespace koboshi::studio
