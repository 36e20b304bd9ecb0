#include "tools/policy/policy_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "base/text/error.h"
#include "firmware/policy/signals.h"
#include "sim_board/description/load.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;

constexpr const char* kMap = R"(version: 1
name: lean
patience_ms: 80
inputs:
  - {signal: roll}
  - {signal: left_knee.rate, scale: 0.5, offset: 1, range: [-2, 3], column: knee, column_scale: 0.1}
  - {signal: output.left_ankle_roll}
outputs:
  - {joint: right_ankle_roll, scale_rad: 0.1, bound_deg: 4, rate_deg_per_s: 60}
  - {joint: left_ankle_roll, scale_rad: -0.2, bound_deg: 5, rate_deg_per_s: 50}
)";

class Map : public ::testing::Test {
 protected:
  PolicyMap read(const std::string& text) {
    test::write_file(folder_.path / "map.yaml", text);
    return read_policy_map(folder_.path / "map.yaml", robot_);
  }
  std::string refusal(const std::string& from, const std::string& to) {
    std::string text = kMap;
    text.replace(text.find(from), from.size(), to);
    try {
      read(text);
      return "none";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  test::TemporaryFolder folder_;
  simulation::NamedModel robot_ =
      simulation::load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
};

TEST_F(Map, NamesSignalsAndJoints) {
  const PolicyMap map = read(kMap);
  EXPECT_EQ(map.name, "lean");
  EXPECT_EQ(map.patience_ticks, 8);
  EXPECT_NEAR(map.margin, 0.1, 1e-12);
  ASSERT_EQ(map.inputs.size(), 3u);
  EXPECT_EQ(map.inputs[0].signal, 0);
  EXPECT_NEAR(map.inputs[0].unit * (1 << 24), 2.0 * std::numbers::pi, 1e-12);
  EXPECT_EQ(map.inputs[0].column, "roll");
  EXPECT_FALSE(map.inputs[0].range.has_value());
  EXPECT_EQ(robot_.joint_names[map.inputs[1].signal - static_cast<std::size_t>(policy::Signal::kJointRate)],
            "left_knee");
  EXPECT_EQ(map.inputs[1].column, "knee");
  EXPECT_EQ(map.inputs[1].range, (std::pair{-2.0, 3.0}));
  EXPECT_EQ(map.inputs[2].signal, static_cast<std::size_t>(policy::Signal::kOutput) + 1);
  ASSERT_EQ(map.outputs.size(), 2u);
  EXPECT_EQ(robot_.joint_names[map.outputs[0].index], "right_ankle_roll");
  EXPECT_NEAR(map.outputs[1].bound_rad, 5.0 * std::numbers::pi / 180.0, 1e-12);
}

TEST_F(Map, NamesLineAndReasonOfAnError) {
  EXPECT_THAT(refusal("signal: roll", "signal: rol"), HasSubstr("map.yaml:5: found rol"));
  EXPECT_THAT(refusal("signal: roll", "signal: rol"), HasSubstr("expected roll, the nearest of"));
  EXPECT_THAT(refusal("joint: right_ankle_roll", "joint: right_knee"), HasSubstr("expected a hip or ankle"));
  EXPECT_THAT(refusal("joint: right_ankle_roll", "joint: left_ankle_roll"), HasSubstr("a second output"));
  EXPECT_THAT(refusal("bound_deg: 4", "bound_deg: 16"), HasSubstr("map.yaml:9"));
  EXPECT_THAT(refusal("rate_deg_per_s: 60", "rate_deg_per_s: 2000"), HasSubstr("rate_deg_per_s"));
  EXPECT_THAT(refusal("range: [-2, 3]", "range: [3, -2]"), HasSubstr("lower end first"));
  EXPECT_THAT(refusal("patience_ms: 80", "patience_ms: 5"), HasSubstr("patience_ms"));
  EXPECT_THAT(refusal("name: lean", "name: a_name_of_more_than_twenty_four"), HasSubstr("24 characters"));
  EXPECT_THAT(refusal("output.left_ankle_roll", "output.left_hip_roll"), HasSubstr("output.left_hip_roll"));
  EXPECT_THAT(refusal("name: lean", "name: lean\nspeed: 3"), HasSubstr("speed"));
}

}  // namespace
}  // namespace koboshi::tools
