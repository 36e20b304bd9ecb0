#include "studio/document/step_text.h"

#include <algorithm>
#include <array>

#include "base/text/text.h"

namespace koboshi::studio {
namespace {

using Kind = simulation::StepSource::Kind;

// A value on one line.
std::string flow_text(const YamlNode& node) {
  YamlNode root;
  root.kind = YamlNode::Kind::kMap;
  YamlNode value = node;
  value.key = "v";
  if (value.kind == YamlNode::Kind::kList) return std::to_string(value.items.size()) + " items";
  root.items.push_back(std::move(value));
  std::string text = yaml_text(root).substr(3);
  text.pop_back();
  return text;
}

std::string without_braces(std::string text) {
  return text.starts_with('{') && text.ends_with('}') ? text.substr(1, text.size() - 2) : text;
}

std::string loop_text(const YamlNode& loop) {
  if (const YamlNode* times = loop.find("times")) return "loop " + times->scalar + " times";
  if (const YamlNode* until = loop.find("until")) return "loop until " + until->scalar;
  if (const YamlNode* condition = loop.find("while")) return "loop while " + condition->scalar;
  return "loop";
}

std::string text_of(const YamlNode& step) {
  if (step.kind != YamlNode::Kind::kMap) return step.scalar;
  if (const YamlNode* loop = step.find("loop")) return loop_text(*loop);
  if (step.find("then") != nullptr)
    if (const YamlNode* condition = step.find("if")) return "if " + condition->scalar;
  if (const YamlNode* pose = step.find("pose"))
    return pose->kind == YamlNode::Kind::kScalar ? pose->scalar : flow_text(*pose);
  return without_braces(flow_text(step));
}

// The kind of a step by its keys.
Kind kind_of(const YamlNode& step) {
  struct Key {
    const char* key;
    Kind kind;
  };
  static constexpr std::array kKeys{Key{"pose", Kind::kMove},
                                    Key{"loop", Kind::kLoop},
                                    Key{"expect", Kind::kExpect},
                                    Key{"wait_s", Kind::kWait},
                                    Key{"label", Kind::kLabel},
                                    Key{"jump", Kind::kJump},
                                    Key{"branch", Kind::kJump},
                                    Key{"if", Kind::kIf},
                                    Key{"wait", Kind::kAwait},
                                    Key{"await", Kind::kAwait},
                                    Key{"set", Kind::kSet},
                                    Key{"call", Kind::kCall},
                                    Key{"stiffness", Kind::kStiffness},
                                    Key{"torque_off", Kind::kStiffness},
                                    Key{"gain", Kind::kGain},
                                    Key{"mix", Kind::kMix},
                                    Key{"lean", Kind::kLean}};
  if (step.scalar == "fail") return Kind::kFail;
  if (step.scalar == "return") return Kind::kReturn;
  const auto found =
      std::ranges::find_if(kKeys, [&](const Key& key) { return step.find(key.key) != nullptr; });
  return found == kKeys.end() ? Kind::kEnd : found->kind;
}

std::optional<double> number_at(const YamlNode& map, const char* key) {
  const YamlNode* value = map.find(key);
  return value != nullptr ? parse_number(value->scalar) : std::nullopt;
}

motion::Interpolation interpolation_of(const YamlNode* value) {
  if (value != nullptr && value->scalar == "minimum_jerk") return motion::Interpolation::kMinimumJerk;
  if (value != nullptr && value->scalar == "cubic") return motion::Interpolation::kCubic;
  if (value != nullptr && value->scalar == "trapezoid") return motion::Interpolation::kTrapezoid;
  return motion::Interpolation::kLinear;
}

}  // namespace

void describe_step(const YamlNode& node, const YamlNode* default_interpolation, MotionRow& row) {
  row.text = text_of(node);
  row.kind = kind_of(node);
  for (const char* key : {"label", "jump", "call"}) {
    if (const YamlNode* label = node.find(key)) row.label = label->scalar;
  }
  row.time_s = number_at(node, row.kind == Kind::kMove ? "time_s" : "wait_s");
  if (const YamlNode* loop = node.find("loop")) {
    if (const auto times = number_at(*loop, "times"); times && *times >= 1 && *times <= 65'535)
      row.times = static_cast<int>(*times);
  }
  if (row.kind != Kind::kMove) return;
  const YamlNode* pose = node.find("pose");
  if (pose->kind == YamlNode::Kind::kScalar) row.pose = pose->scalar;
  const YamlNode* mirror = node.find("mirror");
  row.mirrored = mirror != nullptr && mirror->scalar == "true";
  const YamlNode* interpolation = node.find("interpolation");
  row.own_interpolation = interpolation != nullptr;
  row.interpolation = interpolation_of(interpolation != nullptr ? interpolation : default_interpolation);
  row.at_least = node.find("at_least_s") != nullptr;
  if (row.at_least) row.time_s = number_at(node, "at_least_s");
  row.speed_deg_per_s = number_at(node, "speed_deg_per_s");
  if (row.speed_deg_per_s && *row.speed_deg_per_s <= 0.0) row.speed_deg_per_s.reset();
  row.pause_s = number_at(node, "pause_s").value_or(0.0);
}

}  // namespace koboshi::studio
