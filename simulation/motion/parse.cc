#include "simulation/motion/parse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "firmware/fixed/host/convert.h"
#include "firmware/motion/motion.h"
#include "sim_board/input/user_units.h"
#include "sim_board/input/yaml_reader.h"

namespace koboshi::simulation {
namespace {

using fixed::Angle;
using sim::YamlMap;
using sim::YamlValue;
// Tolerance of joint limits: the robot file gives them in radians, the motion in degrees, and rounding may
// differ.
constexpr double kLimitTolerance_deg = 1e-4;
constexpr double kMinTime_s = motion::kMinStepTime_us * 1e-6;
constexpr double kMaxTime_s = motion::kMaxStepTime_us * 1e-6;

double degrees(Angle angle) { return fixed::to_double(angle) / sim::kRadPerDegree; }

std::string degrees_text(Angle angle) { return sim::number_text(std::round(degrees(angle) * 1e4) / 1e4); }

class MotionParser {
 public:
  MotionParser(std::filesystem::path file, const NamedModel& robot, std::span<const sim::Override> overrides)
      : file_(std::move(file), overrides), robot_(robot) {}

  MotionSource parse();

 private:
  PoseSource parse_pose(const std::string& name, const YamlValue& value) const;
  void set_angles(PoseSource& pose, const std::string& key, const YamlValue& value) const;
  void set_angle(PoseSource& pose, std::size_t joint, double angle_deg, const YamlValue& value) const;
  std::optional<std::size_t> find_joint(const std::string& name) const;
  std::vector<StepSource> parse_steps(const std::vector<YamlValue>& values) const;
  StepSource parse_step(const YamlValue& value) const;
  StepSource parse_loop(const YamlMap& map) const;
  StepSource parse_move(const YamlMap& map) const;
  static StepSource parse_expect(const YamlMap& map);
  void set_name(const YamlMap& root);

