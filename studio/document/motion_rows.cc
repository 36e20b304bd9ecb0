#include "studio/document/motion_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/text/text.h"
#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "studio/document/step_text.h"

namespace koboshi::studio {
namespace {

using simulation::StepSource;
using Kind = StepSource::Kind;

constexpr double kSecondsPer_us = 1e-6;
// Peak speed over mean speed: linear, minimum jerk (Flash and Hogan 1985), a cubic from rest to rest, and a
// trapezoid.
constexpr std::array<double, 4> kPeakRatios{1.0, 15.0 / 8.0, 3.0 / 2.0, 3.0 / 2.0};

// Where the nominal path stands.
struct State {
  double time_s = 0.0;
  std::vector<double> angles_rad = {};
  std::uint32_t moved = 0;  // joints that the section has moved so far
};

// A section before all of them are joined: rows count from its own first one.
struct Section {
  const YamlNode* list = nullptr;
  MotionSection info = {};
  std::vector<MotionRow> rows = {};
  State end = {};
  bool is_begun = false;
};

class RowBuilder {
 public:
  RowBuilder(const YamlNode& tree, const simulation::MotionSource* source, const MotionRobot& robot)
      : tree_(tree), source_(source), robot_(robot) {
    if (source == nullptr) return;
    for (const simulation::PoseSource& pose : source->poses) poses_.emplace(pose.name, &pose);
    add_steps(source->steps);
    for (const simulation::RoutineSource& routine : source->routines) add_steps(routine.steps);
  }

  MotionRows build() {
    const YamlNode* steps = tree_.find("steps");
    sections_.push_back(
        {.list = steps, .info = {.name = {}, .path = "steps", .line = steps != nullptr ? steps->line : 0}});
    if (const YamlNode* routines = tree_.find("routines")) {
      for (const YamlNode& routine : routines->items) {
        if (routine.key.empty()) continue;
        const YamlPath path(std::vector<std::string>{"routines", routine.key});
        by_name_[routine.key] = sections_.size();
        sections_.push_back({.list = &routine, .info = {routine.key, path, routine.line}});
      }
    }
    for (std::size_t i = 0; i < sections_.size(); ++i) build_section(i);
    return joined();
  }

 private:
  void add_steps(const std::vector<StepSource>& steps) {
    for (const StepSource& step : steps) {
      sources_[{step.place.line, step.place.column}] = &step;
      add_steps(step.body);
      add_steps(step.otherwise);
    }
  }

  void build_section(std::size_t index) {
    Section& section = sections_[index];
    if (section.is_begun) return;
    section.is_begun = true;
    State state{.angles_rad = robot_.standing_rad};
    std::vector<std::string> path = section.info.path.steps();
    if (section.list != nullptr) add_list(section, *section.list, path, 0, std::nullopt, false, state);
    std::map<std::string, std::size_t> labels;
    for (std::size_t i = 0; i < section.rows.size(); ++i) {
      if (section.rows[i].kind == Kind::kLabel) labels.emplace(section.rows[i].label, i);
    }
    for (MotionRow& row : section.rows) {
      if (row.kind == Kind::kLabel || row.kind == Kind::kCall || row.label.empty()) continue;
      if (const auto found = labels.find(row.label); found != labels.end()) row.target = found->second;
    }
    section.info.duration_s = state.time_s;
    section.end = std::move(state);
  }

  void add_list(Section& section, const YamlNode& list, std::vector<std::string>& path, int depth,
                std::optional<std::size_t> parent, bool in_else, State& state) {
    for (std::size_t i = 0; list.kind == YamlNode::Kind::kList && i < list.items.size(); ++i) {
      path.push_back(std::to_string(i));
      const std::size_t index = section.rows.size();
      section.rows.push_back({.path = YamlPath(path), .depth = depth, .parent = parent});
      section.rows[index].in_else = in_else;
      section.rows[index].list_index = i;
      add_step(section, index, list.items[i], path, state);
      path.pop_back();
    }
  }

