#include "studio/gamepad/gamepad_pilot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

namespace koboshi::studio {
namespace {

using Kind = simulation::Command::Kind;

constexpr std::uint64_t kTick_us = 20'000;

// A pad that returns what was pushed, one state per reading; empty: no pad.
class FakeGamepads final : public Gamepads {
 public:
  std::optional<GamepadState> read() override {
    if (states.empty()) return last;
    last = states.front();
    states.pop_front();
    return last;
  }
  std::string name() const override { return "fake"; }

  std::deque<std::optional<GamepadState>> states;
  std::optional<GamepadState> last;
};

class GamepadPilotTest : public ::testing::Test {
 protected:
  GamepadPilotTest() { pilot.set_limits({0.2, 0.1, 0.05, 0.8}); }

  // Reads the pad once in each tick.
  std::vector<simulation::Command> run(std::uint64_t ticks = 1) {
    std::vector<simulation::Command> all;
    for (std::uint64_t i = 0; i < ticks; ++i) {
      now_us += kTick_us;
      for (const simulation::Command& command : pilot.take(pad.read(), now_us)) all.push_back(command);
    }
    return all;
  }
  void set(const std::optional<GamepadState>& state) { pad.states.push_back(state); }
  std::vector<Kind> kinds(const std::vector<simulation::Command>& commands) {
    std::vector<Kind> kinds;
    for (const simulation::Command& command : commands) kinds.push_back(command.kind);
    return kinds;
  }
  static GamepadState with(GamepadButton button) {
    GamepadState state;
    state.pressed[static_cast<std::size_t>(button)] = true;
    return state;
  }

  FakeGamepads pad;
  GamepadPilot pilot;
  std::uint64_t now_us = 0;
};

TEST_F(GamepadPilotTest, GivesNothingWithoutAPad) {
  set(std::nullopt);
  EXPECT_TRUE(run(100).empty());
}

TEST_F(GamepadPilotTest, IgnoresSticksWithinTheDeadBand) {
  set(GamepadState{.left_x = 0.14, .left_y = -0.14, .right_x = 0.15});
  EXPECT_TRUE(run(100).empty());
}

TEST_F(GamepadPilotTest, MapsSticksToTheLimits) {
  set(GamepadState{});
  EXPECT_TRUE(run().empty());
  set(GamepadState{.left_y = 1.0});
  auto commands = run();
  ASSERT_EQ(kinds(commands), std::vector{Kind::kWalk});
  EXPECT_EQ(commands[0].velocity, Eigen::Vector3d(0.2, 0.0, 0.0));
  // Right and clockwise are negative.
  EXPECT_EQ(*pilot.velocity_of({.left_x = 1.0, .left_y = -1.0, .right_x = 1.0}),
            Eigen::Vector3d(-0.1, -0.05, -0.8));
  // Just beyond the dead band the robot is slow, and speed grows with the deflection.
  double before = 0.0;
  for (double axis = 0.16; axis <= 1.0; axis += 0.01) {
    const double forward = pilot.velocity_of({.left_y = axis})->x();
    EXPECT_GE(forward, before);
    before = forward;
  }
  EXPECT_LE(pilot.velocity_of({.left_y = 0.16})->x(), 0.005);
}

TEST_F(GamepadPilotTest, RepeatsTheVelocityWhileItIsHeldAndStopsOnce) {
  set(GamepadState{});
  set(GamepadState{.left_y = 0.6});
  const auto commands = run(101);  // the stick is held for 2 s
  EXPECT_EQ(kinds(commands), std::vector(20, Kind::kWalk));
  set(GamepadState{});
  EXPECT_EQ(kinds(run()), std::vector{Kind::kStop});
  EXPECT_TRUE(run(100).empty());
}

TEST_F(GamepadPilotTest, StopsWhenThePadIsLost) {
  set(GamepadState{});
  set(GamepadState{.left_y = 0.6});
  static_cast<void>(run(3));
  set(std::nullopt);
  EXPECT_EQ(kinds(run()), std::vector{Kind::kStop});
  EXPECT_FALSE(pilot.walks());
  // It comes back with the stick pushed: nothing until the stick has been released.
  set(GamepadState{.left_y = 1.0});
  EXPECT_TRUE(run(20).empty());
  set(GamepadState{});
  set(GamepadState{.left_y = 1.0});
  EXPECT_EQ(kinds(run(2)), std::vector{Kind::kWalk});
}

TEST_F(GamepadPilotTest, GivesACommandPerPress) {
  set(GamepadState{});
  static_cast<void>(run());
  for (const ButtonMeaning& meaning : kButtonMeanings) {
    set(with(meaning.button));
    EXPECT_EQ(kinds(run(50)), std::vector{meaning.command}) << meaning.place;
    set(GamepadState{});
    EXPECT_TRUE(run().empty());
  }
}

TEST_F(GamepadPilotTest, IgnoresButtonsThatAreDownWhenThePadComes) {
  set(with(GamepadButton::kSouth));
  EXPECT_TRUE(run(10).empty());
}

TEST_F(GamepadPilotTest, EmergencyStopEndsTheWalk) {
  set(GamepadState{});
  set(GamepadState{.left_y = 1.0});
  static_cast<void>(run(2));
  GamepadState both = with(GamepadButton::kLeftShoulder);
  both.left_y = 1.0;
  set(both);
  EXPECT_EQ(kinds(run()), std::vector{Kind::kEmergencyStop});
  EXPECT_TRUE(run(100).empty());  // the stick is still pushed
}

TEST_F(GamepadPilotTest, EnableKeepsTheSticks) {
  set(GamepadState{});
  GamepadState both = with(GamepadButton::kSouth);
  both.left_y = 1.0;
  set(both);
  EXPECT_EQ(kinds(run(2)), (std::vector{Kind::kWalk, Kind::kEnable}));
}

TEST_F(GamepadPilotTest, NoiseOfAStickIsNoNewVelocity) {
  for (double axis = 0.5; axis < 0.51; axis += 0.001)
    EXPECT_NEAR(pilot.velocity_of({.left_y = axis})->x(), pilot.velocity_of({.left_y = 0.505})->x(), 0.0041);
}

}  // namespace
}  // namespace koboshi::studio
