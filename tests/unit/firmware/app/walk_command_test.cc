#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "firmware/canopen/frame.h"
#include "firmware/fixed/host/convert.h"
#include "tests/support/controller_bench.h"
#include "tests/support/sdo_pc.h"

namespace koboshi::app {
namespace {

using test::ControllerBench;
using walk::Velocity;

constexpr int kGetsReady_ms = 1'200;  // time to bend the knees and shift the weight to the first support foot
constexpr int kComesToItsEnd_ms = 5'000;

class ControllerWalk : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench.run_until_ready_to_walk()); }

  void send(const Velocity& velocity) {
    hal::CanFrame frame{.identifier = 0x301, .size = 6};
    canopen::store_u16(&frame.data[0], static_cast<std::uint16_t>(velocity.forward_mm_per_s));
    canopen::store_u16(&frame.data[2], static_cast<std::uint16_t>(velocity.left_mm_per_s));
    canopen::store_u16(&frame.data[4], static_cast<std::uint16_t>(velocity.turn_mrad_per_s));
    bench.board.can.deliver(frame);
    bench.run_ms(1);
  }
  std::vector<fixed::Angle> targets() const {
    std::vector<fixed::Angle> angles;
    for (std::size_t joint = 0; joint < bench.model().joint_count; ++joint)
      angles.push_back(bench.target(joint));
    return angles;
  }
  // Returns the largest difference of the hip pitches in two steps, a measure of the step length.
  double stride_rad() {
    double widest_rad = 0.0;
    for (int tick = 0; tick < 52; ++tick) {
      bench.run_ms(10);
      const double hips_rad = fixed::to_double(bench.target(2)) - fixed::to_double(bench.target(8));
      widest_rad = std::max(widest_rad, std::abs(hips_rad));
    }
    return widest_rad;
  }

  ControllerBench bench;
};

TEST_F(ControllerWalk, StartsOnCommand) {
  const auto standing = targets();
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().state, State::kWalking);
  EXPECT_EQ(bench.now().reason, Reason::kCommand);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  bench.run_ms(kGetsReady_ms);
  EXPECT_EQ(bench.now().state, State::kWalking);
  EXPECT_NE(targets(), standing);
}

TEST_F(ControllerWalk, PublishesItsPlannedZmp) {
  const auto& balance = bench.values().balance;
  EXPECT_EQ(balance.flags & kPlannedZmpValid, 0);
  bench.command(Command::kWalk);
  bench.run_ms(kGetsReady_ms);
  int right = 0;
  for (int tick = 0; tick < 52; ++tick) {  // two steps
    bench.run_ms(10);
    ASSERT_NE(balance.flags & kPlannedZmpValid, 0);
    if ((balance.flags & kPlanIsInRight) != 0) ++right;
    EXPECT_LT(std::abs(balance.planned_zmp[0] / 32.768), 40.0) << "mm in front of the ankle";
    EXPECT_LT(std::abs(balance.planned_zmp[1] / 32.768), 80.0) << "mm beside it";
  }
  EXPECT_NEAR(right, 26, 5);
  bench.command(Command::kStop);
  ASSERT_TRUE(bench.run_until(State::kStanding, kComesToItsEnd_ms));
  bench.run_ms(20);
  EXPECT_EQ(balance.flags & (kPlannedZmpValid | kPlanIsInRight), 0);
  EXPECT_EQ(balance.planned_zmp[1], 0);
}

