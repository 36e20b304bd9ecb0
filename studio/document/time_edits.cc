#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "studio/document/edit_support.h"

// The edits of times, speeds and other values of steps.
namespace koboshi::studio {
namespace {

using simulation::StepSource;
using Kind = StepSource::Kind;

constexpr double kSpeedUnit_deg_per_s = 0.01;
constexpr std::array kInterpolations{"linear", "minimum_jerk", "cubic", "trapezoid"};
// The keys that say how long a move takes; it has one of them.
constexpr std::array kTimings{"time_s", "speed_deg_per_s", "at_least_s"};

std::string speed_text(double speed_deg_per_s, int line, const std::filesystem::path& source) {
  if (!(speed_deg_per_s >= kSpeedUnit_deg_per_s && speed_deg_per_s <= 92'160.0))  // the image's highest
    throw InputError(source, line, koboshi::number_text(speed_deg_per_s) + " degrees/s", "0.01 to 92160");
  return rounded_text(speed_deg_per_s, kSpeedUnit_deg_per_s);
}

// The key with the time of a step: empty if it has none.
Steps time_key(const YamlNode& step) {
  if (step.find("pose") != nullptr) return {step.find("at_least_s") != nullptr ? "at_least_s" : "time_s"};
  if (step.find("wait_s") != nullptr) return {"wait_s"};
  for (const char* key : {"wait", "await"}) {
    if (step.find(key) != nullptr) return {key, "timeout_s"};
  }
  return {};
}

// Sets one of the keys kTimings, in the place of the one that the move has.
void set_timing(const YamlNode& step, const YamlPath& path, const std::string& key, const std::string& value,
                std::vector<YamlEdit>& edits) {
  std::string present = key;
  for (const char* other : kTimings) {
    if (step.find(key) == nullptr && step.find(other) != nullptr) present = other;
  }
  const bool replaces = present != key;
  const YamlPath place = joined(path, {present});
  edits.push_back({YamlEdit::Kind::kSet, place, value});
  if (replaces) edits.push_back({YamlEdit::Kind::kRename, place, key});
}

InputError not_a_move(const MotionRow& row, const std::filesystem::path& source) {
  return {source, row.line, "a step that is no move", "a move to a pose"};
}

}  // namespace

void MotionDocument::set_time(std::span<const std::size_t> rows, double time_s, std::string_view drag) {
  edit("Change time", drag, [&](YamlDocument& yaml) {
    std::vector<YamlEdit> edits;
    for (const std::size_t index : each_once(rows_, rows, source_name())) {
      const MotionRow& step = rows_.rows[index];
      const YamlNode& node = *find_node(yaml.tree(), step.path);
      const Steps key = time_key(node);
      if (key.empty())
        throw InputError(source_name(), step.line, "a step without a time", "a move or a wait");
      const std::string text = time_text(time_s, step.line, source_name());
      if (key.size() == 1 && key.front() == "time_s") {
        set_timing(node, step.path, "time_s", text, edits);
      } else {
        edits.push_back({YamlEdit::Kind::kSet, joined(step.path, key), text});
      }
    }
    yaml.edit(edits);
  });
}

void MotionDocument::set_speed(std::span<const std::size_t> rows, double speed_deg_per_s,
                               std::string_view drag) {
  require_version_2("a speed");
  edit("Change speed", drag, [&](YamlDocument& yaml) {
    std::vector<YamlEdit> edits;
    for (const std::size_t index : each_once(rows_, rows, source_name())) {
      const MotionRow& step = rows_.rows[index];
      const YamlNode& node = *find_node(yaml.tree(), step.path);
      if (node.find("pose") == nullptr) throw not_a_move(step, source_name());
      set_timing(node, step.path, "speed_deg_per_s", speed_text(speed_deg_per_s, step.line, source_name()),
                 edits);
    }
    yaml.edit(edits);
  });
}

void MotionDocument::set_pause(std::span<const std::size_t> rows, double pause_s, std::string_view drag) {
  require_version_2("a pause");
  edit("Change pause", drag, [&](YamlDocument& yaml) {
    std::vector<YamlEdit> edits;
    for (const std::size_t index : each_once(rows_, rows, source_name())) {
      const MotionRow& step = rows_.rows[index];
      const YamlNode& node = *find_node(yaml.tree(), step.path);
      if (node.find("pose") == nullptr) throw not_a_move(step, source_name());
      const YamlPath path = joined(step.path, {"pause_s"});
      if (pause_s != 0.0) {
        edits.push_back({YamlEdit::Kind::kSet, path, time_text(pause_s, step.line, source_name())});
      } else if (node.find("pause_s") != nullptr) {
        edits.push_back({YamlEdit::Kind::kErase, path, {}});
      }
    }
    yaml.edit(edits);
  });
}

void MotionDocument::set_interpolation(std::span<const std::size_t> rows,
                                       std::optional<motion::Interpolation> interpolation) {
  require_version_2("an interpolation");
  edit("Change interpolation", {}, [&](YamlDocument& yaml) {
    std::vector<YamlEdit> edits;
    for (const std::size_t index : each_once(rows_, rows, source_name())) {
      const MotionRow& step = rows_.rows[index];
      const YamlNode& node = *find_node(yaml.tree(), step.path);
      if (node.find("pose") == nullptr) throw not_a_move(step, source_name());
      const YamlPath path = joined(step.path, {"interpolation"});
      if (interpolation) {
        edits.push_back(
            {YamlEdit::Kind::kSet, path, kInterpolations.at(static_cast<std::size_t>(*interpolation))});
      } else if (node.find("interpolation") != nullptr) {
        edits.push_back({YamlEdit::Kind::kErase, path, {}});
      }
    }
    yaml.edit(edits);
  });
}

void MotionDocument::scale_time(std::span<const std::size_t> rows, double factor, std::string_view drag) {
  if (!(factor > 0.0))
    throw InputError(source_name(), 0, "a factor of " + koboshi::number_text(factor), "more than 0");
  edit("Scale time", drag, [&](YamlDocument& yaml) {
    std::vector<YamlEdit> edits;
    for (const std::size_t index : with_bodies(rows_, rows, source_name())) {
      const MotionRow& step = rows_.rows[index];
      const YamlNode& node = *find_node(yaml.tree(), step.path);
      for (const Steps& key : {time_key(node), Steps{"pause_s"}, Steps{"speed_deg_per_s"}}) {
        const YamlNode* value = key.empty() ? nullptr : find_node(node, YamlPath(key));
        const auto number = value != nullptr ? parse_number(value->scalar) : std::nullopt;
        if (!number) continue;
        edits.push_back({YamlEdit::Kind::kSet, joined(step.path, key),
                         key.front() == "speed_deg_per_s"
                             ? speed_text(*number / factor, step.line, source_name())
                             : time_text(*number * factor, step.line, source_name())});
      }
    }
    yaml.edit(edits);
  });
}

void MotionDocument::set_value(std::size_t index, const YamlPath& path, std::string_view value,
                               std::string_view drag) {
  const YamlPath place = joined(row(index).path, path.steps());
  edit("Change " + path.text(), drag, [&](YamlDocument& yaml) { yaml.set(place, value); });
}

void MotionDocument::erase_value(std::size_t index, const YamlPath& path) {
  const YamlPath place = joined(row(index).path, path.steps());
  edit("Remove " + path.text(), {}, [&](YamlDocument& yaml) { yaml.erase(place); });
}

void MotionDocument::reverse_rows(std::span<const std::size_t> rows) {
  const std::vector<YamlItems> runs = runs_of(rows_, rows, source_name());
  if (runs.size() != 1)
    throw InputError(source_name(), 0, "steps that do not follow each other", "moves and waits of one list");
  const YamlItems& run = runs.front();
  edit("Reverse order", {}, [&](YamlDocument& yaml) {
    std::vector<std::pair<YamlPath, YamlNode>> moves;
    for (std::size_t i = run.first; i < run.first + run.count; ++i) {
      const YamlPath path = joined(run.collection, {std::to_string(i)});
      const YamlNode& node = *find_node(yaml.tree(), path);
      const bool is_move = node.find("pose") != nullptr;
      if (!is_move && node.find("wait_s") == nullptr)
        throw InputError(source_name(), node.value_line, "a step of another kind", "moves and waits");
      if (is_move) moves.emplace_back(path, node);
    }
    // The first move of the new order comes from where the first one of the old order came from; each other
    // one takes the transition that it takes back.
    std::vector<YamlEdit> edits;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const auto& [path, node] = moves[i];
      const YamlNode& donor = moves[i + 1 < moves.size() ? i + 1 : 0].second;
      for (const char* key : kTimings) {
        const YamlNode* timing = donor.find(key);
        if (timing == nullptr) continue;
        set_timing(node, path, key, timing->scalar, edits);
        break;
      }
      const YamlNode* interpolation = donor.find("interpolation");
      const YamlPath place = joined(path, {"interpolation"});
      if (interpolation != nullptr)
        edits.push_back({YamlEdit::Kind::kSet, place, interpolation->scalar});
      else if (node.find("interpolation") != nullptr)
        edits.push_back({YamlEdit::Kind::kErase, place, {}});
    }
    yaml.edit(edits);
    std::string block;
    std::string before;
    for (std::size_t count = 1; count <= run.count; ++count) {
      // A comment between two steps stays with the second one.
      const std::string text = yaml.items_text(run.collection, run.first, count);
      block.insert(0, text.substr(before.size()));
      before = text;
    }
    yaml.replace_items(run, block);
  });
}

}  // namespace koboshi::studio
