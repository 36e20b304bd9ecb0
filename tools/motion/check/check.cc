#include "tools/motion/check/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "firmware/fixed/host/convert.h"
#include "firmware/motion/motion.h"
#include "sim_board/drive/drive_dictionary.h"
#include "sim_board/robot/load.h"
#include "sim_board/scenario/reader.h"
#include "sim_board/servo/position_unit.h"
#include "simulation/motion/compile.h"
#include "simulation/motion/parse.h"
#include "simulation/scenario/parameters.h"

namespace koboshi::tools {
namespace {

using simulation::Severity;
using simulation::StepSource;
using Kind = StepSource::Kind;

constexpr double kVPerMv = 1e-3;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string step_text(const motion::Step& step, const simulation::CompiledMotion& compiled) {
  using enum motion::Opcode;
  switch (step.opcode) {
    case kMove: {
      const std::string& name = compiled.pose_names.at(step.operand);
      return name.empty() ? "pose of the step" : "pose " + name;
    }
    case kWait:
      return "wait";
    case kLoopBegin:
      return "loop";
    case kLoopEnd:
      return "end of loop";
    case kJump:
      return "jump";
    case kExpect:
      return "expect";
    case kTest:
      return "test";
    case kBranch:
      return "branch";
    case kAwait:
      return "wait until";
    case kSet:
      return "set";
    case kCall:
      return "call";
    case kReturn:
      return "return";
    case kFail:
      return "fail";
    case kMix:
    case kMixClear:
      return "mix";
    case kStiffness:
      return "stiffness";
    case kLean:
      return "lean";
    case kEnd:
      break;
  }
  return "end";
}

// The place of each step of the image.
std::vector<StepPlace> places_of(const simulation::CompiledMotion& compiled,
                                 const simulation::NamedModel& model) {
  std::vector<StepPlace> places;
  motion::Motion motion;
  if (!motion::Motion::open(compiled.image, model.model, motion).ok()) return places;
  for (std::size_t i = 0; i < motion.step_count(); ++i) {
    const simulation::Place& place = compiled.step_places.at(i);
    places.push_back({place.line, place.column, step_text(motion.step(i), compiled)});
  }
  return places;
}

struct Names {
  std::set<std::size_t> poses;
  std::set<std::string> targets;
  std::vector<std::pair<std::string, simulation::Place>> labels;
};

void collect(const std::vector<StepSource>& steps, Names& names) {
  for (const StepSource& step : steps) {
    if (step.kind == Kind::kMove) names.poses.insert(step.pose);
    if (step.kind == Kind::kJump || step.kind == Kind::kAwait) names.targets.insert(step.label);
    if (step.kind == Kind::kLabel) names.labels.emplace_back(step.label, step.place);
    collect(step.body, names);
    collect(step.otherwise, names);
  }
}

std::vector<simulation::Diagnostic> unused_names(const simulation::MotionSource& motion) {
  Names names;
  collect(motion.steps, names);
  for (const simulation::RoutineSource& routine : motion.routines) collect(routine.steps, names);
  names.targets.insert(motion.exit);
  std::vector<simulation::Diagnostic> diagnostics;
  const auto add = [&](const std::string& what, const simulation::Place& place) {
    diagnostics.push_back({.code = "C017",
                           .severity = Severity::kWarning,
                           .place = place,
                           .found = what,
                           .expected = "a step that uses it"});
  };
  for (std::size_t pose = 0; pose < motion.poses.size(); ++pose) {
    if (!names.poses.contains(pose) && !motion.poses[pose].is_base)
      add("the unused pose '" + motion.poses[pose].name + "'", motion.poses[pose].place);
  }
  for (const auto& [label, place] : names.labels) {
    if (!names.targets.contains(label)) add("the unused label '" + label + "'", place);
  }
  return diagnostics;
}

std::vector<double> standing_pose(const std::filesystem::path& robot_file,
                                  const simulation::NamedModel& model) {
  const std::filesystem::path stand = robot_file.parent_path() / "motions" / "stand.yaml";
  if (!std::filesystem::exists(stand)) return {};
  const std::vector<std::byte> image = simulation::compile_motion(stand, model);
  const std::vector<double> zero(model.model.joint_count, 0.0);
  const Trajectory trajectory = sample_motion(image, model, zero).paths.front();
  const auto end = trajectory.row(trajectory.ticks() - 1);
  return {end.begin(), end.end()};
}

// The joints that move on some path, by name.
std::vector<std::string> claimed_joints(std::span<const std::byte> image,
                                        const simulation::NamedModel& model) {
  motion::Motion motion;
  std::uint32_t mask = 0;
  if (motion::Motion::open(image, model.model, motion).ok()) {
    for (std::size_t pose = 0; pose < motion.pose_count(); ++pose) mask |= motion.joint_mask(pose);
  }
  std::vector<std::string> names;
  for (std::size_t j = 0; j < model.joint_names.size(); ++j) {
    if ((mask >> j & 1U) != 0) names.push_back(model.joint_names[j]);
  }
  return names;
}

}  // namespace

bool MotionReport::has_errors() const {
  return std::ranges::any_of(diagnostics, [](const simulation::Diagnostic& diagnostic) {
    return diagnostic.severity == Severity::kError;
  });
}

MotionChecker::MotionChecker(const std::filesystem::path& robot_file)
    : robot_(std::make_shared<const sim::RobotDescription>(sim::load_robot(robot_file))),
      model_(simulation::load_named_model(*robot_)) {
  const app::ControllerValues values = simulation::controller_values(sim::read_robot_parameters(robot_file));
  limits_.fall = values.recovery.fall;
  limits_.max_declared_lean_rad = 2.0 * std::numbers::pi * values.recovery.max_declared_lean / (1 << 16);
  limits_.largest_cyclic_step_rad = sim::kDefaultCyclicStep * sim::kRadPerPositionUnit;
  limits_.standing_rad = standing_pose(robot_file, model_);
  supply_.nominal_V =
      robot_->battery ? robot_->battery->open_circuit_V : robot_->joints.front().servo.supply_V;
  supply_.lowest_V =
      values.parameters.supply_min_mV > 0 ? kVPerMv * values.parameters.supply_min_mV : supply_.nominal_V;
}

CompiledMotion MotionChecker::compile(const std::filesystem::path& file) const {
  const simulation::MotionSource source = simulation::parse_motion(file, model_);
  CompiledMotion compiled{.file = file, .text = text_of(file), .name = source.name};
  simulation::Diagnostics diagnostics(file, compiled.text);
  simulation::CompiledMotion image = simulation::compile_motion(source, model_, diagnostics);
  diagnostics.throw_errors();
  compiled.places = places_of(image, model_);
  compiled.image = std::move(image.image);
  compiled.unused = unused_names(source);
  return compiled;
}

MotionReport MotionChecker::check(const CompiledMotion& motion) {
  std::vector<double> from = limits_.standing_rad;
  from.resize(robot_->joints.size(), 0.0);
  SampledPaths sampled = sample_motion(motion.image, model_, from);
  while (analyses_.size() < sampled.paths.size()) analyses_.emplace_back(*robot_, supply_);
  MotionReport report{.file = motion.file, .name = motion.name, .places = motion.places};
  report.joints = claimed_joints(motion.image, model_);
  report.endless = sampled.endless;
  report.cut = sampled.cut;
  simulation::Diagnostics diagnostics(motion.file, motion.text);
  const auto place_of = [&](std::uint16_t step) {
    const StepPlace place = step < report.places.size() ? report.places[step] : StepPlace{};
    return simulation::Place{.line = place.line, .column = place.column};
  };
  std::vector<simulation::Diagnostic> found;
  for (std::size_t path = 0; path < sampled.paths.size(); ++path) {
    const std::vector<TickState>& states = analyses_[path].analyse(sampled.paths[path]);
    PathReport judged = judge(sampled.paths[path], states, *robot_, limits_);
    if (path == 0) states_ = states;
    for (const Finding& finding : judged.findings) {
      std::string at = fmt::format(" at {:.2f} s", finding.time_s);
      if (!finding.path.empty()) at += " (" + finding.path + ")";
      found.push_back({.code = finding.code,
                       .severity = finding.severity,
                       .place = place_of(finding.step),
                       .found = finding.found + at,
                       .expected = finding.expected,
                       .hint = finding.hint});
    }
    report.duration_s = std::max(report.duration_s, judged.duration_s);
    if (judged.balance != Balance::kNotJudged &&
        (report.balance == Balance::kNotJudged || judged.least_margin_m < report.least_margin_m)) {
      report.balance = judged.balance;
      report.least_margin_m = judged.least_margin_m;
      report.least_margin_s = judged.least_margin_s;
      const auto tick = static_cast<std::size_t>(std::lround(judged.least_margin_s / kTick_s));
      report.least_margin_step = sampled.paths[path].steps[tick];
    }
    report.paths.push_back(std::move(judged));
  }
  found.insert(found.end(), motion.unused.begin(), motion.unused.end());
  std::ranges::stable_sort(found, {}, [](const simulation::Diagnostic& d) { return d.place.line; });
  // Diagnostics drops a second error at one place, so that the quotes come from it one by one.
  for (simulation::Diagnostic& diagnostic : found) {
    simulation::Diagnostics one(motion.file, motion.text);
    one.add(std::move(diagnostic));
    report.diagnostics.push_back(one.all().front());
  }
  trajectory_ = std::move(sampled.paths.front());
  return report;
}

}  // namespace koboshi::tools