  void add_step(Section& section, std::size_t index, const YamlNode& node, std::vector<std::string>& path,
                State& state) {
    MotionRow& row = section.rows[index];
    row.line = node.value_line;
    row.start_s = state.time_s;
    const auto found = sources_.find({node.value_line, node.value_column});
    const StepSource* step = found == sources_.end() ? nullptr : found->second;
    describe_step(node, tree_.find("interpolation"), row);
    if (step != nullptr) describe(*step, row);
    if (row.kind == Kind::kMove) move(step, row, state);
    if (row.kind == Kind::kWait) state.time_s += row.time_s.value_or(0.0);
    if (row.kind == Kind::kCall) call(row, state);
    add_bodies(section, index, node, path, state);
    section.rows[index].duration_s = state.time_s - section.rows[index].start_s;
    section.rows[index].angles_rad = state.angles_rad;
  }

  // Describes a step that the compiler has understood.
  static void describe(const StepSource& step, MotionRow& row) {
    row.kind = step.kind;
    row.label = step.label;
    const bool has_time = step.kind == Kind::kWait || step.kind == Kind::kAwait ||
                          (step.kind == Kind::kMove && step.speed_raw == 0);
    if (has_time) row.time_s = step.time_us * kSecondsPer_us;
  }

  // The pose of a move; nullptr if it has errors.
  const simulation::PoseSource* pose_of(const StepSource* step, const MotionRow& row) const {
    if (step != nullptr) return &source_->poses.at(step->pose);
    if (source_ == nullptr || row.pose.empty() || row.mirrored) return nullptr;
    const auto found = poses_.find(row.pose);
    return found == poses_.end() ? nullptr : found->second;
  }

  void move(const StepSource* step, MotionRow& row, State& state) const {
    double most_deg = 0.0;
    double fastest_s = 0.0;  // with each joint at its speed limit
    const simulation::PoseSource* pose = pose_of(step, row);
    for (std::size_t joint = 0; pose != nullptr && joint < pose->angles.size(); ++joint) {
      if (!pose->angles[joint]) continue;
      const double angle_rad = fixed::to_double(*pose->angles[joint]);
      const double way_rad = std::abs(angle_rad - state.angles_rad[joint]);
      most_deg = std::max(most_deg, way_rad * kDegreesPerRad);
      const double limit_rad_per_s = fixed::to_double(robot_.model.model.joints[joint].max_speed);
      fastest_s = std::max(fastest_s, way_rad / limit_rad_per_s);
      state.angles_rad[joint] = angle_rad;
      row.moved |= 1U << joint;
    }
    state.moved |= row.moved;
    const double ratio = kPeakRatios.at(static_cast<std::size_t>(row.interpolation));
    state.time_s += row.speed_deg_per_s ? ratio * most_deg / *row.speed_deg_per_s
                    : row.at_least      ? std::max(row.time_s.value_or(0.0), ratio * fastest_s)
                                        : row.time_s.value_or(0.0);
    state.time_s += row.pause_s;
  }

  void call(const MotionRow& row, State& state) {
    const auto found = by_name_.find(row.label);
    if (found == by_name_.end()) return;
    build_section(found->second);
    const State& end = sections_[found->second].end;  // empty in a recursion, which is an error
    state.time_s += end.time_s;
    for (std::size_t joint = 0; joint < state.angles_rad.size(); ++joint) {
      if ((end.moved >> joint & 1U) != 0) state.angles_rad[joint] = end.angles_rad[joint];
    }
    state.moved |= end.moved;
  }

  void add_bodies(Section& section, std::size_t index, const YamlNode& node, std::vector<std::string>& path,
                  State& state) {
    const int depth = section.rows[index].depth + 1;
    const double start_s = state.time_s;
    const auto add = [&](const YamlNode& list, std::vector<std::string> steps, bool in_else, State& from) {
      const std::size_t length = path.size();
      path.insert(path.end(), steps.begin(), steps.end());
      add_list(section, list, path, depth, index, in_else, from);
      path.resize(length);
    };
    const YamlNode* loop = node.find("loop");
    if (const YamlNode* steps = loop == nullptr ? nullptr : loop->find("steps")) {
      add(*steps, {"loop", "steps"}, false, state);
      const int times = section.rows[index].times.value_or(1);
      state.time_s = start_s + (state.time_s - start_s) * times;
    }
    State otherwise = state;
    if (const YamlNode* then = node.find("then")) add(*then, {"then"}, false, state);
    if (const YamlNode* other = node.find("else")) add(*other, {"else"}, true, otherwise);
  }

