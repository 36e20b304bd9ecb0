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
  const sim::SdoWrite write = resolve("feedback_knee_s", 0.05);
  EXPECT_EQ(write.address, (canopen::ObjectAddress{0x2101, 4}));
  EXPECT_EQ(write.size_bytes, 2);
  EXPECT_EQ(write.value, 205u);  // 0.05 * 4096, rounded
  EXPECT_EQ(write.parameter.text, "feedback_knee_s");
  EXPECT_EQ(resolve("feedback_ankle_roll_s", -1.0).value, 0xFFFF'F000u);
  EXPECT_EQ(resolve("supply_min_V", 6.5).value, 6500u);
  EXPECT_EQ(resolve("ramp_rate_rad_per_s", 1.0).value, 652u);  // 4096 / 2 pi
}

TEST(Parameters, AreRefusedByAnUnknownName) {
  const std::string message = refusal("feedback_elbow_s", 0.1);
  EXPECT_THAT(message, HasSubstr("walk.yaml:12: found parameter feedback_elbow_s"));
  EXPECT_THAT(message, HasSubstr("feedback_ankle_pitch_s"));  // what there is
}

TEST(Parameters, AreRefusedBeyondTheRangeOfTheControllersDictionary) {
  EXPECT_THAT(refusal("feedback_knee_s", 1.01),
              HasSubstr("walk.yaml:12: found feedback_knee_s = 1.01, expected -1 to 1"));
  EXPECT_NE(refusal("supply_max_V", 70.0), "");
  EXPECT_NE(refusal("supply_max_V", -1.0), "");
  EXPECT_NE(refusal("ramp_rate_rad_per_s", 0.0), "");
}

}  // namespace
}  // namespace koboshi::tools
