#include "simulation/motion/parse_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/fixed/host/convert.h"
#include "sim_board/input/user_units.h"
#include "sim_board/input/yaml_reader.h"
#include "simulation/motion/codes.h"
#include "simulation/motion/expression.h"

namespace koboshi::simulation {
namespace {

using sim::YamlNode;
using StepKind = StepSource::Kind;

constexpr double kMinTime_s = motion::kMinStepTime_us * 1e-6;
constexpr double kMaxTime_s = motion::kMaxStepTime_us * 1e-6;
constexpr int kMaxLevels = 24;  // of nested steps
constexpr std::size_t kMaxTests = 8;
constexpr double kSpeedUnits = 1 << 24;  // per turn/s
constexpr double kAngleUnits = 1 << 16;  // per turn
constexpr double kGainUnits = 1 << 12;
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
     {"time_s", "speed_deg_per_s", "interpolation", "pause_s", "mirror", "lean", "stiffness", "mix"},
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
    {"mix", {}, 0, 2},
    {"lean", {}, 0, 2},
    {"branch", {}, 0, 2},
    {"await", {}, 0, 2},
};

std::int16_t angle_units(double degrees) {
  const long units = std::lround(degrees / kDegreesPerTurn * kAngleUnits);
  return static_cast<std::int16_t>(std::clamp(units, -32'768L, 32'767L));
}

// For a trunk with roll r about x, then pitch p about y, the world's up vector in trunk axes is (-sin p, sin
// r cos p, cos r cos p).
motion::ExpectedAttitude attitude_of(double roll_deg, double pitch_deg, double within_deg) {
  const double roll = roll_deg * sim::kRadPerDegree;
  const double pitch = pitch_deg * sim::kRadPerDegree;
  const double within = within_deg * sim::kRadPerDegree;
  const std::array<double, 3> up_B{-std::sin(pitch), std::sin(roll) * std::cos(pitch),
                                   std::cos(roll) * std::cos(pitch)};
  motion::ExpectedAttitude attitude;
  for (std::size_t i = 0; i < up_B.size(); ++i) {
    attitude.up_B[i] = static_cast<std::int8_t>(std::lround(up_B[i] * 127.0));
  }
  attitude.min_cosine = static_cast<std::int16_t>(std::lround(std::cos(within) * 32'767.0));
  return attitude;
}

// The effect of mirroring on a mixed source: rates and angles about x and z change their sign.
int mirror_sign_of_source(std::size_t source) { return source == 1 || source == 4 ? 1 : -1; }

}  // namespace

std::optional<StepSource::Interpolation> parse_interpolation(const YamlNode& node, Reader& reader) {
  const auto name = reader.one_of(node, {"linear", "minimum_jerk", "cubic"});
  if (!name) return std::nullopt;
  return *name == "linear"         ? StepSource::Interpolation::kLinear
         : *name == "minimum_jerk" ? StepSource::Interpolation::kMinimumJerk
                                   : StepSource::Interpolation::kCubic;
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
                                     : sim::join_alternatives(names),
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
  if (kind == "expect") return parse_expect(value, step);
  if (kind == "set") return parse_set(value, step);
  if (kind == "call") return parse_call(value, step);
  if (kind == "torque_off") return parse_torque_off(value, step);
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
  if (kind == "stiffness") {
    step.kind = StepKind::kStiffness;
    return parse_stiffness(value, step.stiffness);
  }
  if (kind == "mix") {
    step.kind = StepKind::kMix;
    return (value.kind == YamlNode::Kind::kScalar && value.scalar == "none") || parse_mix(value, step.mix);
  }
  step.kind = StepKind::kLean;
  step.lean = LeanSetting{};
  return (value.kind == YamlNode::Kind::kScalar && value.scalar == "none") || parse_lean(value, step.lean);
}

bool StepParser::set_text(const YamlNode& node, std::string& text) {
  const auto value = reader_.text(node);
  if (value) text = *value;
  return value.has_value();
}

std::optional<std::uint32_t> StepParser::time_us(const YamlNode& map, const std::string& key) {
  const sim::NumberRange range{.min = kMinTime_s, .max = kMaxTime_s};
  const YamlNode* node = reader_.require(map, key, sim::describe(range));
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
  const YamlNode* speed = map.find("speed_deg_per_s");
  if (speed != nullptr && map.find("time_s") != nullptr) {
    reader_.error(code::kContradiction, Reader::key_place(*speed), "time_s and speed_deg_per_s in one step",
                  "one of them");
  } else if (speed != nullptr) {
    // The range is that of the image.
    if (const auto number = reader_.number(*speed, {.min = 0.00001, .max = 92'160.0})) {
      step.speed_raw = static_cast<std::uint32_t>(
          std::clamp<std::int64_t>(std::llround(*number / kDegreesPerTurn * kSpeedUnits), 1, 0xFFFF'FFFF));
    }
  } else {
    step.time_us = time_us(map, "time_s").value_or(0);
  }
  if (const YamlNode* node = map.find("interpolation")) {
    if (const auto interpolation = parse_interpolation(*node, reader_)) step.interpolation = *interpolation;
  }
  if (map.find("pause_s") != nullptr) step.pause_us = time_us(map, "pause_s").value_or(0);
  if (const YamlNode* node = map.find("stiffness")) parse_stiffness(*node, step.stiffness);
  if (const YamlNode* node = map.find("mix")) parse_mix(*node, step.mix);
  if (const YamlNode* node = map.find("lean")) parse_lean(*node, step.lean);
  return pose && reader_.diagnostics().error_count() == errors;
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
    step.condition = condition(*until);
  } else if (while_true != nullptr) {
    step.loop = StepSource::LoopKind::kWhile;
    step.condition = condition(*while_true);
  } else if (const YamlNode* node = reader_.require(value, "times", "an integer from 1 to 65535")) {
    step.times = static_cast<std::uint16_t>(reader_.integer(*node, {.min = 1, .max = 65'535}).value_or(1));
  }
  if (const YamlNode* steps = reader_.require(value, "steps", "a list")) step.body = parse(*steps);
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_if(const YamlNode& map, const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kIf;
  step.condition = condition(value);
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
    step.condition = condition(*until);
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
    step.condition = condition(*when);
    if (!step.condition) return false;
  }
  return set_text(value, step.label);
}

bool StepParser::parse_expect(const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kExpect;
  if (!reader_.is_map(value)) return false;
  if (context_.version >= 2 && value.find("up") != nullptr) return parse_raw_expect(value, step);
  const std::size_t errors = reader_.diagnostics().error_count();
  reader_.check_keys(value, {"roll_deg", "pitch_deg", "within_deg"});
  const YamlNode* roll = value.find("roll_deg");
  const YamlNode* pitch = value.find("pitch_deg");
  const YamlNode* within = reader_.require(value, "within_deg", "a number from 1 to 179");
  const double roll_deg = roll ? reader_.number(*roll, {.min = -180.0, .max = 180.0}).value_or(0.0) : 0.0;
  const double pitch_deg = pitch ? reader_.number(*pitch, {.min = -90.0, .max = 90.0}).value_or(0.0) : 0.0;
  const double within_deg = within ? reader_.number(*within, {.min = 1.0, .max = 179.0}).value_or(1.0) : 1.0;
  step.attitude = attitude_of(roll_deg, pitch_deg, within_deg);
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_raw_expect(const YamlNode& value, StepSource& step) {
  const std::size_t errors = reader_.diagnostics().error_count();
  reader_.check_keys(value, {"up", "min_cosine"});
  const YamlNode& up = *value.find("up");
  if (up.kind != YamlNode::Kind::kList || up.items.size() != 3) {
    reader_.bad_value(up, "a list of 3 integers");
  } else {
    for (std::size_t i = 0; i < 3; ++i) {
      step.attitude.up_B[i] =
          static_cast<std::int8_t>(reader_.integer(up.items[i], {.min = -128, .max = 127}).value_or(0));
    }
  }
  if (const YamlNode* cosine = reader_.require(value, "min_cosine", "an integer from -32768 to 32767")) {
    step.attitude.min_cosine =
        static_cast<std::int16_t>(reader_.integer(*cosine, {.min = -32'768, .max = 32'767}).value_or(0));
  }
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_set(const YamlNode& value, StepSource& step) {
  static constexpr std::array<std::string_view, 8> kOperators{
      "=", "+=", "-=", "*=", "/=", "%=", "min=", "max="};
  step.kind = StepKind::kSet;
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  for (const YamlNode& item : value.items) {
    Assignment assignment;
    const auto& variables = context_.variables;
    const auto variable = std::find_if(variables.begin(), variables.end(),
                                       [&](const VariableSource& other) { return other.name == item.key; });
    if (variable == variables.end()) {
      std::vector<std::string> names;
      for (const VariableSource& known : variables) names.push_back(known.name);
      reader_.error(code::kUnknownVariable, Reader::key_place(item),
                    "the variable '" + sim::one_line(item.key) + "'",
                    "one of the list `variables` of this file", did_you_mean(item.key, names));
      continue;
    }
    assignment.variable = static_cast<std::uint8_t>(variable - variables.begin());
    std::size_t skip = 0;
    for (std::size_t op = 1; op < kOperators.size(); ++op) {
      if (item.kind != YamlNode::Kind::kScalar || !item.scalar.starts_with(kOperators[op])) continue;
      assignment.op = static_cast<SetOperator>(op);
      skip = kOperators[op].size();
    }
    auto parsed = expression(item, skip);
    if (!parsed) continue;
    if (parsed->is_condition()) {
      reader_.error(code::kNotACondition, Reader::value_place(item), "a condition", "a number",
                    "use `if` to choose between two values.");
      continue;
    }
    assignment.value = std::move(*parsed);
    step.assignments.push_back(std::move(assignment));
  }
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_call(const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kCall;
  if (!set_text(value, step.label)) return false;
  const auto& routines = context_.routines;
  if (std::find(routines.begin(), routines.end(), step.label) != routines.end()) return true;
  reader_.error(code::kUnknownRoutine, Reader::value_place(value),
                "the routine '" + sim::one_line(step.label) + "'", "one of the routines of this file",
                did_you_mean(step.label, routines));
  return false;
}

std::optional<std::uint32_t> StepParser::joints(const YamlNode& node, const std::string& name) {
  const std::uint32_t mask = joints_.mask(name);
  const Place place = node.key == name ? Reader::key_place(node) : Reader::value_place(node);
  if (mask == 0) {
    reader_.error(code::kUnknownJoint, place, "the joint '" + sim::one_line(name) + "'",
                  "a joint or group of " + joints_.robot().robot, did_you_mean(name, joints_.all(true)));
    return std::nullopt;
  }
  if ((mask & ~context_.allowed) != 0) {
    reader_.error(code::kJointNotListed, place, "the joint '" + name + "'",
                  "a joint of the list `joints` of this file");
    return std::nullopt;
  }
  return mask;
}

bool StepParser::parse_stiffness(const YamlNode& value, std::vector<StiffnessSetting>& settings) {
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  std::uint32_t given = 0;
  for (const YamlNode& item : value.items) {
    const auto mask = joints(item, item.key);
    const auto percent = reader_.integer(item, {.min = 0, .max = 100});
    if (!mask || !percent) continue;
    if ((given & *mask) != 0) {
      reader_.error(code::kContradiction, Reader::key_place(item),
                    "a second stiffness for a joint of " + item.key, "one for each joint");
      continue;
    }
    given |= *mask;
    const auto same = std::find_if(settings.begin(), settings.end(),
                                   [&](const StiffnessSetting& other) { return other.percent == *percent; });
    if (same != settings.end()) {
      same->joints |= *mask;
    } else {
      settings.push_back({*mask, static_cast<std::uint8_t>(*percent)});
    }
  }
  if (settings.empty() && reader_.diagnostics().error_count() == errors)
    reader_.bad_value(value, "joints with their stiffness");
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_torque_off(const YamlNode& value, StepSource& step) {
  step.kind = StepKind::kStiffness;
  if (!reader_.is_list(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  StiffnessSetting off;
  for (const YamlNode& item : value.items) {
    const auto name = reader_.text(item);
    if (name) off.joints |= joints(item, *name).value_or(0);
  }
  if (value.items.empty()) reader_.bad_value(value, "at least one joint");
  step.stiffness.push_back(off);
  return reader_.diagnostics().error_count() == errors;
}

// A limit that an image can have, which has rounded 1 and 15 degrees.
std::optional<double> StepParser::mix_limit_deg(const Node& node) {
  const auto number = reader_.number(node, {.min = 0.0, .max = 90.0});
  if (!number) return std::nullopt;
  const std::int16_t units = angle_units(*number);
  if (units >= motion::Mix::kMinLimit && units <= motion::Mix::kMaxLimit) return number;
  reader_.bad_value(node, "a number from 1 to 15");
  return std::nullopt;
}

bool StepParser::parse_mix(const YamlNode& value, std::vector<MixSetting>& settings) {
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  for (const YamlNode& item : value.items) {
    const auto left = joints_.find_left(item.key);
    const auto mask = joints_.find(item.key) || left ? joints(item, item.key) : joints(item, item.key + " ");
    if (!mask || !reader_.is_map(item)) continue;
    std::vector<std::string> known(kMixSources.begin(), kMixSources.end());
    known.emplace_back("limit_deg");
    reader_.check_keys(item, known);
    // Gains of zero remove corrections and need no limit.
    const bool removes = std::all_of(item.items.begin(), item.items.end(), [](const YamlNode& entry) {
      return sim::parse_number(entry.scalar) == 0.0;
    });
    const YamlNode* limit = removes ? nullptr : reader_.require(item, "limit_deg", "a number from 1 to 15");
    const auto limit_deg = removes ? std::optional(0.0) : limit ? mix_limit_deg(*limit) : std::nullopt;
    for (std::size_t source = 0; source < kMixSources.size() && limit_deg; ++source) {
      const YamlNode* node = item.find(std::string(kMixSources[source]));
      const auto gain =
          node ? reader_.number(*node, {.min = -8.0, .max = 32'767.0 / kGainUnits}) : std::nullopt;
      if (!gain) continue;
      const auto gain_raw = static_cast<std::int16_t>(std::lround(*gain * kGainUnits));
      for (std::size_t joint = 0; joint < joints_.count(); ++joint) {
        if ((*mask >> joint & 1u) == 0) continue;
        const bool is_image = left && joint == joints_.mirror(*left) && joint != *left;
        const int sign = is_image ? joints_.mirror_sign(*left) * mirror_sign_of_source(source) : 1;
        settings.push_back({static_cast<std::uint8_t>(joint), static_cast<std::uint8_t>(source),
                            static_cast<std::int16_t>(sign * gain_raw),
                            static_cast<std::uint16_t>(angle_units(*limit_deg))});
      }
    }
  }
  if (settings.empty() && reader_.diagnostics().error_count() == errors)
    reader_.bad_value(value, "joints with their gains, or none");
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::parse_lean(const YamlNode& value, std::optional<LeanSetting>& lean) {
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  reader_.check_keys(value, {"pitch_deg", "roll_deg"});
  LeanSetting setting;
  if (const YamlNode* pitch = value.find("pitch_deg"))
    setting.pitch = angle_units(reader_.number(*pitch, {.min = -180.0, .max = 180.0}).value_or(0.0));
  if (const YamlNode* roll = value.find("roll_deg"))
    setting.roll = angle_units(reader_.number(*roll, {.min = -180.0, .max = 180.0}).value_or(0.0));
  lean = setting;
  return reader_.diagnostics().error_count() == errors;
}

bool StepParser::is_test(const YamlNode& node, const Expression& expression) {
  using ExpressionKind = Expression::Kind;
  const bool compares = expression.is_comparison() && expression.items[0].kind == ExpressionKind::kSource;
  const Expression* right = compares ? &expression.items[1] : nullptr;
  if (compares && (right->kind == ExpressionKind::kInteger ||
                   (right->kind == ExpressionKind::kSource && right->source.number == 0))) {
    return true;
  }
  reader_.bad_value(node, "a sensor or variable, compared with an integer or a variable");
  return false;
}

bool StepParser::parse_tests(const YamlNode& value, bool is_await, StepSource& step) {
  static const std::array<std::string, 4> kForms{"all", "any", "not_all", "not_any"};
  step.kind = is_await ? StepKind::kAwait : StepKind::kJump;
  if (!reader_.is_map(value)) return false;
  const std::size_t errors = reader_.diagnostics().error_count();
  std::vector<std::string> known{"to", "all", "any", "not_all", "not_any"};
  if (is_await) known.emplace_back("timeout_s");
  reader_.check_keys(value, known);
  TestBlock block;
  const YamlNode* list = nullptr;
  for (const std::string& form : kForms) {
    const YamlNode* node = value.find(form);
    if (node == nullptr) continue;
    if (list != nullptr) {
      reader_.error(code::kContradiction, Reader::key_place(*node), "two lists of tests", "one of them");
      return false;
    }
    list = node;
    block.any = form.ends_with("any");
    block.negated = form.starts_with("not_");
  }
  if (list == nullptr) {
    reader_.error(code::kMissingKey, Reader::key_place(value), "no tests", "all, any, not_all or not_any");
    return false;
  }
  if (list->kind != YamlNode::Kind::kList || list->items.empty() || list->items.size() > kMaxTests) {
    reader_.bad_value(*list, "a list of 1 to 8 comparisons");
    return false;
  }
  for (const YamlNode& item : list->items) {
    auto test = expression(item);
    if (test && is_test(item, *test)) block.tests.push_back(std::move(*test));
  }
  step.tests = std::move(block);
  if (is_await) step.time_us = time_us(value, "timeout_s").value_or(0);
  const YamlNode* to = is_await ? value.find("to") : reader_.require(value, "to", "a label");
  if (to != nullptr) set_text(*to, step.label);
  return reader_.diagnostics().error_count() == errors;
}

std::optional<Expression> StepParser::expression(const YamlNode& node, std::size_t skip) {
  if (node.kind != YamlNode::Kind::kScalar || node.scalar.empty()) {
    reader_.bad_value(node, "an expression");
    return std::nullopt;
  }
  Place place = Reader::value_place(node);
  if (place.column > 0) place.column += static_cast<int>(skip) + (node.quoted ? 1 : 0);
  return parse_expression(std::string_view(node.scalar).substr(skip), place, context_.variables, joints_,
                          reader_.diagnostics());
}

std::optional<Expression> StepParser::condition(const YamlNode& node) {
  auto parsed = expression(node);
  if (!parsed) return std::nullopt;
  return as_condition(std::move(*parsed));
}

}  // namespace koboshi::simulation
