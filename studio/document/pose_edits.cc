#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "simulation/motion_language/parse/joints.h"
#include "studio/document/edit_support.h"

// The edits of poses.
namespace koboshi::studio {
namespace {

using simulation::JointNames;

constexpr double kHalfUnit_rad = 0.005 * kRadPerDegree;
constexpr std::array kLegTargets{"trunk", "com", "left_foot", "right_foot"};

// Joints whose angles follow from the Cartesian targets of a pose (docs/reference/motion-language.md).
std::uint32_t determined_joints(const YamlNode& pose, const JointNames& names) {
  std::uint32_t joints = 0;
  const bool legs =
      std::ranges::any_of(kLegTargets, [&](const char* key) { return pose.find(key) != nullptr; });
  if (legs) joints |= names.mask("legs");
  if (pose.find("left_hand") != nullptr) joints |= names.mask("left_arm");
  if (pose.find("right_hand") != nullptr) joints |= names.mask("right_arm");
  return joints;
}

bool is_target_key(const std::string& key) {
  return key == "support" || key == "left_hand" || key == "right_hand" ||
         std::ranges::find(kLegTargets, key) != kLegTargets.end();
}

// The new angles of a pose, by joint, as texts in degrees.
using AngleTexts = std::vector<std::optional<std::string>>;

bool equals(const std::string& number, const std::string& other) {
  const auto one = parse_number(number);
  return one && one == parse_number(other);
}

std::string negated(const std::string& number) {
  const double value = parse_number(number).value_or(0.0);
  return koboshi::number_text(value == 0.0 ? 0.0 : -value);
}

// Edits the keys of a pose, each of which names a joint, or both sides of one.
class PoseKeys {
 public:
  PoseKeys(const YamlNode& pose, const YamlPath& path, const JointNames& names)
      : pose_(pose), path_(path), names_(names) {}

  std::vector<YamlEdit> edits(AngleTexts wanted) {
    for (const YamlNode& item : pose_.items) {
      if (const auto joint = names_.find(item.key)) {
        if (wanted[*joint]) set(item, *wanted[*joint]);
        wanted[*joint].reset();
      } else if (const auto left = names_.find_left(item.key)) {
        set_sides(item, *left, wanted);
      }
    }
    for (std::size_t joint = 0; joint < wanted.size(); ++joint) {
      if (wanted[joint]) add(joint, *wanted[joint]);
    }
    return std::move(edits_);
  }

 private:
  void set(const YamlNode& item, const std::string& angle) {
    if (!equals(item.scalar, angle))
      edits_.push_back({YamlEdit::Kind::kSet, joined(path_, {item.key}), angle});
  }
  void add(std::size_t joint, const std::string& angle) {
    edits_.push_back({YamlEdit::Kind::kSet, joined(path_, {names_.name(joint)}), angle});
  }

  // A key without its side is split into two if the sides are no longer mirror images.
  void set_sides(const YamlNode& item, std::size_t left, AngleTexts& wanted) {
    const std::size_t right = names_.mirror(left);
    if (!wanted[left] && !wanted[right]) return;
    const bool opposite = names_.mirror_sign(left) < 0;
    const auto mirrored = [&](const std::string& angle) { return opposite ? negated(angle) : angle; };
    const std::string left_angle = wanted[left].value_or(item.scalar);
    const std::string right_angle = wanted[right].value_or(mirrored(item.scalar));
    wanted[left].reset();
    wanted[right].reset();
    set(item, left_angle);
    if (equals(mirrored(left_angle), right_angle)) return;
    edits_.push_back({YamlEdit::Kind::kRename, joined(path_, {item.key}), names_.name(left)});
    add(right, right_angle);
  }

