#include "tools/motion_edit/mirror.h"

#include <algorithm>
#include <map>
#include <ranges>
#include <set>

#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/motion_language/parse/joints.h"
#include "simulation/motion_language/parse/poses.h"
#include "studio/document/edit_support.h"

// Mirroring steps, and the whole motion.
namespace koboshi::studio {
namespace {

using simulation::JointNames;
using simulation::PoseSource;

// Returns a pose with the angles of the mirror image: the pose itself if it is symmetric.
const PoseSource* find_mirror_image(const std::vector<PoseSource>& poses, const PoseSource& pose,
                                    const JointNames& names) {
  auto mirrored = pose.angles;
  simulation::mirror_angles(names, mirrored);
  if (mirrored == pose.angles) return &pose;
  const auto found = std::ranges::find_if(
      poses, [&](const PoseSource& other) { return !other.name.empty() && other.angles == mirrored; });
  return found == poses.end() ? nullptr : &*found;
}

// Writes a pose that is the mirror image of another one of the file.
std::string mirrored_entry(const YamlDocument& yaml, const std::string& name, const std::string& image,
                           const JointNames& names, const std::filesystem::path& source) {
  if (version_of(yaml.tree()) >= 2) return yaml_scalar(image) + ": {mirror: " + yaml_scalar(name) + "}\n";
  const YamlNode& poses = *yaml.tree().find("poses");
  const auto index = static_cast<std::size_t>(poses.find(name) - poses.items.data());
  const std::string block = "poses:\n" + indented(yaml.items_text("poses", index, 1));
  YamlDocument copy(source, tools::mirror_motion(source, block, names, {}));
  copy.rename(pose_path(name), yaml_scalar(image));
  return copy.text().substr(copy.places().items.front().items.front().key_begin);
}

}  // namespace

// Returns the mirror image of a block of steps, and adds to `images` the mirror images of its poses, by name.
std::string MotionDocument::mirrored_steps(const YamlDocument& yaml, const std::string& block,
                                           std::map<std::string, std::string>& images,
                                           std::string& new_poses) const {
  const JointNames names(robot_->model);
  const std::string header = "version: " + std::to_string(version_of(yaml.tree())) + "\n";
  YamlDocument steps(source_name(),
                     tools::mirror_motion(source_name(), header + "steps:\n" + indented(block), names, {}));
  std::set<std::string> taken;
  for (const PoseSource& pose : source_->poses) taken.insert(pose.name);
  for (const auto& [name, image] : images) taken.insert(image);
  std::vector<YamlEdit> edits;
  for_each_step(steps.tree(), [&](const YamlNode& step, const YamlPath& path) {
    const YamlNode* value = step.find("pose");
    if (value == nullptr || value->kind != YamlNode::Kind::kScalar) return;
    const std::string& name = value->scalar;
    if (!images.contains(name)) {
      const auto pose = std::ranges::find(source_->poses, name, &PoseSource::name);
      if (pose == source_->poses.end() || pose->angles.empty())
        throw InputError(source_name(), 0, "the pose '" + one_line(name) + "'", "a pose that compiles");
      if (const PoseSource* image = find_mirror_image(source_->poses, *pose, names)) {
        images[name] = image->name;
      } else {
        const std::string other = tools::exchange_left_and_right(name);
        images[name] = fresh_name(taken, other != name ? other : name + "_mirrored");
        taken.insert(images[name]);
        new_poses += mirrored_entry(yaml, name, images[name], names, source_name());
      }
    }
    if (images[name] != name)
      edits.push_back({YamlEdit::Kind::kSet, joined(path, {"pose"}), yaml_scalar(images[name])});
  });
  steps.edit(edits);
  return steps.items_text("steps", 0, steps.tree().find("steps")->items.size());
}

void MotionDocument::mirror_rows(std::span<const std::size_t> rows) {
  const std::vector<YamlItems> runs = runs_of(rows_, rows, source_name());
  edit("Mirror", {}, [&](YamlDocument& yaml) {
    if (!source_) throw InputError(source_name(), 0, "a motion with errors", "a motion that compiles");
    std::map<std::string, std::string> images;
    std::string new_poses;
    for (const YamlItems& run : std::views::reverse(runs)) {
      const std::string before = yaml.items_text(run.collection, run.first, run.count);
      const std::string after = mirrored_steps(yaml, before, images, new_poses);
      if (after != before) yaml.replace_items(run, after);
    }
    add_poses(yaml, motion::kMaxPoses, new_poses);
  });
}

void MotionDocument::mirror_motion() {
  static_cast<void>(yaml());
  replace(tools::mirror_motion(source_name(), text_, JointNames(robot_->model), {}), "Mirror motion");
}

}  // namespace koboshi::studio
