#include "studio/document/edit_support.h"

#include <algorithm>
#include <cmath>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/motion_language/parse/expression.h"
#include "simulation/motion_language/parse/joints.h"

namespace koboshi::studio {
namespace {

constexpr double kTimeUnit_s = 0.001;
constexpr double kMinTime_s = motion::kMinStepTime_us * 1e-6;
constexpr double kMaxTime_s = motion::kMaxStepTime_us * 1e-6;
constexpr double kAngleUnit_deg = 0.01;
constexpr double kLimitTolerance_deg = 1e-4;  // as the compiler's

}  // namespace

YamlPath joined(const YamlPath& path, const Steps& more) {
  Steps steps = path.steps();
  steps.insert(steps.end(), more.begin(), more.end());
  return YamlPath(std::move(steps));
}

YamlPath pose_path(const std::string& pose) { return YamlPath(Steps{"poses", pose}); }

const YamlNode* find_node(const YamlNode& root, const YamlPath& path) {
  const YamlNode* node = &root;
  for (const std::string& step : path.steps()) {
    if (node->kind == YamlNode::Kind::kList) {
      const auto index = parse_integer(step);
      const bool exists = index && *index >= 0 && *index < static_cast<std::int64_t>(node->items.size());
      node = exists ? &node->items[static_cast<std::size_t>(*index)] : nullptr;
    } else {
      node = node->find(step);
    }
    if (node == nullptr) return nullptr;
  }
  return node;
}

std::string scalar_at(const YamlNode& root, const YamlPath& path) {
  const YamlNode* node = find_node(root, path);
  return node != nullptr ? node->scalar : std::string();
}

int version_of(const YamlNode& tree) { return scalar_at(tree, "version") == "2" ? 2 : 1; }

void for_each_step(const YamlNode& list, const YamlPath& path, const StepVisitor& visit) {
  if (list.kind != YamlNode::Kind::kList) return;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const YamlNode& step = list.items[i];
    const YamlPath step_path = joined(path, {std::to_string(i)});
    visit(step, step_path);
    const YamlNode* loop = step.find("loop");
    if (const YamlNode* steps = loop != nullptr ? loop->find("steps") : nullptr)
      for_each_step(*steps, joined(step_path, {"loop", "steps"}), visit);
    for (const char* branch : {"then", "else"}) {
      if (const YamlNode* steps = step.find(branch))
        for_each_step(*steps, joined(step_path, {branch}), visit);
    }
  }
}

void for_each_step(const YamlNode& tree, const StepVisitor& visit) {
  if (const YamlNode* steps = tree.find("steps")) for_each_step(*steps, "steps", visit);
  const YamlNode* routines = tree.find("routines");
  if (routines == nullptr || routines->kind != YamlNode::Kind::kMap) return;
  for (const YamlNode& routine : routines->items)
    for_each_step(routine, YamlPath(Steps{"routines", routine.key}), visit);
}

std::vector<PoseReference> pose_references(const YamlNode& tree) {
  std::vector<PoseReference> found;
  const auto add_derived = [&](const YamlNode& map, const YamlPath& path) {
    for (const char* key : {"from", "mirror"}) {
      const YamlNode* value = map.find(key);
      if (value != nullptr && value->kind == YamlNode::Kind::kScalar)
        found.push_back({joined(path, {key}), value->scalar});
    }
  };
  if (const YamlNode* poses = tree.find("poses")) {
    for (const YamlNode& item : poses->items) add_derived(item, pose_path(item.key));
  }
  for_each_step(tree, [&](const YamlNode& step, const YamlPath& path) {
    const YamlNode* value = step.find("pose");
    if (value == nullptr) return;
    if (value->kind == YamlNode::Kind::kMap) return add_derived(*value, joined(path, {"pose"}));
    found.push_back({joined(path, {"pose"}), value->scalar});
  });
  return found;
}

void rename_poses(YamlDocument& yaml, const std::map<std::string, std::string>& names) {
  std::vector<YamlEdit> edits;
  for (const auto& [path, pose] : pose_references(yaml.tree())) {
    if (const auto name = names.find(pose); name != names.end())
      edits.push_back({YamlEdit::Kind::kSet, path, yaml_scalar(name->second)});
  }
  for (const auto& [from, to] : names)
    edits.push_back({YamlEdit::Kind::kRename, pose_path(from), yaml_scalar(to)});
  yaml.edit(edits);
}

