#include <algorithm>
#include <ranges>

#include "base/text/error.h"
#include "base/text/text.h"
#include "studio/document/edit_support.h"

// The edits that insert, remove and move steps.
namespace koboshi::studio {
namespace {

using simulation::StepSource;

// Whether `path` begins with the steps of `outer`.
bool is_within(const Steps& path, const Steps& outer) {
  return path.size() >= outer.size() && std::equal(outer.begin(), outer.end(), path.begin());
}

// Corrects an index in a path for the removal of a run; both belong to the list whose path is shorter.
// Returns false if the path leads into the run.
bool shift_for_removal(Steps& path, const YamlItems& run) {
  const Steps& list = run.collection.steps();
  if (path.size() <= list.size() || !is_within(path, list)) return true;
  const std::size_t index = std::stoul(path[list.size()]);
  if (index < run.first) return true;
  const bool is_gap = path.size() == list.size() + 1;  // a place between steps, not a step
  if (index >= run.first + run.count) {
    path[list.size()] = std::to_string(index - run.count);
    return true;
  }
  if (is_gap) path[list.size()] = std::to_string(run.first);
  return is_gap;
}

std::string block_of_step(std::string_view yaml) {
  const std::size_t first = yaml.find_first_not_of(" \n");
  const bool is_block = first != std::string_view::npos &&
                        (yaml.substr(first).starts_with("- ") || yaml.substr(first).starts_with('#'));
  std::string block(yaml);
  if (!is_block) block.insert(0, "- ");
  if (!block.ends_with('\n')) block += '\n';
  return block;
}

std::string steps_label(const char* verb, std::size_t count) {
  return std::string(verb) + " " + (count == 1 ? "step" : count_text(count, "step"));
}

}  // namespace

MotionDocument::ListPlace MotionDocument::find_place(const StepPlace& place) const {
  using enum StepPlace::Kind;
  const YamlNode& tree = yaml().tree();
  if (place.kind == kEndOf) {
    if (place.index >= rows_.sections.size())
      throw InputError(source_name(), 0, "section " + std::to_string(place.index + 1),
                       "one of the " + count_text(rows_.sections.size(), "section"));
    const YamlPath& path = rows_.sections[place.index].path;
    const YamlNode* steps = find_node(tree, path);
    return {path, steps != nullptr ? steps->items.size() : 0};
  }
  const MotionRow& step = row(place.index);
  if (place.kind == kBefore || place.kind == kAfter) {
    Steps list = step.path.steps();
    list.pop_back();
    return {YamlPath(std::move(list)), step.list_index + (place.kind == kAfter ? 1 : 0)};
  }
  const YamlNode& node = *find_node(tree, step.path);
  Steps body;
  if (node.find("loop") != nullptr && place.kind == kInto) body = {"loop", "steps"};
  if (node.find("then") != nullptr) body = {place.kind == kInto ? "then" : "else"};
  if (body.empty())
    throw InputError(source_name(), step.line, "a step without a body",
                     place.kind == kInto ? "a loop or branch" : "a branch");
  const YamlPath list = joined(step.path, body);
  const YamlNode* steps = find_node(tree, list);
  return {list, steps != nullptr ? steps->items.size() : 0};
}

std::size_t MotionDocument::row_at(const ListPlace& place) const {
  return rows_.find(joined(place.list, {std::to_string(place.index)})).value_or(rows_.rows.size());
}

void MotionDocument::insert_steps(YamlDocument& yaml, const ListPlace& place, std::string_view block) {
  if (find_node(yaml.tree(), place.list) == nullptr) yaml.set(place.list, "[]");
  yaml.insert_items(place.list, place.index, block);
}

std::size_t MotionDocument::insert_step(const StepPlace& place, std::string_view yaml) {
  const ListPlace target = find_place(place);
  edit("Insert step", {},
       [&](YamlDocument& document) { insert_steps(document, target, block_of_step(yaml)); });
  return row_at(target);
}

void MotionDocument::erase_rows(std::span<const std::size_t> rows) {
  const std::vector<YamlItems> runs = runs_of(rows_, rows, source_name());
  edit(steps_label("Delete", rows.size()), {},
       [&](YamlDocument& yaml) { yaml.erase_items(runs, YamlDocument::Comments::kKeep); });
}

std::size_t MotionDocument::duplicate_rows(std::span<const std::size_t> rows) {
  const std::vector<YamlItems> runs = runs_of(rows_, rows, source_name());
  const ListPlace target{runs.back().collection, runs.back().first + runs.back().count};
  edit(steps_label("Duplicate", rows.size()), {}, [&](YamlDocument& yaml) {
    std::string block;
    for (const YamlItems& run : runs) block += yaml.items_text(run.collection, run.first, run.count);
    yaml.insert_items(target.list, target.index, block);
  });
  return row_at(target);
}

std::size_t MotionDocument::move_rows(std::span<const std::size_t> rows, const StepPlace& place) {
  const std::vector<YamlItems> runs = runs_of(rows_, rows, source_name());
  ListPlace target = find_place(place);
  edit(steps_label("Move", rows.size()), {}, [&](YamlDocument& yaml) {
    // The body into which the steps move exists before the paths change.
    if (find_node(yaml.tree(), target.list) == nullptr) yaml.set(target.list, "[]");
    std::string block;
    for (const YamlItems& run : runs) block += yaml.items_text(run.collection, run.first, run.count);
    Steps gap = joined(target.list, {std::to_string(target.index)}).steps();
    for (const YamlItems& run : std::views::reverse(runs)) {
      if (!shift_for_removal(gap, run))
        throw InputError(source_name(), 0, "a place within the steps that move", "a place outside of them");
    }
    yaml.erase_items(runs, YamlDocument::Comments::kErase);
    target.index = std::stoul(gap.back());
    gap.pop_back();
    target.list = YamlPath(std::move(gap));
    yaml.insert_items(target.list, target.index, block);
  });
  return row_at(target);
}

}  // namespace koboshi::studio
