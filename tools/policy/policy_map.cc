#include "tools/policy/policy_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/yaml/yaml_reader.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/policy/policy.h"
#include "hal/port/period.h"
#include "simulation/policy/signal_names.h"

namespace koboshi::tools {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;

bool may_move(robot::JointRole role) {
  using enum robot::JointRole;
  return role >= kLeftHipYaw && role <= kRightAnkleRoll && role != kLeftKnee && role != kRightKnee;
}

MappedOutput read_output(const YamlMap& map, const simulation::NamedModel& robot) {
  MappedOutput output;
  output.joint = map.text("joint");
  const auto found = std::ranges::find(robot.joint_names, output.joint);
  std::vector<std::string> hips_and_ankles;
  for (std::size_t i = 0; i < robot.joint_names.size(); ++i) {
    if (may_move(robot.model.joints[i].role)) hips_and_ankles.push_back(robot.joint_names[i]);
  }
  if (std::ranges::find(hips_and_ankles, output.joint) == hips_and_ankles.end())
    throw map.error_at("joint", output.joint, "a hip or ankle: " + join_alternatives(hips_and_ankles));
  output.index = static_cast<std::uint8_t>(found - robot.joint_names.begin());
  output.scale_rad = map.number("scale_rad", {.min = -10.0, .max = 10.0});
  output.bound_rad = map.number("bound_deg", {.min = 0.01, .max = 15.0}) * kRadPerDegree;
  const double fastest_deg_per_s =
      std::min(fixed::to_double(robot.model.joints[output.index].max_speed) / kRadPerDegree, 1'400.0);
  output.rate_rad_per_s =
      map.number("rate_deg_per_s", {.min = 0.1, .max = std::floor(fastest_deg_per_s)}) * kRadPerDegree;
  return output;
}

MappedInput read_mapped_input(const YamlMap& map, const std::vector<simulation::SignalName>& signals) {
  MappedInput input;
  input.name = map.text("signal");
  const auto found = std::ranges::find(signals, input.name, &simulation::SignalName::name);
  if (found == signals.end()) {
    std::vector<std::string> names;
    for (const simulation::SignalName& signal : signals) names.push_back(signal.name);
    throw map.error_at("signal", one_line(input.name), expected_names(input.name, names));
  }
  input.signal = found->signal;
  input.unit = found->unit;
  input.scale = map.number("scale", {}, 1.0);
  input.offset = map.number("offset", {}, 0.0);
  if (map.has("range")) {
    const std::vector<double> range = map.numbers("range", 2);
    if (range[0] >= range[1])
      throw map.error_at("range", fmt::format("{} to {}", range[0], range[1]), "a range, lower end first");
    input.range = {range[0], range[1]};
  }
  input.column = map.text("column", input.name);
  input.column_scale = map.number("column_scale", {}, 1.0);
  return input;
}

}  // namespace

PolicyMap read_policy_map(const std::filesystem::path& file, const simulation::NamedModel& robot) {
  const YamlFile yaml(file);
  const YamlMap root = yaml.root();
  root.require_version(1);
  PolicyMap map;
  map.name = root.text("name");
  const bool is_ascii = std::ranges::all_of(map.name, [](char c) { return c >= ' ' && c <= '~'; });
  if (!is_ascii || map.name.size() > policy::kPolicyNameSize)
    throw root.error_at("name", one_line(map.name),
                        fmt::format("at most {} characters of ASCII", policy::kPolicyNameSize));
  map.onnx_output = root.text("onnx_output", "");
  constexpr std::int64_t kTick_ms = hal::kControlPeriod_us / 1'000;
  map.patience_ticks = static_cast<std::uint8_t>(
      root.integer("patience_ms", {.min = kTick_ms, .max = policy::kMaxPatience_ticks * kTick_ms}, 50) /
      kTick_ms);
  map.margin = root.number("margin_percent", {.min = 0.0, .max = 1'000.0}, 10.0) / 100.0;
  std::vector<std::string> joints;
  for (const YamlValue& value : root.list("outputs")) {
    map.outputs.push_back(read_output(value.map(), robot));
    if (std::ranges::find(joints, map.outputs.back().joint) != joints.end())
      throw value.error("a second output for " + map.outputs.back().joint, "one output for a joint");
    joints.push_back(map.outputs.back().joint);
  }
  if (map.outputs.empty() || map.outputs.size() > policy::kMaxOutputs)
    throw root.error_at("outputs", count_text(map.outputs.size(), "output"),
                        fmt::format("1 to {}", policy::kMaxOutputs));
  const auto signals = simulation::signal_names(robot.joint_names, joints);
  for (const YamlValue& value : root.list("inputs"))
    map.inputs.push_back(read_mapped_input(value.map(), signals));
  if (map.inputs.empty() || map.inputs.size() > policy::kMaxInputs)
    throw root.error_at("inputs", count_text(map.inputs.size(), "input"),
                        fmt::format("1 to {}", policy::kMaxInputs));
  yaml.finish();
  return map;
}

}  // namespace koboshi::tools
