#include "tools/teleop/pilot.h"

#include <gtest/gtest.h>

#include <numbers>

namespace koboshi::tools {
namespace {

using behaviour::State;
using Kind = simulation::Command::Kind;

class PilotTest : public testing::Test {
 protected:
  // The command that a key leads to.
  simulation::Command command(Key key, State state = State::kWalking) {
    const Order order = pilot_.press(key, state);
    EXPECT_TRUE(std::holds_alternative<simulation::Command>(order)) << name_of(key);
    const auto* command = std::get_if<simulation::Command>(&order);
    return command == nullptr ? simulation::Command{} : *command;
  }
  bool is_nothing(Key key, State state = State::kWalking) {
    return std::holds_alternative<std::monostate>(pilot_.press(key, state));
  }

  static constexpr walk::VelocityLimits kLimits{
      .forward_mm_per_s = 300, .backward_mm_per_s = 250, .lateral_mm_per_s = 100, .turn_mrad_per_s = 1000};
  Pilot pilot_{kLimits};
};

TEST_F(PilotTest, WalksInPlaceAndStops) {
  EXPECT_EQ(command(Key::kGo, State::kStanding).kind, Kind::kWalk);
  EXPECT_EQ(command(Key::kGo).velocity, Eigen::Vector3d::Zero());
  EXPECT_EQ(command(Key::kStop).kind, Kind::kStop);
}

TEST_F(PilotTest, ChangesTheVelocityStepByStep) {
  EXPECT_EQ(command(Key::kForward, State::kStanding).kind, Kind::kWalk);
  EXPECT_EQ(command(Key::kForward).velocity, Eigen::Vector3d(0.04, 0.0, 0.0));
  EXPECT_EQ(command(Key::kBackward).velocity, Eigen::Vector3d(0.02, 0.0, 0.0));
  EXPECT_EQ(command(Key::kLeft).velocity, Eigen::Vector3d(0.02, 0.02, 0.0));
  EXPECT_EQ(command(Key::kTurnRight).velocity, Eigen::Vector3d(0.02, 0.02, -0.1));
  command(Key::kRight);
  EXPECT_EQ(command(Key::kRight).velocity, Eigen::Vector3d(0.02, -0.02, -0.1));
  command(Key::kTurnLeft);
  EXPECT_EQ(command(Key::kTurnLeft).velocity, Eigen::Vector3d(0.02, -0.02, 0.1));
  EXPECT_EQ(command(Key::kGo).velocity, Eigen::Vector3d(0.02, -0.02, 0.1));
}

TEST_F(PilotTest, StaysWithinTheLimits) {
  const auto press_often = [&](Key key) {
    for (int i = 0; i < 100; ++i) command(key);
  };
  for (const Key key : {Key::kForward, Key::kLeft, Key::kTurnLeft}) press_often(key);
  EXPECT_EQ(pilot_.velocity(), kLimits.highest());
  for (const Key key : {Key::kBackward, Key::kRight, Key::kTurnRight}) press_often(key);
  EXPECT_EQ(pilot_.velocity(), kLimits.lowest());
}

TEST_F(PilotTest, StartsAgainAfterAStop) {
  command(Key::kForward);
  command(Key::kStop);
  EXPECT_EQ(command(Key::kGo, State::kStanding).velocity, Eigen::Vector3d::Zero());
}

TEST_F(PilotTest, IgnoresVelocityKeysUnlessStanding) {
  for (const State state : {State::kBoot, State::kLimp, State::kEnabling, State::kSoftStart, State::kMotion,
                            State::kFault, State::kEmergencyStop}) {
    command(Key::kForward);
    EXPECT_TRUE(is_nothing(Key::kForward, state));
    EXPECT_EQ(pilot_.velocity(), walk::Velocity{});
  }
}

TEST_F(PilotTest, SendsCommandsInAnyState) {
  for (int number = 0; number <= static_cast<int>(State::kWalking); ++number) {
    const auto state = static_cast<State>(number);
    EXPECT_EQ(command(Key::kEmergencyStop, state).kind, Kind::kEmergencyStop);
    EXPECT_EQ(command(Key::kReset, state).kind, Kind::kReset);
    EXPECT_EQ(command(Key::kEnable, state).kind, Kind::kEnable);
    EXPECT_EQ(command(Key::kStop, state).kind, Kind::kStop);
    EXPECT_TRUE(std::holds_alternative<EndOfRun>(pilot_.press(Key::kEnd, state)));
  }
}

TEST_F(PilotTest, PushesInTheDirectionOfTheNextKey) {
  const auto pushed = [&](Key key) {
    EXPECT_TRUE(is_nothing(Key::kPush));
    EXPECT_TRUE(pilot_.aims());
    const Order order = pilot_.press(key, State::kWalking);
    EXPECT_TRUE(std::holds_alternative<BodyPush>(order)) << name_of(key);
    const auto* push = std::get_if<BodyPush>(&order);
    return push == nullptr ? Eigen::Vector2d(0.0, 0.0) : push->impulse_B_N_s;
  };
  EXPECT_EQ(pushed(Key::kForward), Eigen::Vector2d(0.2, 0.0));
  EXPECT_EQ(pushed(Key::kBackward), Eigen::Vector2d(-0.2, 0.0));
  for (const Key left : {Key::kLeft, Key::kTurnLeft}) EXPECT_EQ(pushed(left), Eigen::Vector2d(0.0, 0.2));
  for (const Key right : {Key::kRight, Key::kTurnRight}) EXPECT_EQ(pushed(right), Eigen::Vector2d(0.0, -0.2));
  EXPECT_FALSE(pilot_.aims());
  EXPECT_EQ(pilot_.velocity(), walk::Velocity{});
}

TEST_F(PilotTest, CancelsAPushOnAnotherKey) {
  EXPECT_TRUE(is_nothing(Key::kPush));
  command(Key::kStop);
  EXPECT_FALSE(pilot_.aims());
  EXPECT_EQ(command(Key::kForward).kind, Kind::kWalk);
}

TEST_F(PilotTest, ChangesTheSizeOfAPush) {
  EXPECT_TRUE(is_nothing(Key::kPushMore));
  EXPECT_DOUBLE_EQ(pilot_.push_N_s(), 0.25);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_nothing(Key::kPushLess));
  EXPECT_DOUBLE_EQ(pilot_.push_N_s(), 0.05);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_nothing(Key::kPushMore));
  EXPECT_DOUBLE_EQ(pilot_.push_N_s(), 2.0);
}

