#include <algorithm>
#include <map>
#include <set>

#include "base/text/error.h"
#include "base/text/text.h"
#include "studio/document/edit_support.h"

// Copying steps as text, and pasting them into this or another motion.
namespace koboshi::studio {
namespace {

constexpr const char* kClipboard = "copied steps";

// Adds the poses to which a step or pose refers.
void add_references(const YamlNode& node, std::set<std::string>& names) {
  for (const char* key : {"pose", "from", "mirror"}) {
    const YamlNode* value = node.find(key);
    if (value != nullptr && value->kind == YamlNode::Kind::kScalar) names.insert(value->scalar);
  }
  for (const YamlNode& item : node.items) add_references(item, names);
}

using Names = std::map<std::string, std::string>;

// Whether two poses have the same keys and values, in whatever order. `names`: new names of the poses to
// which `copied` refers.
bool same_pose(const YamlNode& copied, const YamlNode& own, const Names& names) {
  if (copied.kind != own.kind || copied.items.size() != own.items.size()) return false;
  if (copied.kind == YamlNode::Kind::kScalar) {
    const auto number = parse_number(copied.scalar);
    if (number) return number == parse_number(own.scalar);
    const auto name =
        copied.key == "from" || copied.key == "mirror" ? names.find(copied.scalar) : names.end();
    return own.scalar == (name != names.end() ? name->second : copied.scalar);
  }
  return std::ranges::all_of(copied.items, [&](const YamlNode& item) {
    const YamlNode* match = own.find(item.key);
    return match != nullptr && same_pose(item, *match, names);
  });
}

// Poses in an order in which each comes after the one from which it is derived.
std::vector<std::string> bases_first(const YamlNode& poses) {
  std::vector<std::string> order;
  std::set<std::string> done;
  while (order.size() < poses.items.size()) {
    const std::size_t before = order.size();
    for (const YamlNode& pose : poses.items) {
      std::set<std::string> bases;
      add_references(pose, bases);
      const bool is_ready = std::ranges::all_of(
          bases, [&](const std::string& base) { return done.contains(base) || poses.find(base) == nullptr; });
      if (is_ready && done.insert(pose.key).second) order.push_back(pose.key);
    }
    if (order.size() > before) continue;
    for (const YamlNode& pose : poses.items) {  // a cycle, which the compiler reports
      if (done.insert(pose.key).second) order.push_back(pose.key);
    }
  }
  return order;
}

// Gives the copied poses names that are free in the motion, and returns those that it has already.
std::set<std::string> fit_poses(YamlDocument& copied, const YamlNode& motion) {
  std::set<std::string> reused;
  const YamlNode* poses = copied.tree().find("poses");
  const YamlNode* own = motion.find("poses");
  if (poses == nullptr || own == nullptr) return reused;
  Names names;
  std::set<std::string> taken;
  for (const YamlNode& pose : poses->items) taken.insert(pose.key);
  for (const YamlNode& pose : own->items) taken.insert(pose.key);
  for (const std::string& name : bases_first(*poses)) {
    const YamlNode& pose = *poses->find(name);
    const YamlNode* same = own->find(name);
    if (same == nullptr) continue;
    if (!same_pose(pose, *same, names)) {
      // The copy of an earlier paste, if there is one.
      const auto earlier = std::ranges::find_if(own->items, [&](const YamlNode& other) {
        return other.key.starts_with(name + "_") && poses->find(other.key) == nullptr &&
               same_pose(pose, other, names);
      });
      same = earlier == own->items.end() ? nullptr : &*earlier;
      names[name] = same != nullptr ? same->key : fresh_name(taken, name);
      taken.insert(names[name]);
    }
    if (same != nullptr) reused.insert(same->key);
  }
  rename_poses(copied, names);
  return reused;
}

// Moves without an interpolation keep that of the motion from which they come.
void fix_interpolation(YamlDocument& copied, const YamlNode& motion) {
  const auto default_of = [](const YamlNode& tree) {
    const std::string text = scalar_at(tree, "interpolation");
    return text.empty() ? std::string("linear") : text;
  };
  const std::string own = default_of(copied.tree());
  if (own == default_of(motion)) return;
  std::vector<YamlEdit> edits;
  for_each_step(copied.tree(), [&](const YamlNode& step, const YamlPath& path) {
    if (step.find("pose") != nullptr && step.find("interpolation") == nullptr)
      edits.push_back({YamlEdit::Kind::kSet, joined(path, {"interpolation"}), own});
  });
  copied.edit(edits);
}

}  // namespace

std::string MotionDocument::copy_rows(std::span<const std::size_t> rows) const {
  const YamlNode& tree = yaml().tree();
  std::string block;
  std::set<std::string> names;
  for (const YamlItems& run : runs_of(rows_, rows, source_name())) {
    block += yaml_->items_text(run.collection, run.first, run.count);
    for (std::size_t i = run.first; i < run.first + run.count; ++i)
      add_references(*find_node(tree, joined(run.collection, {std::to_string(i)})), names);
  }
  std::string poses;
  if (const YamlNode* own = tree.find("poses")) {
    for (std::size_t before = 0; before != names.size();) {  // with the poses from which they are derived
      before = names.size();
      for (const YamlNode& pose : own->items) {
        if (names.contains(pose.key)) add_references(pose, names);
      }
    }
    for (std::size_t i = 0; i < own->items.size(); ++i) {
      if (names.contains(own->items[i].key)) poses += yaml_->items_text("poses", i, 1);
    }
  }
  const std::string interpolation = scalar_at(tree, "interpolation");
  return "version: " + std::to_string(version_of(tree)) + "\nrobot: " + yaml_scalar(robot_->model.robot) +
         "\nname: copied\n" + (interpolation.empty() ? "" : "interpolation: " + interpolation + "\n") +
         (poses.empty() ? "" : "poses:\n" + indented(poses)) + "steps:\n" + indented(block);
}

std::size_t MotionDocument::paste(const StepPlace& place, const std::string& copied_text) {
  const ListPlace target = find_place(place);
  YamlDocument copied(kClipboard, copied_text);
  const YamlNode* robot = copied.tree().find("robot");
  const YamlNode* steps = copied.tree().find("steps");
  if (robot == nullptr || steps == nullptr || steps->items.empty() || steps->kind != YamlNode::Kind::kList)
    throw InputError(kClipboard, 0, "another text", "steps of a motion");
  if (robot->scalar != robot_->model.robot)
    throw InputError(kClipboard, robot->line, "the robot '" + one_line(robot->scalar) + "'",
                     "steps of a motion for " + robot_->model.robot);
  if (version_of(copied.tree()) > version_of(yaml().tree())) require_version_2("these steps");
  const std::size_t count = steps->items.size();
  edit(count == 1 ? "Paste step" : "Paste " + count_text(count, "step"), {}, [&](YamlDocument& yaml) {
    const std::set<std::string> reused = fit_poses(copied, yaml.tree());
    fix_interpolation(copied, yaml.tree());
    std::string poses;
    if (const YamlNode* all = copied.tree().find("poses")) {
      for (std::size_t i = 0; i < all->items.size(); ++i) {
        if (!reused.contains(all->items[i].key)) poses += copied.items_text("poses", i, 1);
      }
    }
    const YamlNode* own = yaml.tree().find("poses");
    add_poses(yaml, own != nullptr ? own->items.size() : 0, poses);
    insert_steps(yaml, target, copied.items_text("steps", 0, count));
  });
  return row_at(target);
}

}  // namespace koboshi::studio