  const YamlNode& pose_;
  const YamlPath& path_;
  const JointNames& names_;
  std::vector<YamlEdit> edits_;
};

// The pose in flow style with angles in the place of its targets.
std::string without_targets(const YamlNode& pose, const AngleTexts& angles, const JointNames& names) {
  std::string text;
  AngleTexts rest = angles;
  const auto add = [&](const std::string& key, const std::string& value) {
    text += (text.empty() ? "" : ", ") + key + ": " + value;
  };
  const auto add_joint = [&](std::size_t joint, const std::string& value) {
    add(names.name(joint), rest[joint].value_or(value));
    rest[joint].reset();
  };
  for (const YamlNode& item : pose.items) {
    if (is_target_key(item.key)) continue;
    const auto left = names.find_left(item.key);
    if (const auto joint = names.find(item.key)) {
      add_joint(*joint, item.scalar);
    } else if (left && (rest[*left] || rest[names.mirror(*left)])) {
      const std::size_t right = names.mirror(*left);  // the same where one motor turns both sides
      add_joint(*left, item.scalar);
      if (right != *left) add_joint(right, names.mirror_sign(*left) < 0 ? negated(item.scalar) : item.scalar);
    } else {
      add(item.key, left ? item.scalar : yaml_scalar(item.scalar));
    }
  }
  for (std::size_t joint = 0; joint < rest.size(); ++joint) {
    if (rest[joint]) add(names.name(joint), *rest[joint]);
  }
  return "{" + text + "}";
}

std::string edit_label(const JointNames& names, std::span<const JointAngle> angles) {
  return angles.size() == 1 && angles.front().joint < names.count()
             ? "Move " + names.name(angles.front().joint)
             : "Move joints";
}

}  // namespace

// Returns the path of the pose that the edit changes, after giving the step a copy if it needs one.
YamlPath MotionDocument::own_pose(YamlDocument& yaml, const MotionRow& row, PoseScope scope) const {
  const YamlPath value = joined(row.path, {"pose"});
  if (row.pose.empty()) return value;
  const YamlNode* poses = yaml.tree().find("poses");
  const YamlNode* pose = poses != nullptr ? poses->find(row.pose) : nullptr;
  if (pose == nullptr || pose->kind != YamlNode::Kind::kMap)
    throw InputError(source_name(), row.line, "the pose '" + one_line(row.pose) + "'",
                     "one of the poses of this file");
  if (scope == PoseScope::kAllSteps || row.pose_uses < 2) return pose_path(row.pose);
  const auto index = static_cast<std::size_t>(pose - poses->items.data());
  const std::string name = fresh_pose_name(yaml.tree(), row.pose);
  YamlDocument copy(source_name(), yaml.items_text("poses", index, 1));
  copy.rename(YamlPath(Steps{row.pose}), yaml_scalar(name));
  const std::string block = copy.text().substr(copy.places().items.front().key_begin);
  yaml.insert_items("poses", index + 1, block);
  yaml.set(value, yaml_scalar(name));
  return pose_path(name);
}

std::vector<YamlEdit> MotionDocument::angle_edits(const YamlDocument& yaml, const YamlPath& pose,
                                                  const MotionRow& row,
                                                  std::span<const JointAngle> angles) const {
  const JointNames names(robot_->model);
  const YamlNode& node = *find_node(yaml.tree(), pose);
  const std::uint32_t determined = determined_joints(node, names);
  const std::uint32_t allowed = allowed_joints(*robot_, yaml.tree());
  AngleTexts wanted(names.count());
  bool moves_determined = false;
  for (const JointAngle& angle : angles) {
    const std::string text = angle_text(*robot_, angle, source_name());
    // An angle that the step reaches already needs no key.
    const bool is_allowed = (allowed >> angle.joint & 1U) != 0;
    const bool is_given = (row.moved >> angle.joint & 1U) != 0;
    const bool is_reached = std::abs(row.angles_rad.at(angle.joint) - angle.angle_rad) < kHalfUnit_rad;
    if (is_reached && (is_given || !is_allowed)) continue;
    if (!is_allowed)
      throw InputError(source_name(), row.line, names.name(angle.joint),
                       "a joint of the list `joints` of this file");
    JointAngle own = angle;
    if (row.mirrored) {
      own = {names.mirror(angle.joint), names.mirror_sign(angle.joint) * angle.angle_rad};
    }
    wanted[own.joint] = row.mirrored ? angle_text(*robot_, own, source_name()) : text;
    moves_determined = moves_determined || (determined >> own.joint & 1U) != 0;
  }
  if (!moves_determined) return PoseKeys(node, pose, names).edits(std::move(wanted));
  // The targets would determine the joint again: their angles replace them.
  for (std::size_t joint = 0; joint < wanted.size(); ++joint) {
    if ((determined >> joint & 1U) == 0 || wanted[joint]) continue;
    const std::size_t seen = row.mirrored ? names.mirror(joint) : joint;
    if ((row.moved >> seen & 1U) == 0)
      throw InputError(source_name(), node.line, "a pose whose targets have errors", "a pose that compiles");
    const double sign = row.mirrored ? names.mirror_sign(joint) : 1;
    wanted[joint] = angle_text(*robot_, {joint, sign * row.angles_rad[seen]}, source_name());
  }
  return {{YamlEdit::Kind::kSet, pose, without_targets(node, wanted, names)}};
}

void MotionDocument::set_angles(std::size_t index, std::span<const JointAngle> angles, PoseScope scope,
                                std::string_view drag) {
  const MotionRow step = row(index);
  if (find_node(yaml().tree(), joined(step.path, {"pose"})) == nullptr)
    throw InputError(source_name(), step.line, "a step that is no move", "a move to a pose");
  const JointNames names(robot_->model);
  edit(edit_label(names, angles), drag, [&](YamlDocument& yaml) {
    const YamlPath here = step.pose.empty() ? joined(step.path, {"pose"}) : pose_path(step.pose);
    const YamlNode* node = find_node(yaml.tree(), here);
    if (node != nullptr && node->kind == YamlNode::Kind::kMap &&
        angle_edits(yaml, here, step, angles).empty())
      return;  // nothing changes, and the step needs no copy
    const YamlPath pose = own_pose(yaml, step, scope);
    yaml.edit(angle_edits(yaml, pose, step, angles));
  });
}

void MotionDocument::rename_pose(const std::string& from, const std::string& to) {
  const YamlNode* poses = yaml().tree().find("poses");
  const YamlNode* pose = poses != nullptr ? poses->find(from) : nullptr;
  if (pose == nullptr)
    throw InputError(source_name(), 0, "the pose '" + one_line(from) + "'", "one of the poses of this file");
  if (from == to) return;
  if (to.empty() || poses->find(to) != nullptr)
    throw InputError(source_name(), pose->line, "the name '" + one_line(to) + "'", "a name that no pose has");
  edit("Rename " + from, {}, [&](YamlDocument& yaml) { rename_poses(yaml, {{from, to}}); });
}

std::size_t MotionDocument::insert_pose(const StepPlace& place, std::span<const double> angles_rad,
                                        double time_s, const std::string& pose_name) {
  const ListPlace target = find_place(place);
  const std::string time = time_text(time_s, 0, source_name());
  edit("Insert " + pose_name, {}, [&](YamlDocument& yaml) {
    const std::uint32_t allowed = allowed_joints(*robot_, yaml.tree());
    const YamlNode* poses = yaml.tree().find("poses");
    const std::string name = yaml_scalar(fresh_pose_name(yaml.tree(), pose_name));
    add_poses(yaml, poses != nullptr ? poses->items.size() : 0,
              name + ": " + pose_text(*robot_, angles_rad, allowed, source_name()) + "\n");
    insert_steps(yaml, target, "- {pose: " + name + ", time_s: " + time + "}\n");
  });
  return row_at(target);
}

}  // namespace koboshi::studio