TEST_F(PilotTest, DescribesEachKey) {
  const auto effect = [&](Key key, State state = State::kWalking) {
    static_cast<void>(pilot_.press(key, state));
    return pilot_.effect();
  };
  EXPECT_EQ(effect(Key::kGo), "walk, in place");
  EXPECT_EQ(effect(Key::kForward), "walk, 0.02 m/s forward");
  EXPECT_EQ(effect(Key::kTurnRight), "walk, 0.02 m/s forward, 0.10 rad/s to the right");
  for (int i = 0; i < 100; ++i) effect(Key::kForward);
  EXPECT_EQ(pilot_.effect(), "walk, 0.30 m/s forward, 0.10 rad/s to the right, the limit");
  EXPECT_EQ(effect(Key::kForward, State::kFallen),
            "nothing: it takes a velocity when it stands or walks only");
  EXPECT_EQ(effect(Key::kPush), "push with 0.20 N s: now a direction");
  EXPECT_EQ(effect(Key::kLeft), "push to the left with 0.20 N s");
  EXPECT_EQ(effect(Key::kPushMore), "the next push has 0.25 N s");
  for (int number = 0; number <= static_cast<int>(Key::kEnd); ++number) {
    EXPECT_NE(effect(static_cast<Key>(number)), "") << number;
  }
}

TEST(BodyPush, HasItsImpulseInTheRobotsHeading) {
  simulation::Push push = BodyPush{{0.2, 0.0}}.on("trunk", 0.5 * std::numbers::pi);
  EXPECT_EQ(push.link.text, "trunk");
  EXPECT_EQ(push.shape, simulation::Push::Shape::kHalfSine);
  push.at_us = 1'000'000;
  const Eigen::Vector3d impulse_W_N_s = 0.1 * push.mean_force_W_N(1'000'000, 1'100'000);
  EXPECT_NEAR(impulse_W_N_s.x(), 0.0, 1e-12);
  EXPECT_NEAR(impulse_W_N_s.y(), 0.2, 1e-12);
  EXPECT_EQ(impulse_W_N_s.z(), 0.0);
  EXPECT_EQ(push.mean_force_W_N(1'100'000, 1'200'000), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace koboshi::tools