  MotionRows joined() {
    MotionRows all;
    std::map<std::string, std::size_t> uses;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      Section& section = sections_[i];
      section.info.first_row = all.rows.size();
      section.info.row_count = section.rows.size();
      section.info.end_line = end_of(section.info.line);
      for (MotionRow& row : section.rows) {
        row.section = i;
        if (row.parent) *row.parent += section.info.first_row;
        if (row.target) *row.target += section.info.first_row;
        if (!row.pose.empty()) ++uses[row.pose];
        all.rows.push_back(std::move(row));
      }
      all.sections.push_back(section.info);
    }
    count_derived(tree_, uses);
    for (MotionRow& row : all.rows) {
      if (const auto found = uses.find(row.pose); !row.pose.empty()) row.pose_uses = found->second;
      const auto routine = row.kind == Kind::kCall ? by_name_.find(row.label) : by_name_.end();
      if (routine != by_name_.end() && all.sections[routine->second].row_count > 0)
        row.target = all.sections[routine->second].first_row;
    }
    return all;
  }

  // The line of the key after a section.
  int end_of(int line) const {
    int end = std::numeric_limits<int>::max();
    const auto look_at = [&](const YamlNode& map) {
      for (const YamlNode& item : map.items) {
        if (item.line > line) end = std::min(end, item.line);
      }
    };
    look_at(tree_);
    if (const YamlNode* routines = tree_.find("routines")) look_at(*routines);
    return end;
  }

  // Counts the poses that are derived from others, in the map of poses and in steps.
  void count_derived(const YamlNode& node, std::map<std::string, std::size_t>& uses) const {
    for (const YamlNode& item : node.items) {
      const bool refers = (item.key == "from" || item.key == "mirror") &&
                          item.kind == YamlNode::Kind::kScalar && node.find("time_s") == nullptr &&
                          node.find("speed_deg_per_s") == nullptr && node.find("at_least_s") == nullptr;
      if (refers) ++uses[item.scalar];
      count_derived(item, uses);
    }
  }

  const YamlNode& tree_;
  const simulation::MotionSource* source_;
  const MotionRobot& robot_;
  std::map<std::pair<int, int>, const StepSource*> sources_;  // by line and column
  std::map<std::string, const simulation::PoseSource*> poses_;
  std::vector<Section> sections_ = {};
  std::map<std::string, std::size_t> by_name_;  // sections of routines
};

}  // namespace

std::optional<std::size_t> MotionRows::find(const YamlPath& path) const {
  const auto found =
      std::ranges::find_if(rows, [&](const MotionRow& row) { return row.path.steps() == path.steps(); });
  if (found == rows.end()) return std::nullopt;
  return static_cast<std::size_t>(found - rows.begin());
}

std::optional<std::size_t> MotionRows::find_line(int line) const {
  for (const MotionSection& section : sections) {
    if (line < section.line || line >= section.end_line) continue;
    const auto begin = rows.begin() + static_cast<std::ptrdiff_t>(section.first_row);
    const auto end = begin + static_cast<std::ptrdiff_t>(section.row_count);
    const auto after =
        std::upper_bound(begin, end, line, [](int l, const MotionRow& row) { return l < row.line; });
    if (after != begin) return static_cast<std::size_t>(after - rows.begin()) - 1;
  }
  return std::nullopt;
}

MotionRows make_rows(const YamlNode& tree, const simulation::MotionSource* source,
                     std::span<const simulation::Diagnostic> diagnostics, const MotionRobot& robot) {
  MotionRows rows = RowBuilder(tree, source, robot).build();
  for (const simulation::Diagnostic& diagnostic : diagnostics) {
    if (diagnostic.severity != simulation::Severity::kError) continue;
    if (const auto row = rows.find_line(diagnostic.place.line)) rows.rows[*row].has_error = true;
  }
  return rows;
}

}  // namespace koboshi::studio