  sim::YamlFile file_;
  const NamedModel& robot_;
  MotionSource motion_;
  std::map<std::string, std::size_t> pose_indices_;
};

MotionSource MotionParser::parse() {
  const YamlMap root = file_.root();
  root.require_version(1);
  motion_.file = file_.path();
  if (const std::string robot = root.text("robot"); robot != robot_.robot) {
    throw root.error_at("robot", "the robot '" + robot + "'", "a motion for " + robot_.robot);
  }
  set_name(root);
  if (root.has("poses")) {
    for (const auto& [name, value] : root.child("poses").entries()) {
      pose_indices_[name] = motion_.poses.size();
      motion_.poses.push_back(parse_pose(name, value));
    }
  }
  motion_.steps = parse_steps(root.list("steps"));
  file_.finish();
  return std::move(motion_);
}

void MotionParser::set_name(const YamlMap& root) {
  motion_.name = root.text("name");
  const bool printable = std::all_of(motion_.name.begin(), motion_.name.end(),
                                     [](char letter) { return letter >= ' ' && letter <= '~'; });
  if (!printable || motion_.name.size() > motion::kNameSize) {
    throw root.error_at("name", "the name '" + motion_.name + "'",
                        "at most " + std::to_string(motion::kNameSize) + " printable ASCII letters");
  }
}

PoseSource MotionParser::parse_pose(const std::string& name, const YamlValue& value) const {
  PoseSource pose{.name = name, .line = value.line(), .angles = {}};
  pose.angles.resize(robot_.joint_names.size());
  const YamlMap map = value.map();
  for (const auto& [key, angle] : map.entries()) {
    if (key != "others") set_angles(pose, key, angle);
  }
  if (map.one_of("others", {"hold", "zero"}, "hold") == "hold") return pose;
  const YamlValue others = map.value("others");
  for (std::size_t i = 0; i < pose.angles.size(); ++i) {
    if (!pose.angles[i]) set_angle(pose, i, 0.0, others);
  }
  return pose;
}

// Sets one joint by its name, or both sides by the name without the side; the right joint then mirrors the
// left.
void MotionParser::set_angles(PoseSource& pose, const std::string& key, const YamlValue& value) const {
  const double angle_deg = value.number();
  if (const auto joint = find_joint(key)) return set_angle(pose, *joint, angle_deg, value);
  const auto left = find_joint("left_" + key);
  const auto right = find_joint("right_" + key);
  if (!left || !right) throw value.error("the joint '" + key + "'", "a joint of " + robot_.robot);
  set_angle(pose, *left, angle_deg, value);
  set_angle(pose, *right, angle_deg * robot_.model.joints[*left].mirror_sign, value);
}

void MotionParser::set_angle(PoseSource& pose, std::size_t joint, double angle_deg,
                             const YamlValue& value) const {
  const robot::Joint& limits = robot_.model.joints[joint];
  const std::string& name = robot_.joint_names[joint];
  if (pose.angles[joint]) throw value.error("a second angle for " + name, "one angle a joint");
  if (angle_deg < degrees(limits.lower) - kLimitTolerance_deg ||
      angle_deg > degrees(limits.upper) + kLimitTolerance_deg) {
    throw sim::InputError(value.source(), value.line(), sim::number_text(angle_deg) + " degrees for " + name,
                          degrees_text(limits.lower) + " to " + degrees_text(limits.upper),
                          "the limits of " + name);
  }
  pose.angles[joint] =
      robot::clamp_to_limits(limits, fixed::from_double<Angle>(angle_deg * sim::kRadPerDegree));
}

std::optional<std::size_t> MotionParser::find_joint(const std::string& name) const {
  const auto found = std::find(robot_.joint_names.begin(), robot_.joint_names.end(), name);
  if (found == robot_.joint_names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - robot_.joint_names.begin());
}

std::vector<StepSource> MotionParser::parse_steps(const std::vector<YamlValue>& values) const {
  std::vector<StepSource> steps;
  for (const YamlValue& value : values) {
    steps.push_back(parse_step(value));
    steps.back().line = value.line();
  }
  return steps;
}

std::uint32_t time_us(const YamlMap& map, const std::string& key) {
  return static_cast<std::uint32_t>(
      std::lround(map.number(key, {.min = kMinTime_s, .max = kMaxTime_s}) * 1e6));
}

StepSource MotionParser::parse_step(const YamlValue& value) const {
  using Kind = StepSource::Kind;
  StepSource step;
  if (!value.is_map()) {
    if (value.is_list() || value.text() != "end") throw value.error("a step: a map, or the word end");
    return step;
  }
  const YamlMap map = value.map();
  if (map.has("pose")) return parse_move(map);
  if (map.has("loop")) return parse_loop(map.child("loop"));
  if (map.has("expect")) return parse_expect(map.child("expect"));
  if (map.has("wait_s")) {
    step.kind = Kind::kWait;
    step.time_us = time_us(map, "wait_s");
  } else if (map.has("label")) {
    step.kind = Kind::kLabel;
    step.label = map.text("label");
  } else if (map.has("jump")) {
    step.kind = Kind::kJump;
    step.label = map.text("jump");
  } else {
    throw value.error("a step of another kind", "pose with time_s, wait_s, loop, label, jump, expect or end");
  }
  return step;
}

StepSource MotionParser::parse_move(const YamlMap& map) const {
  StepSource step;
  step.kind = StepSource::Kind::kMove;
  const std::string name = map.text("pose");
  const auto found = pose_indices_.find(name);
  if (found == pose_indices_.end()) {
    throw map.error_at("pose", "the pose '" + name + "'", "one of the poses of this file");
  }
  step.pose = found->second;
  step.time_us = time_us(map, "time_s");
  return step;
}

// For a trunk with roll r about x, then pitch p about y, the world's up vector in trunk axes is (-sin p, sin
// r cos p, cos r cos p).
StepSource MotionParser::parse_expect(const YamlMap& map) {
  const double roll = map.number("roll_deg", {.min = -180.0, .max = 180.0}, 0.0) * sim::kRadPerDegree;
  const double pitch = map.number("pitch_deg", {.min = -90.0, .max = 90.0}, 0.0) * sim::kRadPerDegree;
  const double within = map.number("within_deg", {.min = 1.0, .max = 179.0}) * sim::kRadPerDegree;
  const std::array<double, 3> up_B{-std::sin(pitch), std::sin(roll) * std::cos(pitch),
                                   std::cos(roll) * std::cos(pitch)};
  StepSource step;
  step.kind = StepSource::Kind::kExpect;
  for (std::size_t i = 0; i < up_B.size(); ++i) {
    step.attitude.up_B[i] = static_cast<std::int8_t>(std::lround(up_B[i] * 127.0));
  }
  step.attitude.min_cosine = static_cast<std::int16_t>(std::lround(std::cos(within) * 32'767.0));
  return step;
}

StepSource MotionParser::parse_loop(const YamlMap& map) const {
  StepSource step;
  step.kind = StepSource::Kind::kLoop;
  if (map.has("until")) {
    static_cast<void>(map.one_of("until", {"stopped"}));
    step.times = 0;
  } else {
    step.times = static_cast<std::uint16_t>(map.integer("times", {.min = 1, .max = 65535}));
  }
  step.body = parse_steps(map.list("steps"));
  return step;
}

}  // namespace

MotionSource parse_motion(const std::filesystem::path& file, const NamedModel& robot,
                          std::span<const sim::Override> overrides) {
  return MotionParser(file, robot, overrides).parse();
}

}  // namespace koboshi::simulation