std::string yaml_scalar(const std::string& text) {
  if (simulation::is_identifier(text)) return text;
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + "\"";
}

std::string indented(const std::string& block) {
  std::string text;
  for (std::size_t begin = 0; begin < block.size();) {
    const std::size_t end = std::min(block.find('\n', begin), block.size());
    if (end > begin) text += "  " + block.substr(begin, end - begin);
    text += '\n';
    begin = end + 1;
  }
  return text;
}

std::string rounded_text(double value, double step) {
  const double per_unit = std::round(1.0 / step);
  const double rounded = std::round(value * per_unit) / per_unit;
  return koboshi::number_text(rounded == 0.0 ? 0.0 : rounded);
}

std::string time_text(double time_s, int line, const std::filesystem::path& source) {
  if (!(time_s >= kMinTime_s && time_s <= kMaxTime_s))
    throw InputError(source, line, koboshi::number_text(time_s) + " s",
                     describe(NumberRange{kMinTime_s, kMaxTime_s}));
  return rounded_text(time_s, kTimeUnit_s);
}

std::string angle_text(const MotionRobot& robot, const JointAngle& angle,
                       const std::filesystem::path& source) {
  if (angle.joint >= robot.model.joint_names.size())
    throw InputError(source, 0, "joint " + std::to_string(angle.joint),
                     "one of the " + std::to_string(robot.model.joint_names.size()) + " joints");
  const robot::Joint& joint = robot.model.model.joints[angle.joint];
  const double lower = fixed::to_double(joint.lower) * kDegreesPerRad;
  const double upper = fixed::to_double(joint.upper) * kDegreesPerRad;
  const double angle_deg = angle.angle_rad * kDegreesPerRad;
  if (!(angle_deg >= lower - kAngleUnit_deg / 2 && angle_deg <= upper + kAngleUnit_deg / 2)) {
    throw InputError(
        source, 0, degrees_text(angle.angle_rad) + " degrees for " + robot.model.joint_names[angle.joint],
        degrees_text(fixed::to_double(joint.lower)) + " to " + degrees_text(fixed::to_double(joint.upper)));
  }
  double units = std::round(angle_deg / kAngleUnit_deg);
  if (units * kAngleUnit_deg > upper + kLimitTolerance_deg) units = std::floor(upper / kAngleUnit_deg);
  if (units * kAngleUnit_deg < lower - kLimitTolerance_deg) units = std::ceil(lower / kAngleUnit_deg);
  return rounded_text(units * kAngleUnit_deg, kAngleUnit_deg);
}

std::string pose_text(const MotionRobot& robot, std::span<const double> angles_rad, std::uint32_t allowed,
                      const std::filesystem::path& source) {
  const simulation::JointNames names(robot.model);
  const auto text_of = [&](std::size_t joint) {
    return angle_text(robot, {joint, angles_rad[joint]}, source);
  };
  if (angles_rad.size() != names.count())
    throw InputError(source, 0, count_text(angles_rad.size(), "angle"),
                     "one for each of the " + count_text(names.count(), "joint"));
  std::string text = "{others: zero";
  std::uint32_t done = ~allowed;
  for (std::size_t joint = 0; joint < names.count(); ++joint) {
    if ((done >> joint & 1U) != 0) continue;
    done |= 1U << joint;
    const std::string angle = text_of(joint);
    const robot::Joint& limits = robot.model.model.joints[joint];
    const bool is_zero = angle == "0" && robot::clamp_to_limits(limits, fixed::Angle()) == fixed::Angle();
    if (is_zero) continue;
    std::string name = names.name(joint);
    const std::size_t other = names.mirror(joint);
    const bool has_side = name.starts_with("left_") && other != joint && (done >> other & 1U) == 0;
    // Compared as written: the mirror image of an angle can be beyond this joint's limits.
    if (has_side && parse_number(text_of(other)).value_or(0.0) ==
                        names.mirror_sign(joint) * parse_number(angle).value_or(0.0)) {
      done |= 1U << other;
      name = name.substr(5);
    }
    text += ", " + name + ": " + angle;
  }
  return text + "}";
}

