// The event timer of the velocity's RPDO (0x1401:05): a walk ends when nobody repeats its velocity any more.

#include <gtest/gtest.h>

#include <vector>

#include "firmware/canopen/frame.h"
#include "tests/support/controller_bench.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;

constexpr std::uint16_t kControllerEmergency = 0x081;
constexpr std::uint16_t kVelocityTimeout = 0x8250;
constexpr std::uint16_t kVelocityDeadline_ms = 500;
// A walk that is stopped finishes its step and brings the feet together.
constexpr int kWalkEnds_ms = 5'000;

class VelocityDeadline : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench.run_until_ready_to_walk()); }

  void deliver(const hal::CanFrame& frame) {
    bench.board.can.deliver(frame);
    bench.run_ms(1);
  }
  // Writes 0x1401:05 by SDO.
  void set_deadline(std::uint16_t time_ms) {
    hal::CanFrame request{.identifier = 0x601, .size = 8, .data = {0x2B, 0x01, 0x14, 5}};
    canopen::store_u16(&request.data[4], time_ms);
    deliver(request);
    const auto answer = bench.last_sent(0x581);
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->data[0], 0x60);
  }
  void send_velocity() {
    hal::CanFrame frame{.identifier = test::kVelocityIdentifier, .size = 6};
    canopen::store_u16(&frame.data[0], 150);
    deliver(frame);
  }
  // Error codes of the controller's emergency messages so far.
  std::vector<int> emergencies() const {
    std::vector<int> codes;
    for (const auto& [time_us, frame] : bench.sent)
      if (frame.identifier == kControllerEmergency) codes.push_back(canopen::load_u16(frame.data.data()));
    return codes;
  }
  void walk_for(int duration_ms) {
    bench.command(Command::kWalk);
    bench.run_ms(duration_ms);
    ASSERT_EQ(bench.now().state, State::kWalking);
  }

  ControllerBench bench;
};

TEST_F(VelocityDeadline, EndsAWalkWhoseVelocityIsNotRepeated) {
  set_deadline(kVelocityDeadline_ms);
  send_velocity();
  walk_for(kVelocityDeadline_ms - 10);
  EXPECT_TRUE(emergencies().empty());
  bench.run_ms(20);
  EXPECT_EQ(emergencies(), std::vector<int>{kVelocityTimeout});
  EXPECT_EQ(bench.now().state, State::kWalking);  // it finishes its step
  ASSERT_TRUE(bench.run_until(State::kStanding, kWalkEnds_ms));
  EXPECT_EQ(bench.now().reason, Reason::kProgress);
  bench.run_ms(2'000);
  EXPECT_EQ(bench.now().state, State::kStanding);
  EXPECT_EQ(emergencies(), std::vector<int>{kVelocityTimeout});  // once
}

TEST_F(VelocityDeadline, LetsAWalkGoOnWhoseVelocityIsRepeated) {
  set_deadline(kVelocityDeadline_ms);
  send_velocity();
  bench.command(Command::kWalk);
  for (int repetition = 0; repetition < 20; ++repetition) {
    bench.run_ms(kVelocityDeadline_ms - 20);
    ASSERT_EQ(bench.now().state, State::kWalking) << repetition;
    send_velocity();
  }
  EXPECT_TRUE(emergencies().empty());
}

TEST_F(VelocityDeadline, IsOffAtZero) {
  send_velocity();
  walk_for(30'000);
  EXPECT_TRUE(emergencies().empty());
  set_deadline(kVelocityDeadline_ms);
  send_velocity();
  set_deadline(0);
  bench.run_ms(10'000);
  EXPECT_EQ(bench.now().state, State::kWalking);
  EXPECT_TRUE(emergencies().empty());
}

// CiA 301, 7.5.2.35: the timer starts with the first reception.
TEST_F(VelocityDeadline, DoesNotStartBeforeAReception) {
  set_deadline(kVelocityDeadline_ms);
  walk_for(10'000);
  EXPECT_TRUE(emergencies().empty());
}

TEST_F(VelocityDeadline, OnlyReportsARobotThatDoesNotWalk) {
  set_deadline(kVelocityDeadline_ms);
  send_velocity();
  bench.command(Command::kPlay, 1);  // until it is stopped
  ASSERT_EQ(bench.now().state, State::kMotion);
  bench.run_ms(3'000);
  EXPECT_EQ(emergencies(), std::vector<int>{kVelocityTimeout});
  EXPECT_EQ(bench.now().state, State::kMotion);
}

// A velocity that comes late ends the error; the stopped walk goes on by the command, not by itself.
TEST_F(VelocityDeadline, WalksOnByCommandAfterALateVelocity) {
  set_deadline(kVelocityDeadline_ms);
  send_velocity();
  walk_for(kVelocityDeadline_ms + 100);
  send_velocity();
  EXPECT_EQ(emergencies(), (std::vector<int>{kVelocityTimeout, 0}));
  bench.command(Command::kWalk);
  for (int repetition = 0; repetition < 12; ++repetition) {
    bench.run_ms(kVelocityDeadline_ms - 20);
    send_velocity();
  }
  EXPECT_EQ(bench.now().state, State::kWalking);
}

TEST_F(VelocityDeadline, DoesNotResumeAWalkByALateVelocityAlone) {
  set_deadline(kVelocityDeadline_ms);
  send_velocity();
  walk_for(kVelocityDeadline_ms + 100);
  send_velocity();
  EXPECT_TRUE(bench.run_until(State::kStanding, kWalkEnds_ms));
}

}  // namespace
}  // namespace koboshi::app
