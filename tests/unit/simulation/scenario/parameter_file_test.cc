#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "simulation/scenario/reader.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

namespace koboshi::simulation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kScenario =
    "version: 1\n"
    "robot: robots/box/robot.sdf\n"
    "duration_s: 1\n"
    "parameter_file: robots/box/standing.yaml\n";

class ParameterFile : public ::testing::Test {
 protected:
  Scenario read(const std::string& parameter_file, const std::string& rest = "") const {
    tree_.write("robots/box/standing.yaml", parameter_file);
    return read_scenario(tree_.write("scenarios/test.yaml", kScenario + rest));
  }
  std::string refusal(const std::string& parameter_file) const {
    try {
      static_cast<void>(read(parameter_file));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryTree tree_;
};

std::vector<std::pair<std::string, double>> settings(const Scenario& scenario) {
  std::vector<std::pair<std::string, double>> pairs;
  for (const ParameterSetting& parameter : scenario.parameters) {
    pairs.emplace_back(parameter.name.text, parameter.value);
  }
  return pairs;
}

TEST_F(ParameterFile, IsReadBeforeTheScenariosOwn) {
  const Scenario scenario =
      read("version: 1\nparameters: {gain: 2, step_time: 240}\n", "parameters: {gain: 3, step_height: 20}\n");
  EXPECT_THAT(settings(scenario), ElementsAre(std::pair("step_time", 240.0), std::pair("gain", 3.0),
                                              std::pair("step_height", 20.0)));
}

TEST_F(ParameterFile, ReportsItsOwnLines) {
  const Scenario scenario = read("version: 1\nparameters:\n  gain: 2\n");
  ASSERT_EQ(scenario.parameters.size(), 1u);
  EXPECT_EQ(scenario.parameters[0].name.line, 3);
  EXPECT_THAT(scenario.parameters[0].name.source, HasSubstr("standing.yaml"));
}

TEST_F(ParameterFile, IsRefusedWithItsLine) {
  EXPECT_THAT(refusal("version: 2\n"), HasSubstr("standing.yaml:1"));
  EXPECT_THAT(refusal("version: 1\nparametres: {gain: 2}\n"), HasSubstr("standing.yaml:2"));
  EXPECT_THAT(refusal("version: 1\nparameters:\n  gain: much\n"), HasSubstr("standing.yaml:3"));
}

TEST_F(ParameterFile, IsRejectedIfItNamesARobot) {
  EXPECT_THAT(refusal("version: 1\nrobot: box\nparameters: {gain: 2}\n"),
              HasSubstr("standing.yaml:2: found the parameters of a robot, which its storage holds"));
}

TEST_F(ParameterFile, IsADependencyOfTheScenario) {
  const auto files = input_files(read("version: 1\n"));
  EXPECT_THAT(files, ElementsAre(tree_.root() / "scenarios/test.yaml", tree_.root() / "robots/box/robot.sdf",
                                 tree_.root() / "robots/box/standing.yaml"));
}

// The purpose `standing` is an ability that a robot may lack; any other name or path is a mistake.
TEST(ParameterFileOfAPurpose, IsLeftOutAndNamedWithItsRemedy) {
  const TemporaryTree tree;
  const auto read = [&](const std::string& rest) {
    return read_scenario(
        tree.write("scenarios/test.yaml", "version: 1\nrobot: robots/box/robot.sdf\nduration_s: 1\n" + rest));
  };
  const Scenario bare = read("motions: [stand]\nparameter_file: standing\n");
  EXPECT_EQ(bare.missing_parameter_file, "standing");
  EXPECT_FALSE(bare.parameter_file);
  EXPECT_TRUE(bare.parameters.empty());
  const std::string text = left_out_text(bare);
  EXPECT_THAT(text, HasSubstr("robots/box lacks, and the run leaves out: motion stand, "
                              "parameter file standing; koboshi bring-up "));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("\n")));
  EXPECT_EQ(left_out_text(read("")), "");
  EXPECT_THROW(read("parameter_file: standign\n"), InputError);
  EXPECT_THROW(read("parameter_file: robots/box/standing.yaml\n"), InputError);

  // Who has been brought up is not told to do it again.
  tree.write("robots/box/parameters.yaml", "version: 1\nrobot: box\nparameters: {}\n");
  EXPECT_THAT(left_out_text(read("motions: [stand]\n")), ::testing::EndsWith("leaves out: motion stand"));

  tree.write("robots/box/standing.yaml", "version: 1\nparameters: {gain: 2}\n");
  const Scenario standing = read("parameter_file: standing\n");
  EXPECT_TRUE(standing.parameter_file);
  EXPECT_EQ(left_out_text(standing), "");
}

// robots/box/parameters.yaml, which no scenario names.
class RobotParametersFile : public ::testing::Test {
 protected:
  Scenario read(const std::string& parameters) const {
    tree_.write("robots/box/parameters.yaml", parameters);
    return read_scenario(
        tree_.write("scenarios/test.yaml", "version: 1\nrobot: robots/box/robot.sdf\nduration_s: 1\n"));
  }
  std::string refusal(const std::string& parameters) const {
    try {
      static_cast<void>(read(parameters));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryTree tree_;
};

TEST_F(RobotParametersFile, AppliesToEveryScenarioOfTheRobot) {
  const Scenario scenario = read("version: 1\nrobot: box\nparameters:\n  gain: 2\n");
  ASSERT_EQ(scenario.robot_parameters.settings.size(), 1u);
  EXPECT_EQ(scenario.robot_parameters.settings[0].name.text, "gain");
  EXPECT_EQ(scenario.robot_parameters.settings[0].name.line, 4);
  EXPECT_EQ(scenario.robot_parameters.robot.text, "box");
  EXPECT_TRUE(scenario.parameters.empty());  // what the operator sets
  EXPECT_THAT(input_files(scenario), ::testing::Contains(tree_.root() / "robots/box/parameters.yaml"));
}

TEST_F(RobotParametersFile, IsRefusedWithItsLine) {
  EXPECT_THAT(refusal("version: 1\nparameters: {gain: 2}\n"), HasSubstr("parameters.yaml:1"));
  EXPECT_THAT(refusal("version: 1\nrobot: box\nparametres: {}\n"), HasSubstr("parameters.yaml:3"));
  EXPECT_THAT(refusal("version: 1\nrobot: box\nparameters:\n  gain: much\n"), HasSubstr("parameters.yaml:4"));
}

TEST_F(RobotParametersFile, BelongsToTheRobotBesideIt) {
  const Scenario scenario = read("version: 1\nrobot: sphere\nparameters: {}\n");
  sim_board::RobotDescription box;
  box.name = "box";
  try {
    check(scenario, box);
    FAIL() << "parameters of another robot";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("parameters.yaml:2: found parameters of sphere, expected box, whose file lies"));
  }
}

}  // namespace
}  // namespace koboshi::simulation
