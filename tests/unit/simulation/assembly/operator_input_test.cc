#include "simulation/assembly/operator_input.h"

#include <gtest/gtest.h>

#include <string>

#include "base/text/error.h"
#include "simulation/scenario/operator_pc.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {
namespace {

class OperatorInput : public testing::Test {
 protected:
  Simulation simulation_{
      read_scenario(std::string(KOBOSHI_SOURCE_DIR) + "/scenarios/squat.yaml",
                    std::vector<Override>{{"physics.stepper", "lumped"}, {"commands", "[]"}})};

  std::string error_of(const auto& act) {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  }
};

TEST_F(OperatorInput, AcceptsTheKeysOfAScenario) {
  for (int i = 0; i < 20; ++i) simulation_.advance();
  command(simulation_, "play: squat");
  command(simulation_, R"({"walk": {"forward_m_per_s": 0.2}})");
  const auto commands = simulation_.played().commands;
  ASSERT_EQ(commands.size(), 2u);
  EXPECT_EQ(commands[0].kind, Command::Kind::kPlay);
  EXPECT_EQ(commands[1].kind, Command::Kind::kWalk);
  EXPECT_EQ(commands[1].velocity.x(), 0.2);
  EXPECT_EQ(commands[1].at_us, 20'000u);
}

TEST_F(OperatorInput, RejectsWhatAScenarioMayNotContain) {
  EXPECT_EQ(error_of([&] { command(simulation_, "wlk: {}"); }),
            "commands:1: found the unknown command wlk, expected enable, play, walk, stop, stream, get_up, "
            "emergency_stop or reset; the nearest is walk");
  EXPECT_EQ(error_of([&] { command(simulation_, "walk: {forwards: 1}"); }).substr(0, 9), "commands:");
  EXPECT_EQ(error_of([&] { command(simulation_, "{at_s: 3, stop: true}"); }),
            "commands: found a time (at_s), expected none: it begins now");
  EXPECT_NE(error_of([&] {
              push(simulation_, "{link: trnk, force_N: [1, 0, 0], duration_s: 1}");
            }).find("the unknown link trnk, expected trunk"),
            std::string::npos);
  EXPECT_TRUE(simulation_.played().commands.empty());
  EXPECT_TRUE(simulation_.played().pushes.empty());
}

TEST_F(OperatorInput, SetsAParameterAndNamesOneThatIsUnknown) {
  write(simulation_, "step_time_ms", 300.0);
  EXPECT_NE(error_of([&] { write(simulation_, "step_time_us", 300.0); }).find("step_time_ms"),
            std::string::npos);
  EXPECT_NE(error_of([&] { write(simulation_, "step_time_ms", 1e6); }).find("expected 100 to 600 ms"),
            std::string::npos);
}

}  // namespace
}  // namespace koboshi::simulation
