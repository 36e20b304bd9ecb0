#include "tools/run/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "sim_board/input/error.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;

sim::SdoWrite resolve(const std::string& name, double value) {
  const sim::ParameterSetting setting{{name, "walk.yaml", 12}, value};
  const auto writes = resolve_parameters({&setting, 1});
  EXPECT_EQ(writes.size(), 1u);
  return writes.at(0);
}

std::string refusal(const std::string& name, double value) {
  try {
    resolve(name, value);
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Parameters, BecomeWhatTheControllerHolds) {
  const sim::SdoWrite write = resolve("knee_gain", 0.05);
  EXPECT_EQ(write.address, (canopen::ObjectAddress{0x2101, 4}));
  EXPECT_EQ(write.size_bytes, 2);
  EXPECT_EQ(write.value, 205u);  // 0.05 * 4096, rounded
  EXPECT_EQ(write.parameter.text, "knee_gain");
  EXPECT_EQ(resolve("ankle_roll_gain", -1.0).value, 0xFFFF'F000u);
  EXPECT_EQ(resolve("lowest_supply", 6500).value, 6500u);
  EXPECT_EQ(resolve("ramp_rate", 90.0).value, 1024u);
}

TEST(Parameters, AreElementsOfAnObjectByTheirNames) {
  const sim::SdoWrite write = resolve("standing_lean_gain_hip_roll", -50.0);
  EXPECT_EQ(write.address, (canopen::ObjectAddress{0x2103, 3}));
  EXPECT_EQ(write.value, 0xFFFF'F800u);  // half of 4096
  EXPECT_EQ(resolve("mounting_yaw", 10.0).address, (canopen::ObjectAddress{0x2121, 3}));
}

TEST(Parameters, AreRefusedByAnUnknownName) {
  const std::string message = refusal("elbow_gain", 0.1);
  EXPECT_THAT(message, HasSubstr("walk.yaml:12: found parameter elbow_gain"));
  EXPECT_THAT(message, HasSubstr("ankle_pitch_gain"));  // what there is
}

TEST(Parameters, AreRefusedBeyondTheRangeOfTheControllersDictionary) {
  EXPECT_THAT(refusal("knee_gain", 1.01),
              HasSubstr("walk.yaml:12: found knee_gain = 1.01, expected -1 to 1 s"));
  EXPECT_NE(refusal("highest_supply", 70000.0), "");
  EXPECT_NE(refusal("highest_supply", -1.0), "");
  EXPECT_NE(refusal("ramp_rate", 0.0), "");
}

TEST(VelocityLimits, AreTheControllersUnlessTheScenarioSaysOtherwise) {
  sim::Scenario scenario;
  EXPECT_EQ(velocity_limits(scenario).highest(), walk::VelocityLimits{}.highest());
  scenario.parameters = {{{"highest_velocity_forward", "s.yaml", 3}, 100.0},
                         {{"highest_velocity_backward", "s.yaml", 4}, 90.0},
                         {{"highest_velocity_sideways", "s.yaml", 5}, 80.0},
                         {{"highest_turn", "s.yaml", 6}, 700.0},
                         {{"step_time", "s.yaml", 7}, 260.0}};
  EXPECT_EQ(velocity_limits(scenario).highest(), (walk::Velocity{100, 80, 700}));
  EXPECT_EQ(velocity_limits(scenario).lowest(), (walk::Velocity{-90, -80, -700}));
  scenario.parameters = {{{"highest_velocity_upward", "s.yaml", 3}, 100.0}};
  EXPECT_THROW(static_cast<void>(velocity_limits(scenario)), sim::InputError);
}

}  // namespace
}  // namespace koboshi::tools
