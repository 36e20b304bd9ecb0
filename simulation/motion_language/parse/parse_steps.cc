#include "simulation/motion_language/parse/parse_steps.h"

#include <algorithm>
#include <cmath>

#include "base/yaml/yaml_reader.h"
#include "simulation/motion_language/parse/codes.h"
#include "simulation/motion_language/parse/parse_expect.h"

namespace koboshi::simulation {
namespace {

using StepKind = StepSource::Kind;

constexpr double kMinTime_s = motion::kMinStepTime_us * 1e-6;
constexpr double kMaxTime_s = motion::kMaxStepTime_us * 1e-6;
constexpr int kMaxLevels = 24;           // of nested steps
constexpr double kSpeedUnits = 1 << 24;  // per turn/s
constexpr double kDegreesPerTurn = 360.0;

// A kind of step: the key that makes it, and the other keys that it may have, with those of version 1 first.
struct StepKeys {
  std::string key;
  std::vector<std::string> others;
  std::size_t others_of_version_1 = 0;
  int version = 1;
};

const std::vector<StepKeys> kStepKeys{
    {"pose",
     {"time_s", "speed_deg_per_s", "at_least_s", "interpolation", "pause_s", "mirror", "during", "path",
      "lean", "stiffness", "gain", "mix"},
     1},
    {"loop", {}},
    {"expect", {}},
    {"wait_s", {}},
    {"label", {}},
    {"jump", {"if"}},
    {"if", {"then", "else"}, 0, 2},
    {"wait", {}, 0, 2},
    {"set", {}, 0, 2},
    {"call", {}, 0, 2},
    {"stiffness", {}, 0, 2},
    {"torque_off", {}, 0, 2},
    {"gain", {}, 0, 2},
    {"mix", {}, 0, 2},
    {"lean", {}, 0, 2},
    {"branch", {}, 0, 2},
    {"await", {}, 0, 2},
};

}  // namespace

std::optional<motion::Interpolation> parse_interpolation(const YamlNode& node, Reader& reader) {
  const auto name = reader.one_of(node, {"linear", "minimum_jerk", "cubic", "trapezoid"});
  if (!name) return std::nullopt;
  return *name == "linear"         ? motion::Interpolation::kLinear
         : *name == "minimum_jerk" ? motion::Interpolation::kMinimumJerk
         : *name == "cubic"        ? motion::Interpolation::kCubic
                                   : motion::Interpolation::kTrapezoid;
}

std::vector<StepSource> StepParser::parse(const YamlNode& list) {
  std::vector<StepSource> steps;
  if (!reader_.is_list(list)) return steps;
  if (++depth_ > kMaxLevels) {
    reader_.error(code::kTooMany, Reader::value_place(list),
                  "steps nested deeper than " + std::to_string(kMaxLevels) + " levels", "fewer levels");
  } else {
    for (const YamlNode& item : list.items) {
      if (auto step = parse_step(item)) steps.push_back(std::move(*step));
    }
  }
  --depth_;
  return steps;
}

std::optional<StepSource> StepParser::parse_step(const YamlNode& node) {
  StepSource step;
  step.place = Reader::value_place(node);
  if (node.kind != YamlNode::Kind::kMap) return parse_word(node, step) ? std::optional(step) : std::nullopt;
  for (const StepKeys& keys : kStepKeys) {
    const YamlNode* value = node.find(keys.key);
    if (value == nullptr) continue;
    if (!check_kind(node, keys.key)) return std::nullopt;
    return parse_kind(keys.key, node, *value, step) ? std::optional(std::move(step)) : std::nullopt;
  }
  std::string hint;
  std::vector<std::string> names;
  for (const StepKeys& keys : kStepKeys) names.push_back(keys.key);
  for (const YamlNode& item : node.items) {
    if (hint.empty()) hint = did_you_mean(item.key, names);
  }
  reader_.error(code::kUnknownStep, step.place, "a step of another kind",
                context_.version < 2 ? "pose with time_s, wait_s, loop, label, jump, expect or end"
                                     : join_alternatives(names),
                hint);
  return std::nullopt;
}

bool StepParser::check_kind(const YamlNode& node, const std::string& kind) {
  const StepKeys& keys = *std::find_if(kStepKeys.begin(), kStepKeys.end(),
                                       [&](const StepKeys& other) { return other.key == kind; });
  const std::size_t errors = reader_.diagnostics().error_count();
  if (context_.version < keys.version) {
    reader_.error(code::kNeedsVersion2, Reader::key_place(*node.find(kind)), "the step " + kind,
                  "version: 2 for it, or a step of version 1",
                  "`koboshi motion format --upgrade` converts the file.");
    return false;
  }
  std::vector<std::string> known{kind};
  const std::size_t count = context_.version < 2 ? keys.others_of_version_1 : keys.others.size();
  known.insert(known.end(), keys.others.begin(), keys.others.begin() + static_cast<std::ptrdiff_t>(count));
  if (context_.version < 2) {
    for (const std::string& other : keys.others) {
      const YamlNode* value = node.find(other);
      if (value == nullptr || std::find(known.begin(), known.end(), other) != known.end()) continue;
      reader_.error(code::kNeedsVersion2, Reader::key_place(*value), "the key " + other, "version: 2 for it",
                    "`koboshi motion format --upgrade` converts the file.");
    }
  }
  reader_.check_keys(node, known);
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_word(const YamlNode& node, StepSource& step) {
  const std::string word = node.kind == YamlNode::Kind::kScalar ? node.scalar : std::string();
  if (word == "end") {
    step.kind = StepKind::kEnd;
  } else if (word == "fail" && context_.version >= 2) {
    step.kind = StepKind::kFail;
  } else if (word == "return" && context_.version >= 2) {
    step.kind = StepKind::kReturn;
  } else {
    reader_.bad_value(node, context_.version < 2 ? "a step: a map, or the word end"
                                                 : "a step: a map, or one of the words end, fail, return");
    return false;
  }
  return true;
}

bool StepParser::parse_kind(const std::string& kind, const YamlNode& map, const YamlNode& value,
                            StepSource& step) {
  if (kind == "pose") return parse_move(map, value, step);
  if (kind == "loop") return parse_loop(value, step);
  if (kind == "if") return parse_if(map, value, step);
  if (kind == "wait") return parse_wait(value, step);
  if (kind == "jump") return parse_jump(map, value, step);
  if (kind == "expect") {
    step.kind = StepKind::kExpect;
    return parse_expect(value, context_.version, reader_, step.attitude);
  }
  if (kind == "set") {
    step.kind = StepKind::kSet;
    return values_.assignments(value, step.assignments);
  }
  if (kind == "call") return parse_call(value, step);
  if (kind == "branch") return parse_tests(value, false, step);
  if (kind == "await") return parse_tests(value, true, step);
  if (kind == "wait_s") {
    step.kind = StepKind::kWait;
    const auto time = time_us(map, "wait_s");
    step.time_us = time.value_or(0);
    return time.has_value();
  }
  if (kind == "label") {
    step.kind = StepKind::kLabel;
    return set_text(value, step.label);
  }
  return parse_setting(kind, value, step);
}

bool StepParser::parse_setting(const std::string& kind, const YamlNode& value, StepSource& step) {
  const bool is_none = value.kind == YamlNode::Kind::kScalar && value.scalar == "none";
  if (kind == "mix") {
    step.kind = StepKind::kMix;
    return is_none || settings_.mix(value, step.mix);
  }
  if (kind == "lean") {
    step.kind = StepKind::kLean;
    step.lean = motion::LeanDeclaration{};
    return is_none || settings_.lean(value, step.lean);
  }
  if (kind == "gain") {
    step.kind = StepKind::kGain;
    return settings_.shares(value, kind, step.gain);
  }
  step.kind = StepKind::kStiffness;
  return kind == "torque_off" ? settings_.torque_off(value, step.stiffness)
                              : settings_.shares(value, kind, step.stiffness);
}

bool StepParser::set_text(const YamlNode& node, std::string& text) {
  const auto value = reader_.text(node);
  if (value) text = *value;
  return value.has_value();
}

std::optional<std::uint32_t> StepParser::time_us(const YamlNode& map, const std::string& key) {
  const NumberRange range{.min = kMinTime_s, .max = kMaxTime_s};
  const YamlNode* node = reader_.require(map, key, koboshi::describe(range));
  if (node == nullptr) return std::nullopt;
  const auto value = reader_.number(*node, range);
  if (!value) return std::nullopt;
  return static_cast<std::uint32_t>(std::lround(*value * 1e6));
}

bool StepParser::parse_move(const YamlNode& map, const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kMove;
  step.interpolation = context_.interpolation;
  const std::size_t errors = reader_.diagnostics().error_count();
  bool mirrored = false;
  if (const YamlNode* node = map.find("mirror")) {
    const auto flag = reader_.one_of(*node, {"true", "false"});
    mirrored = flag && *flag == "true";
  }
  const auto pose = poses_.pose_of_step(value, mirrored);
  step.pose = pose.value_or(0);
  if (const YamlNode* node = map.find("interpolation")) {
    if (const auto interpolation = parse_interpolation(*node, reader_)) step.interpolation = *interpolation;
  }
  parse_timing(map, step);
  if (const YamlNode* node = map.find("during")) parse_during(*node, step);
  if (const YamlNode* node = map.find("path")) parse_path(map, *node, step);
  if (map.find("pause_s") != nullptr) step.pause_us = time_us(map, "pause_s").value_or(0);
  if (const YamlNode* node = map.find("stiffness")) settings_.shares(*node, node->key, step.stiffness);
  if (const YamlNode* node = map.find("gain")) settings_.shares(*node, node->key, step.gain);
  if (const YamlNode* node = map.find("mix")) settings_.mix(*node, step.mix);
  if (const YamlNode* node = map.find("lean")) settings_.lean(*node, step.lean);
  return pose && reader_.diagnostics().error_count() == errors;
}

void StepParser::parse_during(const YamlNode& node, StepSource& step) {
  const bool is_cubic = step.interpolation == motion::Interpolation::kCubic;
  if (is_cubic || step.at_least || step.speed_raw != 0) {
    reader_.error(code::kContradiction, Reader::key_place(node),
                  std::string("during in a move ") + (is_cubic ? "that is cubic" : "without time_s"),
                  "a move with time_s that is linear, minimum_jerk or a trapezoid");
  } else if (step.time_us != 0) {
    settings_.windows(node, step.time_us, step.windows);
  }
}

void StepParser::parse_path(const YamlNode& map, const YamlNode& node, StepSource& step) {
  const auto path = reader_.one_of(node, {"joints", "zmp"});
  step.zmp_path = path && *path == "zmp";
  if (!step.zmp_path) return;
  for (const char* key :
       {"speed_deg_per_s", "at_least_s", "interpolation", "during", "lean", "stiffness", "gain", "mix"}) {
    const YamlNode* other = map.find(key);
    if (other != nullptr)
      reader_.error(code::kContradiction, Reader::key_place(*other),
                    std::string(key) + " in a move of path: zmp",
                    "time_s and pause_s only; settings are steps of their own");
  }
}

// Parses the one of time_s, speed_deg_per_s and at_least_s that the move has.
void StepParser::parse_timing(const YamlNode& map, StepSource& step) {
  const YamlNode* first = nullptr;
  for (const char* key : {"time_s", "speed_deg_per_s", "at_least_s"}) {
    const YamlNode* node = map.find(key);
    if (node == nullptr) continue;
    if (first != nullptr) {
      reader_.error(code::kContradiction, Reader::key_place(*node),
                    first->key + " and " + key + " in one step", "one of them");
      return;
    }
    first = node;
  }
  if (first == nullptr || first->key == "time_s") {
    step.time_us = time_us(map, "time_s").value_or(0);
  } else if (first->key == "at_least_s") {
    step.at_least = true;
    step.time_us = time_us(map, "at_least_s").value_or(0);
    if (step.interpolation == motion::Interpolation::kCubic)
      reader_.error(code::kContradiction, Reader::key_place(*first), "at_least_s in a cubic move",
                    "another interpolation: the peak speed of a cubic depends on the next move");
    // The range is that of the image.
  } else if (const auto number = reader_.number(*first, {.min = 0.00001, .max = 92'160.0})) {
    step.speed_raw = static_cast<std::uint32_t>(
        std::clamp<std::int64_t>(std::llround(*number / kDegreesPerTurn * kSpeedUnits), 1, 0xFFFF'FFFF));
  }
}

bool StepParser::parse_loop(const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kLoop;
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  if (context_.version < 2) {
    reader_.check_keys(value, {"times", "until", "steps"});
  } else {
    reader_.check_keys(value, {"times", "until", "while", "steps"});
  }
  const YamlNode* times = value.find("times");
  const YamlNode* until = value.find("until");
  const YamlNode* while_true = context_.version >= 2 ? value.find("while") : nullptr;
  if ((times != nullptr) + (until != nullptr) + (while_true != nullptr) > 1) {
    reader_.error(code::kContradiction, Reader::key_place(until != nullptr ? *until : *while_true),
                  "two ends of one loop", context_.version < 2 ? "times or until" : "times, until or while");
  } else if (until != nullptr && until->scalar == "stopped") {
    step.loop = StepSource::LoopKind::kUntilStopped;
  } else if (until != nullptr && context_.version < 2) {
    reader_.bad_value(*until, "stopped");
  } else if (until != nullptr) {
    step.loop = StepSource::LoopKind::kUntil;
    step.condition = values_.condition(*until);
  } else if (while_true != nullptr) {
    step.loop = StepSource::LoopKind::kWhile;
    step.condition = values_.condition(*while_true);
  } else if (const YamlNode* node = reader_.require(value, "times", "an integer from 1 to 65535")) {
    step.times = static_cast<std::uint16_t>(reader_.integer(*node, {.min = 1, .max = 65'535}).value_or(1));
  }
  if (const YamlNode* steps = reader_.require(value, "steps", "a list")) step.body = parse(*steps);
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_if(const YamlNode& map, const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kIf;
  step.condition = values_.condition(value);
  if (const YamlNode* then = reader_.require(map, "then", "a list of steps")) step.body = parse(*then);
  if (const YamlNode* otherwise = map.find("else")) step.otherwise = parse(*otherwise);
  return step.condition.has_value();
}

bool StepParser::parse_wait(const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kAwait;
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  reader_.check_keys(value, {"until", "timeout_s", "else"});
  if (const YamlNode* until = reader_.require(value, "until", "a condition"))
    step.condition = values_.condition(*until);
  step.time_us = time_us(value, "timeout_s").value_or(0);
  if (const YamlNode* otherwise = value.find("else")) {
    std::string text;
    if (set_text(*otherwise, text)) {
      step.continues = text == "continue";
      if (text != "continue" && text != "fail") step.label = text;
    }
  }
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_jump(const YamlNode& map, const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kJump;
  if (const YamlNode* when = map.find("if")) {
    step.condition = values_.condition(*when);
    if (!step.condition) return false;
  }
  return set_text(value, step.label);
}

bool StepParser::parse_call(const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kCall;
  if (!set_text(value, step.label)) return false;
  const auto& routines = context_.routines;
  if (std::find(routines.begin(), routines.end(), step.label) != routines.end()) return true;
  reader_.error(code::kUnknownRoutine, Reader::value_place(value),
                "the routine '" + one_line(step.label) + "'", "one of the routines of this file",
                did_you_mean(step.label, routines));
  return false;
}

bool StepParser::parse_tests(const YamlNode& value, bool is_await, StepSource& step) {
  step.kind = is_await ? StepKind::kAwait : StepKind::kJump;
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  std::vector<std::string> known{"to", "all", "any", "not_all", "not_any"};
  if (is_await) known.emplace_back("timeout_s");
  reader_.check_keys(value, known);
  TestBlock block;
  if (!values_.tests(value, block)) return false;
  step.tests = std::move(block);
  if (is_await) step.time_us = time_us(value, "timeout_s").value_or(0);
  const YamlNode* to = is_await ? value.find("to") : reader_.require(value, "to", "a label");
  if (to != nullptr) set_text(*to, step.label);
  return reader_.diagnostics().error_count() == errors;
}

}  // namespace koboshi::simulation
