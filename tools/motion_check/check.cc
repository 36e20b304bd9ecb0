#include "tools/motion_check/check.h"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/fixed/host/convert.h"
#include "firmware/motion/motion.h"
#include "sim_board/description/load.h"
#include "sim_board/drive/drive_dictionary.h"
#include "sim_board/servo/position_unit.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/scenario/reader.h"
#include "tools/motion_check/unused.h"

namespace koboshi::tools {
namespace {

using simulation::Severity;

constexpr double kVPerMv = 1e-3;

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
    case kGain:
      return "gain";
    case kWindow:
      return "part of a move";
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

// The joints that the motion claims, by name.
std::vector<std::string> claimed_joints(std::span<const std::byte> image,
                                        const simulation::NamedModel& model) {
  motion::Motion motion;
  std::vector<std::string> names;
  if (!motion::Motion::open(image, model.model, motion).ok()) return names;
  for (std::size_t j = 0; j < model.joint_names.size(); ++j) {
    if ((motion.claimed_joints() >> j & 1U) != 0) names.push_back(model.joint_names[j]);
  }
  return names;
}

// The supply from the robot's battery, or the servos' own.
Supply supply_of(const sim_board::RobotDescription& robot, const app::ControllerValues& values) {
  Supply supply;
  supply.nominal_V = robot.battery ? robot.battery->open_circuit_V : robot.joints.front().servo.supply_V;
  const std::uint32_t lowest_mV = values.parameters.supply_min_mV;
  supply.lowest_V = lowest_mV > 0 ? kVPerMv * lowest_mV : supply.nominal_V;
  return supply;
}

// A path in words, such as "the other outcome of the condition of line 12".
std::string path_text(const Trajectory& path, const motion::Motion& motion,
                      const std::vector<StepPlace>& places) {
  if (!path.outcome) return "";
  const auto [step, holds] = *path.outcome;
  const int line = step < places.size() ? places[step].line : 0;
  if (motion.opcode(step) == motion::Opcode::kAwait)
    return fmt::format("the wait of line {} {}", line, holds ? "over at once" : "timed out");
  return fmt::format("the other outcome of the condition of line {}", line);
}

}  // namespace

bool MotionReport::has_errors() const {
  return std::ranges::any_of(diagnostics, [](const simulation::Diagnostic& diagnostic) {
    return diagnostic.severity == Severity::kError;
  });
}

MotionChecker::MotionChecker(const std::filesystem::path& robot_file)
    : MotionChecker(robot_file,
                    simulation::controller_values(simulation::read_robot_parameters(robot_file))) {}

MotionChecker::MotionChecker(const std::filesystem::path& robot_file, const app::ControllerValues& values)
    : robot_(std::make_shared<const sim_board::RobotDescription>(sim_board::load_robot(robot_file))),
      model_(simulation::load_named_model(*robot_)),
      analysis_(*robot_, supply_of(*robot_, values)) {
  limits_.fall = values.recovery.fall;
  limits_.max_declared_lean_rad = 2.0 * std::numbers::pi * values.recovery.max_declared_lean / (1 << 16);
  limits_.largest_cyclic_step_rad = sim_board::kDefaultCyclicStep * sim_board::kRadPerPositionUnit;
  limits_.standing_rad = standing_pose(robot_file, model_);
}

CompiledMotion MotionChecker::compile(const std::filesystem::path& file) const {
  return compile(simulation::read_motion_file(file));
}

CompiledMotion MotionChecker::compile(const simulation::MotionFile& motion) const {
  simulation::Diagnostics diagnostics(motion.path, motion.text);
  const simulation::MotionSource source = simulation::parse_motion(motion, model_, diagnostics);
  diagnostics.throw_errors();
  CompiledMotion compiled{.file = motion.path, .text = motion.text, .name = source.name};
  simulation::CompiledMotion image = simulation::compile_motion(source, model_, diagnostics);
  diagnostics.throw_errors();
  compiled.places = places_of(image, model_);
  motion::Motion opened;
  if (motion::Motion::open(image.image, model_.model, opened).ok())
    compiled.unused = find_unused(source, image, opened);
  compiled.image = std::move(image.image);
  return compiled;
}

MotionReport MotionChecker::check(const CompiledMotion& motion) {
  return std::move(*check(motion, std::stop_token()));
}

std::optional<MotionReport> MotionChecker::check(const CompiledMotion& motion,
                                                 const std::stop_token& cancel) {
  std::vector<double> from = limits_.standing_rad;
  from.resize(robot_->joints.size(), 0.0);
  SampledPaths sampled = sample_motion(motion.image, model_, from, cancel);
  if (cancel.stop_requested()) return std::nullopt;
  MotionReport report{.file = motion.file, .name = motion.name, .places = motion.places};
  report.joints = claimed_joints(motion.image, model_);
  report.endless = sampled.endless;
  report.cut = sampled.cut;
  report.duration_s = sampled.longest_s;
  motion::Motion opened;
  static_cast<void>(motion::Motion::open(motion.image, model_.model, opened));
  // The robot sits at the end of this one, on its feet, and no other motion begins there.
  CheckLimits limits = limits_;
  if (motion.name == motion::kMotionNames[static_cast<std::size_t>(motion::Role::kSit)])
    limits.standing_rad.clear();
  for (Trajectory& path : sampled.paths) {
    path.path = path_text(path, opened, motion.places);
    report.duration_cut = report.duration_cut || path.cut;
    const std::vector<TickState>& states = analysis_.analyse(path, cancel);
    if (cancel.stop_requested()) return std::nullopt;
    if (&path == &sampled.paths.front()) states_ = states;
    add_path(judge(path, states, *robot_, limits, analysis_.mix_extremes()), path, report);
  }
  analysis_.forget_unused();
  add_diagnostics(motion, report);
  trajectory_ = std::move(sampled.paths.front());
  return report;
}

void MotionChecker::add_path(PathReport path, const Trajectory& trajectory, MotionReport& report) const {
  const auto known = [&](const Finding& finding) {
    return std::ranges::any_of(report.paths, [&](const PathReport& other) {
      return std::ranges::any_of(other.findings, [&](const Finding& seen) {
        return seen.code == finding.code && seen.step == finding.step && seen.found == finding.found;
      });
    });
  };
  std::erase_if(path.findings, known);
  if (path.balance != Balance::kNotJudged) {
    const bool first = report.balance == Balance::kNotJudged;
    report.balance = std::max(report.balance, path.balance);
    if (first || path.least_margin_m < report.least_margin_m) {
      report.least_margin_m = path.least_margin_m;
      report.least_margin_s = path.least_margin_s;
      const auto tick = static_cast<std::size_t>(std::lround(path.least_margin_s / kTick_s));
      report.least_margin_step = trajectory.steps[tick];
    }
  }
  report.paths.push_back(std::move(path));
}

void MotionChecker::add_diagnostics(const CompiledMotion& motion, MotionReport& report) const {
  std::vector<simulation::Diagnostic> found = motion.unused;
  for (const PathReport& path : report.paths) {
    for (const Finding& finding : path.findings) {
      std::string at = fmt::format(" at {:.2f} s", finding.time_s);
      if (!finding.path.empty()) at += " (" + finding.path + ")";
      const StepPlace place = finding.step < report.places.size() ? report.places[finding.step] : StepPlace{};
      found.push_back({.code = finding.code,
                       .severity = finding.severity,
                       .place = {.line = place.line, .column = place.column},
                       .found = finding.found + at,
                       .expected = finding.expected,
                       .hint = finding.hint});
    }
  }
  if (report.cut)
    found.push_back({.code = "C018",
                     .severity = Severity::kNote,
                     .found = fmt::format("more than {} paths through conditions on sensors", kMaxPaths),
                     .expected = "few enough that all of them are checked"});
  std::ranges::stable_sort(found, {}, [](const simulation::Diagnostic& d) { return d.place.line; });
  // Diagnostics drops a second error at one place, so that the quotes come from it one by one.
  for (simulation::Diagnostic& diagnostic : found) {
    simulation::Diagnostics one(motion.file, motion.text);
    one.add(std::move(diagnostic));
    report.diagnostics.push_back(one.all().front());
  }
}

}  // namespace koboshi::tools
