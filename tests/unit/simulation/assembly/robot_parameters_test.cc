#include "simulation/assembly/robot_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "base/text/error.h"
#include "firmware/app/factory_parameters.h"
#include "sim_board/description/load.h"
#include "simulation/assembly/parameters.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/reader.h"
#include "tests/support/factory_values.h"

namespace koboshi::simulation {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::filesystem::path kRobot = KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf";

class RobotParametersTest : public ::testing::Test {
 protected:
  // Returns the parameters of the same file with one value in line 99 replaced or, without a value, removed.
  RobotParameters with(const std::string& name, std::optional<double> value) const {
    RobotParameters changed = parameters_;
    std::erase_if(changed.settings, [&](const auto& setting) { return setting.name.text == name; });
    if (value) changed.settings.push_back({{name, "parameters.yaml", 99}, *value});
    return changed;
  }
  std::string refusal(const std::string& name, std::optional<double> value) const {
    try {
      static_cast<void>(compile_robot_parameters(with(name, value), model_.model));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const NamedModel model_ = load_named_model(sim_board::load_robot(kRobot));
  const RobotParameters parameters_ = read_robot_parameters(kRobot);
};

TEST_F(RobotParametersTest, OfKoboshiConfigureTheDefaultRobotCompletely) {
  app::ControllerValues values;
  const auto image = compile_robot_parameters(parameters_, model_.model);
  ASSERT_EQ(
      app::load_factory_parameters(
          image, model_.model.id, {app::kControllerNode.rows, std::as_writable_bytes(std::span(&values, 1))}),
      app::FactoryStatus::kLoaded);
  const app::ControllerValues expected = test::factory_values();
  EXPECT_EQ(values.walk, expected.walk);
  EXPECT_EQ(values.feedback.walking, expected.feedback.walking);
  EXPECT_EQ(values.feedback.standing, balance::FeedbackGains{});
  EXPECT_EQ(values.velocity_limits.highest(), expected.velocity_limits.highest());
  EXPECT_EQ(values.velocity_limits.lowest(), expected.velocity_limits.lowest());
  EXPECT_EQ(values.parameters.supply_min_mV, 6000);
  EXPECT_EQ(values.parameters.supply_max_mV, 9000);
  EXPECT_EQ(values.parameters.supply_low_mV, 6300);
  EXPECT_EQ(values.parameters.ramp_rate, 683);
  EXPECT_EQ(values.recovery.fall.front, 4733);
  EXPECT_EQ(values.recovery.fall.back, 4733);
  EXPECT_EQ(values.recovery.fall.side, 5097);
  EXPECT_EQ(values.recovery.fall.lead_ms, 135);
  EXPECT_EQ(values.recovery.fall.min_lean, 1820);
  EXPECT_EQ(values.recovery.fall.cycles, 2);
  EXPECT_EQ(values.recovery.fall.walking_percent, 150);
  EXPECT_EQ(values.recovery.fall.uncatchable_percent, 400);
  EXPECT_EQ(values.recovery.getting_up.attempts, 3);
  EXPECT_EQ(values.recovery.getting_up.slower, 20);
}

TEST_F(RobotParametersTest, AreReproducibleAndEmptyWithoutAFile) {
  EXPECT_EQ(compile_robot_parameters(parameters_, model_.model),
            compile_robot_parameters(read_robot_parameters(kRobot), model_.model));
  EXPECT_TRUE(compile_robot_parameters({}, model_.model).empty());
}

TEST_F(RobotParametersTest, OutOfRangeAreRejectedWithTheirLine) {
  EXPECT_EQ(refusal("step_time_ms", 700),
            "parameters.yaml:99: found step_time_ms = 700, expected 100 to 600 ms");
  EXPECT_THAT(refusal("step_tyme_ms", 220), StartsWith("parameters.yaml:99: found the unknown parameter"));
  EXPECT_THAT(refusal("nmt_startup", 1), StartsWith("parameters.yaml:99: found nmt_startup, expected"));
}

// A gait or a fall detection without one of its parameters is refused with the name of that one. The front of
// a fall and the step's time tell that there is one.
TEST_F(RobotParametersTest, MissNoneOfAGroup) {
  const std::vector<std::pair<std::string, std::vector<const char*>>> groups{
      {"the whole of a gait",
       {"step_width_mm", "acceleration_forward_mm_per_s2", "acceleration_lateral_mm_per_s2",
        "acceleration_turn_mrad_per_s2", "longest_step_mm", "widest_step_mm", "narrowest_step_mm",
        "com_height_mm", "step_time_ms"}},
      {"the whole of fall detection",
       {"fall_to_the_back_deg", "fall_to_the_side_deg", "smallest_lean_of_a_fall_deg"}}};
  for (const auto& [group, names] : groups) {
    for (const char* name : names)
      EXPECT_THAT(refusal(name, {}), AllOf(HasSubstr(std::string("found no ") + name), HasSubstr(group)));
  }
  for (const char* name : {"double_support_percent", "step_height_mm", "swing_profile_percent",
                           "zmp_forward_mm", "fall_lead_ms", "cycles_of_a_fall"})
    EXPECT_THAT(refusal(name, {}), Not(HasSubstr("the whole of"))) << name;
}

TEST_F(RobotParametersTest, HaveACompleteGaitOrNone) {
  EXPECT_THAT(refusal("com_height_mm", {}),
              AllOf(HasSubstr("parameters.yaml: found no com_height_mm"), HasSubstr("the whole of a gait")));
  EXPECT_THAT(refusal("step_time_ms", {}), HasSubstr("found no step_time_ms"));
  EXPECT_THAT(refusal("fall_to_the_side_deg", {}), HasSubstr("the whole of fall detection"));
  EXPECT_EQ(refusal("fall_to_the_front_deg", 0), "");  // intentionally off
  RobotParameters none = parameters_;
  none.settings.clear();
  EXPECT_NO_THROW(check_robot_parameters(none, model_.model));
}

TEST_F(RobotParametersTest, DescribeAReachablePosture) {
  EXPECT_THAT(
      refusal("com_height_mm", 400),
      AllOf(StartsWith("parameters.yaml:99: found com_height_mm = 400"), HasSubstr("which the legs reach")));
  EXPECT_THAT(refusal("com_height_mm", 60), HasSubstr("which the legs reach"));
  EXPECT_EQ(refusal("com_height_mm", 165), "");
  EXPECT_THAT(refusal("longest_step_mm", 400), HasSubstr("a step that the legs reach"));
  EXPECT_THAT(refusal("longest_step_mm", 400), HasSubstr("mm, or a lower com_height_mm"));
  EXPECT_THAT(refusal("widest_step_mm", 450), HasSubstr("a step that the legs reach"));
}

// The heights and the steps that a refusal names are the outermost which the legs reach.
TEST_F(RobotParametersTest, NameTheReachOfTheLegsToTheMillimetre) {
  std::smatch heights;
  const std::string said = refusal("com_height_mm", 400);
  ASSERT_TRUE(
      std::regex_search(said, heights, std::regex("expected (\\d+) to (\\d+) mm, which the legs reach")))
      << said;
  const double lowest_mm = std::stod(heights[1]);
  const double highest_mm = std::stod(heights[2]);
  const std::string posture = "which the legs reach";
  for (const double end_mm : {lowest_mm, highest_mm})  // within reach, with less than the longest step
    EXPECT_THAT(refusal("com_height_mm", end_mm),
                AllOf(HasSubstr("longest_step_mm"), Not(HasSubstr(posture))));
  EXPECT_THAT(refusal("com_height_mm", lowest_mm - 1), HasSubstr(posture));
  EXPECT_THAT(refusal("com_height_mm", highest_mm + 1), HasSubstr(posture));
  for (const char* key : {"longest_step_mm", "widest_step_mm"}) {
    std::smatch step;
    const std::string refused = refusal(key, 450);
    ASSERT_TRUE(std::regex_search(refused, step, std::regex("at most (\\d+) mm, or a lower"))) << refused;
    EXPECT_EQ(refusal(key, std::stod(step[1])), "") << key;
    EXPECT_NE(refusal(key, std::stod(step[1]) + 1), "") << key;
  }
}

TEST_F(RobotParametersTest, KeepTheSolesApart) {
  EXPECT_EQ(
      refusal("narrowest_step_mm", 50),
      "parameters.yaml:99: found narrowest_step_mm = 50, expected at least 56 mm, with less the soles touch");
  EXPECT_THAT(refusal("step_width_mm", 55),
              HasSubstr(":99: found step_width_mm = 55, expected at least 56 mm"));
  EXPECT_THAT(refusal("narrowest_step_mm", 90),
              HasSubstr(":99: found narrowest_step_mm = 90, expected at most the step width"));
  EXPECT_THAT(refusal("widest_step_mm", 70),
              HasSubstr(":99: found widest_step_mm = 70, expected at least the step width"));
}

// A foot that extends 62 mm in front of the ankle, with the centre of mass at 161 mm: 21.1 degrees.
TEST_F(RobotParametersTest, DoNotCountALeanOverTheFeetAsAFall) {
  EXPECT_EQ(
      refusal("fall_to_the_front_deg", 15),
      "parameters.yaml:99: found fall_to_the_front_deg = 15, expected 21.1 to 60 deg: from the edge of the "
      "feet to a robot that is down");
  EXPECT_THAT(refusal("fall_to_the_back_deg", 5), HasSubstr("expected 13.3 to 60 deg"));
  EXPECT_THAT(refusal("fall_to_the_side_deg", 70), HasSubstr("to 60 deg"));
}

TEST_F(RobotParametersTest, MatchTheWeightAndTheBattery) {
  EXPECT_THAT(refusal("touchdown_load_N", 30), HasSubstr("N, the weight of the robot"));
  EXPECT_THAT(refusal("lowest_supply_mV", 9500), HasSubstr("at most 9000 mV"));
  EXPECT_THAT(refusal("low_supply_mV", 5000), HasSubstr("at least 6000 mV"));
}

}  // namespace
}  // namespace koboshi::simulation
