// The deadline of the velocity (event timer of its RPDO, 0x1401:05), which is on after a reset: a walk ends
// when its velocity is not repeated.

#include <gtest/gtest.h>

#include <vector>

#include "firmware/canopen/frame.h"
#include "tests/support/controller_bench.h"
#include "tests/support/sdo_pc.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;

constexpr std::uint16_t kControllerEmergency = 0x081;
constexpr std::uint16_t kVelocityTimeout = 0x8250;
// A walk that is stopped finishes its step and brings the feet together.
constexpr int kWalkEnds_ms = 5'000;

class VelocityDeadline : public testing::Test {
 protected:
  void SetUp() override {
    bench.velocity_repeats = false;
    ASSERT_TRUE(bench.run_until_ready_to_walk());
  }

  void deliver(const hal::CanFrame& frame) {
    bench.board.can.deliver(frame);
    bench.run_ms(1);
  }
  // Writes 0x1401:05 by SDO.
  void set_deadline(std::uint16_t time_ms) {
    ASSERT_EQ(pc.write({0x1401, 5}, time_ms, 2), canopen::AbortCode::kNone);
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
  test::SdoPc pc{bench};
};

TEST_F(VelocityDeadline, EndsAWalkWhoseVelocityIsNotRepeated) {
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
  set_deadline(0);
  send_velocity();
  walk_for(30'000);
  EXPECT_TRUE(emergencies().empty());
}

TEST_F(VelocityDeadline, IsOffAtZeroFromTheNextVelocityOn) {
  send_velocity();
  set_deadline(0);
  walk_for(10'000);
  EXPECT_TRUE(emergencies().empty());
}

TEST_F(VelocityDeadline, CoversAVelocityBySdo) {
  ASSERT_EQ(pc.write({0x2110, 1}, 150, 2), canopen::AbortCode::kNone);
  ASSERT_EQ(pc.write({0x2000, 1}, static_cast<int>(Command::kWalk), 1), canopen::AbortCode::kNone);
  for (int repetition = 0; repetition < 10; ++repetition) {
    bench.run_ms(kVelocityDeadline_ms - 20);
    ASSERT_EQ(pc.write({0x2110, 1}, 150, 2), canopen::AbortCode::kNone);
  }
  EXPECT_EQ(bench.now().state, State::kWalking);
  EXPECT_TRUE(emergencies().empty());
  bench.run_ms(kVelocityDeadline_ms + 20);
  EXPECT_EQ(emergencies(), std::vector<int>{kVelocityTimeout});
  EXPECT_TRUE(bench.run_until(State::kStanding, kWalkEnds_ms));
}

// A walk without any velocity, or with one of long ago, ends as well.
TEST_F(VelocityDeadline, CoversAWalkByCommandAlone) {
  walk_for(kVelocityDeadline_ms - 10);
  EXPECT_TRUE(emergencies().empty());
  bench.run_ms(20);
  EXPECT_EQ(emergencies(), std::vector<int>{kVelocityTimeout});
  ASSERT_TRUE(bench.run_until(State::kStanding, kWalkEnds_ms));
  walk_for(kVelocityDeadline_ms + 20);
  EXPECT_EQ(emergencies(), (std::vector<int>{kVelocityTimeout, 0, kVelocityTimeout}));
  EXPECT_TRUE(bench.run_until(State::kStanding, kWalkEnds_ms));
}

TEST_F(VelocityDeadline, IsNoErrorOfARobotThatDoesNotWalk) {
  send_velocity();
  bench.command(Command::kPlay, 1);  // until it is stopped
  ASSERT_EQ(bench.now().state, State::kMotion);
  bench.run_ms(3'000);
  EXPECT_TRUE(emergencies().empty());
  EXPECT_EQ(bench.now().state, State::kMotion);
}

// The operator who has ended the walk repeats no velocity.
TEST_F(VelocityDeadline, IsNoErrorOfAWalkThatIsToEnd) {
  send_velocity();
  walk_for(400);
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding, kWalkEnds_ms));
  bench.run_ms(2'000);
  EXPECT_TRUE(emergencies().empty());
}

// A velocity that comes late ends the error; the stopped walk goes on by the command, not by itself.
TEST_F(VelocityDeadline, WalksOnByCommandAfterALateVelocity) {
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
  send_velocity();
  walk_for(kVelocityDeadline_ms + 100);
  send_velocity();
  EXPECT_TRUE(bench.run_until(State::kStanding, kWalkEnds_ms));
}

}  // namespace
}  // namespace koboshi::app
