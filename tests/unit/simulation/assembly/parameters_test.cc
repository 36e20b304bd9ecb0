#include "simulation/assembly/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "base/text/error.h"
#include "simulation/assembly/controller_parameters.h"
#include "simulation/assembly/parameter_keys.h"

namespace koboshi::simulation {
namespace {

using ::testing::HasSubstr;

SdoWrite resolve(const std::string& name, double value) {
  const ParameterSetting setting{{name, "walk.yaml", 12}, value};
  const auto writes = resolve_parameters({&setting, 1});
  EXPECT_EQ(writes.size(), 1u);
  return writes.at(0);
}

std::string refusal(const std::string& name, double value) {
  try {
    resolve(name, value);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Parameters, AreConvertedToObjectsOfTheController) {
  const SdoWrite write = resolve("knee_gain_s", 0.05);
  EXPECT_EQ(write.address, (canopen::ObjectAddress{0x2101, 4}));
  EXPECT_EQ(write.size_bytes, 2);
  EXPECT_EQ(write.value, 205u);  // 0.05 * 4096, rounded
  EXPECT_EQ(write.parameter.text, "knee_gain_s");
  EXPECT_EQ(resolve("ankle_roll_gain_s", -1.0).value, 0xFFFF'F000u);
  EXPECT_EQ(resolve("lowest_supply_mV", 6500).value, 6500u);
  EXPECT_EQ(resolve("ramp_rate_deg_per_s", 90.0).value, 1024u);
}

TEST(Parameters, AreElementsOfAnObjectByTheirNames) {
  const SdoWrite write = resolve("standing_lean_gain_hip_roll_percent", -50.0);
  EXPECT_EQ(write.address, (canopen::ObjectAddress{0x2103, 3}));
  EXPECT_EQ(write.value, 0xFFFF'F800u);  // -0.5 * 4096
  EXPECT_EQ(resolve("mounting_yaw_deg", 10.0).address, (canopen::ObjectAddress{0x2121, 3}));
}

TEST(Parameters, CarryTheirUnitInTheKey) {
  EXPECT_EQ(resolve("com_height_mm", 167.5).value, 1675u);
  EXPECT_EQ(refusal("com_height", 1675),
            "walk.yaml:12: found parameter com_height without its unit, expected com_height_mm");
  EXPECT_EQ(refusal("trunk_pitch_by_speed", 2),
            "walk.yaml:12: found parameter trunk_pitch_by_speed without its unit, expected "
            "trunk_pitch_by_speed_deg_s_per_m");
  EXPECT_EQ(resolve("attempts_to_get_up", 3).value, 3u);  // a count has no unit
  EXPECT_THAT(refusal("com_hieght_mm", 167.5), HasSubstr("expected com_height_mm, the nearest of "));
}

// A search for a key finds it: none is composed of the names in the dictionary.
TEST(Parameters, HaveTheKeysOfTheTableAndNoOthers) {
  std::set<std::string_view> in_table;
  canopen::ObjectAddress last;
  for (const ParameterKey& row : kParameterKeys) {
    EXPECT_TRUE(in_table.insert(row.key).second) << row.key << " twice";
    EXPECT_LT(last, row.address) << row.key;
    last = row.address;
  }
  std::set<std::string_view> used;
  for (const Parameter& parameter : controller_parameters()) {
    used.insert(parameter.key);
    const std::string suffix = unit_suffix(parameter.object->text.unit.name);
    EXPECT_EQ(parameter.key, parameter.name_without_unit + (suffix.empty() ? "" : "_" + suffix));
  }
  EXPECT_EQ(used, in_table);
}

TEST(Parameters, AreRejectedByTheirOldNameWithTheNewOne) {
  EXPECT_EQ(
      refusal("zmp_ahead_mm", 7),
      "walk.yaml:12: found parameter zmp_ahead_mm, which has another name now, expected zmp_forward_mm");
  EXPECT_THAT(refusal("swing_ease", 80), HasSubstr("expected swing_profile_percent"));
  for (const char* old_name :
       {"acceleration_of_turn_mrad_per_s2", "acceleration_sideways_mm_per_s2", "capture_ahead_percent",
        "capture_aside_percent", "highest_velocity_sideways_mm_per_s", "least_lean_of_a_fall_deg",
        "swing_ease_percent", "touch_down_load_N", "zmp_ahead_mm"})
    EXPECT_THAT(refusal(old_name, 1), HasSubstr("which has another name now")) << old_name;
}

TEST(Parameters, AreRejectedWithAnUnknownName) {
  const std::string message = refusal("elbow_gain", 0.1);
  EXPECT_THAT(message, HasSubstr("walk.yaml:12: found the unknown parameter elbow_gain"));
  EXPECT_THAT(message, HasSubstr("ankle_pitch_gain_s"));  // the message lists the available names
}

TEST(Parameters, AreRejectedOutOfTheDictionarysRange) {
  EXPECT_THAT(refusal("knee_gain_s", 1.01),
              HasSubstr("walk.yaml:12: found knee_gain_s = 1.01, expected -1 to 1 s"));
  EXPECT_NE(refusal("highest_supply_mV", 70000.0), "");
  EXPECT_NE(refusal("highest_supply_mV", -1.0), "");
  EXPECT_NE(refusal("ramp_rate_deg_per_s", 0.0), "");
}

// The range of the dictionary's row or, without one, of its type: the ends are accepted, and the next numbers
// are not.
TEST(Parameters, EndWhereTheirRowOrTheirTypeEnds) {
  struct TypeRange {
    std::int64_t low;
    std::int64_t high;
  };
  const std::map<canopen::DataType, TypeRange> of_type{
      {canopen::DataType::kInteger8, {-128, 127}},
      {canopen::DataType::kInteger16, {-32'768, 32'767}},
      {canopen::DataType::kInteger32, {-2'147'483'648, 2'147'483'647}},
      {canopen::DataType::kUnsigned8, {0, 255}},
      {canopen::DataType::kUnsigned16, {0, 65'535}},
      {canopen::DataType::kUnsigned32, {0, 4'294'967'295}},
  };
  int without_row = 0;
  for (const Parameter& parameter : controller_parameters()) {
    const canopen::Entry& entry = parameter.object->entry;
    const bool is_signed = entry.type < canopen::DataType::kUnsigned8;
    const auto bound = [&](std::uint32_t word) {
      return is_signed ? std::int64_t{static_cast<std::int32_t>(word)} : std::int64_t{word};
    };
    const TypeRange range =
        entry.limited ? TypeRange{bound(entry.low), bound(entry.high)} : of_type.at(entry.type);
    without_row += entry.limited ? 0 : 1;
    EXPECT_EQ(parameter.low(), range.low) << parameter.key;
    EXPECT_EQ(parameter.high(), range.high) << parameter.key;
    for (const std::int64_t end : {range.low, range.high})
      EXPECT_EQ(refusal(parameter.key, parameter.value(end)), "");
    for (const std::int64_t beyond : {range.low - 1, range.high + 1})
      EXPECT_NE(refusal(parameter.key, parameter.value(beyond)), "") << parameter.key << ' ' << beyond;
  }
  EXPECT_GT(without_row, 0);
}

TEST(ControllerValues, AreOverriddenByTheRobotThenByTheScenario) {
  Scenario scenario;
  EXPECT_EQ(controller_values(scenario).velocity_limits.highest(), walk::Velocity{});
  EXPECT_EQ(controller_values(scenario).walk, walk::WalkParameters{});
  scenario.robot_parameters.settings = {{{"highest_velocity_forward_mm_per_s", "r.yaml", 3}, 300.0},
                                        {{"highest_velocity_backward_mm_per_s", "r.yaml", 4}, 90.0},
                                        {{"step_time_ms", "r.yaml", 5}, 220.0}};
  scenario.parameters = {{{"highest_velocity_forward_mm_per_s", "s.yaml", 3}, 100.0},
                         {{"highest_velocity_lateral_mm_per_s", "s.yaml", 5}, 80.0},
                         {{"highest_turn_mrad_per_s", "s.yaml", 6}, 700.0}};
  EXPECT_EQ(controller_values(scenario).velocity_limits.highest(), (walk::Velocity{100, 80, 700}));
  EXPECT_EQ(controller_values(scenario).velocity_limits.lowest(), (walk::Velocity{-90, -80, -700}));
  EXPECT_EQ(controller_values(scenario).walk.step.time_ms, 220);
  EXPECT_EQ(controller_values(scenario.robot_parameters).velocity_limits.forward_mm_per_s, 300);
  scenario.parameters = {{{"highest_velocity_upward", "s.yaml", 3}, 100.0}};
  EXPECT_THROW(static_cast<void>(controller_values(scenario)), InputError);
}

}  // namespace
}  // namespace koboshi::simulation