TEST_F(ControllerWalk, AcceptsAVelocityWhileWalking) {
  test::SdoPc pc{bench};
  ASSERT_EQ(pc.write({0x2132, 9}, 0, 2),
            canopen::AbortCode::kNone);  // the robot of the bench does not lean as planned
  bench.command(Command::kWalk);
  bench.run_ms(kGetsReady_ms);
  const double on_the_spot_rad = stride_rad();
  send({200, 0, 0});
  bench.run_ms(2'000);
  EXPECT_GT(stride_rad(), 1.5 * on_the_spot_rad);
}

TEST_F(ControllerWalk, TakesAWrittenStepTimeWithinTwoSteps) {
  test::SdoPc pc{bench};
  // Returns the cycles between two steps onto the right foot.
  const auto cycles_of_two_steps = [this] {
    const auto is_right = [this] { return (bench.values().balance.flags & kPlanIsInRight) != 0; };
    int cycles = 0;
    for (int change = 0; change < 2; ++change) {
      const bool was_right = is_right();
      for (; cycles < 200 && is_right() == was_right; ++cycles) bench.run_ms(10);
    }
    return cycles;
  };
  bench.command(Command::kWalk);
  bench.run_ms(kGetsReady_ms);
  cycles_of_two_steps();  // up to the beginning of a step
  EXPECT_EQ(cycles_of_two_steps(), 2 * bench.values().walk.step.time_ms / 10);
  ASSERT_EQ(pc.write({0x2130, 1}, 320, 2), canopen::AbortCode::kNone);
  cycles_of_two_steps();
  EXPECT_EQ(cycles_of_two_steps(), 64);
  EXPECT_EQ(bench.now().state, State::kWalking);
  EXPECT_EQ(pc.write({0x2130, 1}, 601, 2), canopen::AbortCode::kValueTooHigh);
  EXPECT_EQ(cycles_of_two_steps(), 64);
}

TEST_F(ControllerWalk, EndsAtTheStandingTargetsOnStop) {
  const auto standing = targets();
  send({150, 30, 300});
  bench.command(Command::kWalk);
  bench.run_ms(3'000);
  bench.command(Command::kStop);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  EXPECT_EQ(bench.now().state, State::kWalking);
  ASSERT_TRUE(bench.run_until(State::kStanding, kComesToItsEnd_ms));
  EXPECT_EQ(bench.now().reason, Reason::kProgress);
  bench.run_ms(20);
  EXPECT_EQ(targets(), standing);
}

TEST_F(ControllerWalk, RevokesTheStopOnANewWalkCommand) {
  send({150, 0, 0});
  bench.command(Command::kWalk);
  bench.run_ms(3'000);
  bench.command(Command::kStop);
  bench.run_ms(100);
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  EXPECT_FALSE(bench.run_until(State::kStanding, kComesToItsEnd_ms));
}

TEST_F(ControllerWalk, WalksAgainAfterItHasStood) {
  for (int walk = 0; walk < 2; ++walk) {
    bench.command(Command::kWalk);
    ASSERT_EQ(bench.now().state, State::kWalking);
    bench.run_ms(2'000);
    bench.command(Command::kStop);
    ASSERT_TRUE(bench.run_until(State::kStanding, kComesToItsEnd_ms));
  }
}

TEST_F(ControllerWalk, PlaysNoMotionOfItsLegsWhileWalking) {
  bench.command(Command::kWalk);
  bench.run_ms(kGetsReady_ms);
  bench.command(Command::kPlay, 1);
  EXPECT_EQ(bench.now().refusal, Reason::kJointsInUse);
  EXPECT_EQ(bench.now().state, State::kWalking);
}

TEST_F(ControllerWalk, IsRefusedWhileAMotionPlays) {
  bench.command(Command::kPlay, 1);
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  EXPECT_EQ(bench.now().state, State::kMotion);
}

TEST_F(ControllerWalk, EndsInFaultLimpOrEmergencyStopAndStaysThere) {
  const auto ends = [&](const auto& cause, State state) {
    ControllerBench walks;
    ASSERT_TRUE(walks.run_until_ready_to_walk());
    walks.command(Command::kWalk);
    walks.run_ms(kGetsReady_ms);
    cause(walks);
    walks.run_ms(20);
    EXPECT_EQ(walks.now().state, state);
    walks.run_ms(1'000);
    EXPECT_EQ(walks.now().state, state);
    EXPECT_FALSE(walks.board.drive_enable.enabled());
  };
  ends([](ControllerBench& b) { b.command(Command::kLimp); }, State::kLimp);
  ends([](ControllerBench& b) { b.command(Command::kEmergencyStop); }, State::kEmergencyStop);
  ends([](ControllerBench& b) { b.board.can.deliver(b.drives[0].emergency(0xFF01)); }, State::kFault);
  ends(
      [](ControllerBench& b) {
        b.imu_speaks = false;
        b.run_ms(100);
      },
      State::kFault);
}

TEST(ControllerWalkCommand, IsRefusedUnlessTheRobotStands) {
  ControllerBench bench;
  bench.run_ms(25);
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  ASSERT_TRUE(bench.run_until(State::kLimp));
  bench.command(Command::kWalk);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
  EXPECT_EQ(bench.now().state, State::kLimp);
}

}  // namespace
}  // namespace koboshi::app
