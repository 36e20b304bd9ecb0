// A policy on the walk of scenarios/go.yaml.

#include <gtest/gtest.h>

#include <optional>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "tests/closed_loop/run.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/firmware/policy/lean_policy.h"

namespace koboshi::test {
namespace {

using app::PolicyState;
using behaviour::State;

constexpr std::uint64_t kWalks_us = 9'000'000;

class PolicyOnTheWalk : public ::testing::Test {
 protected:
  simulation::Scenario go(bool has_policy, bool enabled, std::int32_t roll_range = 1'677'722) {
    simulation::Scenario scenario = simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/go.yaml");
    if (has_policy)
      scenario.policy = write_policy(folder_.path / "lean.kpol", lean_policy(robot_.model, roll_range));
    if (enabled) scenario.parameters.push_back({{"policy_enabled", scenario.file, 0}, 1.0});
    return scenario;
  }

  TemporaryFolder folder_;
  simulation::NamedModel robot_ =
      simulation::load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
};

TEST_F(PolicyOnTheWalk, ChangesNoBitWhileItIsOff) {
  RobotRun without(go(false, false));
  RobotRun with(go(true, false));
  without.run_until_us(kWalks_us);
  with.run_until_us(kWalks_us);
  ASSERT_EQ(with.behaviour().state, State::kWalking);
  EXPECT_EQ(with.hash(), without.hash());
}

TEST_F(PolicyOnTheWalk, WalksAndRepeatsItsBits) {
  RobotRun off(go(true, false));
  RobotRun on(go(true, true));
  RobotRun again(go(true, true));
  off.run_until_us(kWalks_us);
  for (RobotRun* const run : {&on, &again}) run->run_until_us(kWalks_us);
  EXPECT_EQ(on.values().policy.state, PolicyState::kActive);
  EXPECT_EQ(on.behaviour().state, State::kWalking);
  EXPECT_EQ(on.values().policy.stops, 0);
  EXPECT_NE(on.hash(), off.hash());
  EXPECT_EQ(on.hash(), again.hash());
  EXPECT_TRUE(on.emergencies(1, 0xFF02).empty());
}

TEST_F(PolicyOnTheWalk, FallsBackToTheEngineOutOfItsRange) {
  RobotRun run(go(true, true, 23'302));  // 0.5 degrees of roll: less than a step sways
  run.run_until_us(kWalks_us);
  EXPECT_EQ(run.values().policy.state, PolicyState::kStopped);
  EXPECT_EQ(run.values().policy.cause, policy::Cause::kInputOutOfRange);
  EXPECT_EQ(run.values().policy.cause_number, 0);
  EXPECT_EQ(run.behaviour().state, State::kWalking);
  EXPECT_EQ(run.emergencies(1, 0xFF02).size(), 1u);
}

TEST_F(PolicyOnTheWalk, OfAnotherRobotIsRefusedWithOneLine) {
  robot::RobotModel other = robot_.model;
  ++other.id;
  simulation::Scenario scenario = go(true, true);
  write_policy(*scenario.policy, lean_policy(other));
  try {
    RobotRun run(scenario);
    FAIL() << "it is not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("lean.kpol: found a policy for another robot model"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace koboshi::test