std::uint32_t allowed_joints(const MotionRobot& robot, const YamlNode& tree) {
  const simulation::JointNames names(robot.model);
  const std::uint32_t all = (std::uint32_t{1} << names.count()) - 1;
  const YamlNode* list = version_of(tree) < 2 ? nullptr : tree.find("joints");
  if (list == nullptr || list->kind != YamlNode::Kind::kList) return all;
  std::uint32_t allowed = 0;
  for (const YamlNode& item : list->items) allowed |= names.mask(item.scalar);
  return allowed != 0 ? allowed : all;
}

std::string fresh_name(const std::set<std::string>& taken, const std::string& wish) {
  if (!taken.contains(wish)) return wish;
  // "bow_2" counts on from "bow".
  const std::size_t stem_end = wish.find_last_not_of("0123456789");
  const bool has_number =
      stem_end != std::string::npos && stem_end + 1 < wish.size() && wish[stem_end] == '_';
  const std::string stem = has_number ? wish.substr(0, stem_end) : wish;
  int number = 2;
  while (taken.contains(stem + "_" + std::to_string(number))) ++number;
  return stem + "_" + std::to_string(number);
}

std::string fresh_pose_name(const YamlNode& tree, const std::string& wish) {
  std::set<std::string> taken;
  if (const YamlNode* poses = tree.find("poses")) {
    for (const YamlNode& pose : poses->items) taken.insert(pose.key);
  }
  return fresh_name(taken, wish);
}

void add_poses(YamlDocument& yaml, std::size_t index, const std::string& block) {
  if (block.empty()) return;
  if (yaml.tree().find("poses") == nullptr) yaml.insert("poses", "{}");
  yaml.insert_items("poses", std::min(index, yaml.tree().find("poses")->items.size()), block);
}

std::vector<std::size_t> each_once(const MotionRows& rows, std::span<const std::size_t> selected,
                                   const std::filesystem::path& source) {
  if (selected.empty()) throw InputError(source, 0, "no step", "one or more steps");
  std::vector<std::size_t> sorted(selected.begin(), selected.end());
  std::ranges::sort(sorted);
  const auto twice = std::ranges::unique(sorted);
  sorted.erase(twice.begin(), twice.end());
  if (sorted.back() < rows.rows.size()) return sorted;
  throw InputError(source, 0, "row " + std::to_string(sorted.back() + 1),
                   "one of the " + count_text(rows.rows.size(), "step"));
}

std::vector<YamlItems> runs_of(const MotionRows& rows, std::span<const std::size_t> selected,
                               const std::filesystem::path& source) {
  std::vector<bool> covered(rows.rows.size(), false);
  std::vector<YamlItems> runs;
  for (const std::size_t row : each_once(rows, selected, source)) {
    const MotionRow& step = rows.rows[row];
    bool in_body = false;
    for (auto parent = step.parent; parent; parent = rows.rows[*parent].parent)
      in_body = in_body || covered[*parent];
    covered[row] = true;
    if (in_body) continue;
    Steps list = step.path.steps();
    list.pop_back();
    const bool follows = !runs.empty() && runs.back().collection.steps() == list &&
                         runs.back().first + runs.back().count == step.list_index;
    if (follows) {
      ++runs.back().count;
    } else {
      runs.push_back({YamlPath(std::move(list)), step.list_index, 1});
    }
  }
  return runs;
}

std::vector<std::size_t> with_bodies(const MotionRows& rows, std::span<const std::size_t> selected,
                                     const std::filesystem::path& source) {
  std::vector<bool> is_in(rows.rows.size(), false);
  for (const std::size_t row : each_once(rows, selected, source)) is_in[row] = true;
  std::vector<std::size_t> all;
  for (std::size_t row = 0; row < rows.rows.size(); ++row) {
    if (const auto parent = rows.rows[row].parent) is_in[row] = is_in[row] || is_in[*parent];
    if (is_in[row]) all.push_back(row);
  }
  return all;
}

}  // namespace koboshi::studio
