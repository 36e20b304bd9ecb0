#include "tools/motion_check/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/text/user_units.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/motion/interpreter.h"
#include "tools/motion_check/balance.h"
#include "tools/motion_check/mix_report.h"
#include "tools/motion_check/sample.h"

namespace koboshi::tools {
namespace {

using simulation::Severity;

// Speeds of targets are those of poses in steps of 2^-14 turn, divided by the time of a step.
constexpr double kSpeedTolerance = 1.01;
constexpr double kHighTorque = 0.8;    // share of the torque from which a warning is due
constexpr double kYielding_m = 0.002;  // by which the servos of a chain of joints yield to a light contact
constexpr double kLeanRounding_rad = 6.3 / (1 << 16);  // of a declared lean in the image, 2^-16 turn
// Motions begin with a move from the pose in force: the other ones are written for a start near standing.
constexpr double kAtStanding_rad = 10.0 / kDegreesPerRad;

class Judge {
 public:
  Judge(const Trajectory& trajectory, const std::vector<TickState>& states,
        const std::vector<MixExtreme>& extremes, const sim_board::RobotDescription& robot,
        const CheckLimits& limits)
      : trajectory_(trajectory), states_(states), extremes_(extremes), robot_(robot), limits_(limits) {}

  PathReport run() {
    report_.duration_s = time_s(trajectory_.ticks() - 1);
    list_steps();
    name_late_steps();
    check_targets();
    check_torques();
    check_overlaps();
    judge_balance(trajectory_, states_, limits_, report_);
    judge_mixes(trajectory_, states_, extremes_, robot_, limits_, report_);
    name_declared_leans();
    check_fall_detector();
    check_end();
    name_cut();
    std::ranges::stable_sort(report_.findings, {}, &Finding::time_s);
    return std::move(report_);
  }

 private:
  static double time_s(std::size_t tick) { return static_cast<double>(tick) * kTick_s; }
  const std::string& joint_name(std::size_t joint) const { return robot_.joints[joint].name; }
  const std::string& link_name(std::size_t link) const { return robot_.links[link].name; }

  void add(std::string code, Severity severity, std::size_t tick, std::string found, std::string expected,
           std::string hint = {}) {
    report_.findings.push_back(finding_at(trajectory_, tick, std::move(code), severity, std::move(found),
                                          std::move(expected), std::move(hint)));
  }

  StepReport& step_report(std::size_t tick) {
    return report_.steps[report_of_step_[trajectory_.steps[tick]]];
  }

  void list_steps() {
    for (std::size_t tick = 1; tick < trajectory_.ticks(); ++tick) {
      const std::uint16_t step = trajectory_.steps[tick];
      if (step >= report_of_step_.size()) report_of_step_.resize(step + 1U, kNone);
      if (report_of_step_[step] == kNone) {
        report_of_step_[step] = report_.steps.size();
        report_.steps.push_back({.step = step, .start_s = time_s(tick - 1)});
      }
      StepReport& report = step_report(tick);
      report.duration_s += kTick_s;
      const TickState& state = states_[tick];
      if (!trajectory_.on_feet[tick]) continue;
      if (state.torque.share > report.torque.share) report.torque = state.torque;
      const double margin_m = state.margin().distance_m;
      if (margin_m < report.least_margin_m) {
        report.least_margin_m = margin_m;
        report.least_margin_s = time_s(tick);
      }
    }
  }

  // The worst tick of a quantity by step and joint, from which one finding is made.
  struct Worst {
    std::size_t tick = 0;
    double value = 0.0;
  };
  using WorstByJoint = std::map<std::pair<std::uint16_t, std::size_t>, Worst>;

  void keep_worst(WorstByJoint& worst, std::size_t tick, std::size_t joint, double value) const {
    Worst& kept = worst[{trajectory_.steps[tick], joint}];
    if (value > kept.value) kept = {tick, value};
  }

  void check_targets() {
    WorstByJoint speeds;
    WorstByJoint changes;
    for (std::size_t tick = 1; tick < trajectory_.ticks(); ++tick) {
      const auto before = trajectory_.row(tick - 1);
      const auto now = trajectory_.row(tick);
      StepReport& report = step_report(tick);
      for (std::size_t j = 0; j < trajectory_.joints; ++j) {
        const double change_rad = std::abs(now[j] - before[j]);
        const double share = change_rad / kTick_s / robot_.joints[j].max_speed_rad_per_s;
        if (share > report.speed.share) report.speed = {static_cast<std::uint8_t>(j), share};
        if (share > kSpeedTolerance) keep_worst(speeds, tick, j, share);
        if (change_rad > limits_.largest_cyclic_step_rad) keep_worst(changes, tick, j, change_rad);
      }
    }
    for (const auto& [key, worst] : speeds) {
      const double limit = robot_.joints[key.second].max_speed_rad_per_s * kDegreesPerRad;
      add("C001", Severity::kError, worst.tick,
          fmt::format("{} turning at {:.0f} deg/s", joint_name(key.second), worst.value * limit),
          fmt::format("at most {:.0f} deg/s", limit),
          fmt::format("Give the step {:.2f} times its time.", std::ceil(100.0 * worst.value) / 100.0));
    }
    for (const auto& [key, worst] : changes) {
      add("C002", Severity::kError, worst.tick,
          fmt::format("the target of {} changing by {:.1f} deg in one cycle", joint_name(key.second),
                      worst.value * kDegreesPerRad),
          fmt::format("at most {:.1f} deg, the drive's largest cyclic step (object 2001h)",
                      limits_.largest_cyclic_step_rad * kDegreesPerRad),
          "Give the step more time.");
    }
  }

  // Near the speed without load a motor has hardly any torque, so that the share says nothing but that.
  static bool has_torque(double share) { return share <= 10.0; }
  static std::string torque_text(double share) {
    if (!has_torque(share)) return " turning as fast as its servo turns without load at the lowest supply";
    return fmt::format(" taking {:.0f} % of its torque at the lowest supply", 100.0 * share);
  }

  void check_torques() {
    WorstByJoint worst;
    for (std::size_t tick = 1; tick < trajectory_.ticks(); ++tick) {
      const JointShare& torque = states_[tick].torque;
      if (torque.share > kHighTorque) keep_worst(worst, tick, torque.joint, torque.share);
    }
    for (const auto& [key, at] : worst) {
      const bool cannot = at.value > 1.0;
      add(cannot ? "C003" : "C004", cannot ? Severity::kError : Severity::kWarning, at.tick,
          joint_name(key.second) + torque_text(at.value),
          has_torque(at.value) ? fmt::format("at most {:.0f} %", 100.0 * (cannot ? 1.0 : kHighTorque))
                               : "a speed at which it has torque left",
          cannot ? "Bend the joint less, or move slower." : "");
    }
  }

  void check_overlaps() {
    std::map<std::pair<std::uint16_t, std::uint16_t>, Worst> worst;
    for (std::size_t tick = 0; tick < trajectory_.ticks(); ++tick) {
      const Overlap& overlap = states_[tick].overlap;
      if (overlap.depth_m <= kTouching_m) continue;
      Worst& kept = worst[{overlap.link, overlap.other_link}];
      if (overlap.depth_m > kept.value) kept = {tick, overlap.depth_m};
    }
    for (const auto& [links, at] : worst) {
      add("C005", at.value > kYielding_m ? Severity::kError : Severity::kWarning, at.tick,
          fmt::format("{} and {} overlapping by {:.1f} mm", link_name(links.first), link_name(links.second),
                      at.value * kMmPerM),
          "links apart from each other");
      report_.findings.back().links = {links.first, links.second};
    }
  }

  // Returns the part of a declared lean that the firmware accepts.
  double bounded(double lean_rad) const {
    return std::clamp(lean_rad, -limits_.max_declared_lean_rad, limits_.max_declared_lean_rad);
  }

  // The interpreter leaves to the next cycle what exceeds its work of one.
  void name_late_steps() {
    std::map<std::uint16_t, std::size_t> first;
    for (const std::size_t tick : trajectory_.late) first.emplace(trajectory_.steps[tick], tick);
    for (const auto& [step, tick] : first)
      add("C016", Severity::kWarning, tick,
          "more steps in one cycle of 10 ms than the firmware carries out: the rest is late",
          fmt::format("work of at most {}: {} for a step or a test, {} for a move, {} for a cubic one",
                      motion::Interpreter::kMaxWork, motion::Interpreter::kStepWork,
                      motion::Interpreter::kMoveWork, motion::Interpreter::kCubicWork));
  }

  // Names each use of a declared lean, from the tick in which it begins until it is back at zero.
  void name_declared_leans() {
    double largest_rad = 0.0;
    std::size_t first = 0;
    for (std::size_t tick = 0; tick < trajectory_.ticks(); ++tick) {
      const double lean_rad =
          std::max(std::abs(trajectory_.lean_pitch_rad[tick]), std::abs(trajectory_.lean_roll_rad[tick]));
      if (lean_rad > 0.0 && largest_rad == 0.0) first = tick;
      largest_rad = lean_rad > 0.0 ? std::max(largest_rad, lean_rad) : largest_rad;
      if (largest_rad == 0.0 || (lean_rad > 0.0 && tick + 1 < trajectory_.ticks())) continue;
      const bool beyond = largest_rad > limits_.max_declared_lean_rad + kLeanRounding_rad;
      add(beyond ? "C011" : "C010", beyond ? Severity::kWarning : Severity::kNote, first,
          fmt::format("a declared lean of {:.1f} deg", largest_rad * kDegreesPerRad),
          fmt::format("at most {:.1f} deg, the robot's parameter largest_declared_lean_deg",
                      limits_.max_declared_lean_rad * kDegreesPerRad),
          beyond ? "The firmware takes the part within the limit." : "");
      largest_rad = 0.0;
    }
  }

  // The firmware's own detector, with the attitude and the rates of the plan.
  void check_fall_detector() {
    behaviour::FallDetector detector;
    for (std::size_t tick = 1; tick < trajectory_.ticks(); ++tick) {
      if (!trajectory_.on_feet[tick] || !trajectory_.on_feet[tick - 1]) continue;
      const TickState& now = states_[tick];
      const TickState& before = states_[tick - 1];
      const auto rate = [](double difference_rad) {
        return fixed::from_double<fixed::AngularRate>(difference_rad / kTick_s);
      };
      const estimation::TrunkMotion trunk{
          .roll_rate = rate(now.roll_rad - before.roll_rad),
          .pitch_rate = rate(now.pitch_rad - before.pitch_rad),
          .roll = fixed::from_double<fixed::Angle>(now.roll_rad - bounded(trajectory_.lean_roll_rad[tick])),
          .pitch =
              fixed::from_double<fixed::Angle>(now.pitch_rad - bounded(trajectory_.lean_pitch_rad[tick]))};
      const behaviour::FallDirection direction = detector.update(limits_.fall, trunk);
      if (direction == behaviour::FallDirection::kNone) continue;
      constexpr std::array<const char*, 5> kDirections{"", "front", "back", "left", "right"};
      add("C009", Severity::kError, tick,
          fmt::format(
              "a fall to the {} by the fall detector, at a lean of {:.0f} deg forward and {:.0f} deg to "
              "the right",
              kDirections[static_cast<std::size_t>(direction)], states_[tick].pitch_rad * kDegreesPerRad,
              states_[tick].roll_rad * kDegreesPerRad),
          "a lean and a rate within its limits", "Lean less or more slowly, or declare the lean (`lean:`).");
      return;
    }
  }

  void check_end() {
    const bool ends = !trajectory_.failed && !trajectory_.merged && !trajectory_.cut;
    if (!ends || limits_.standing_rad.empty() || !trajectory_.on_feet.back()) return;
    const auto end = trajectory_.row(trajectory_.ticks() - 1);
    std::size_t farthest = 0;
    double distance_rad = 0.0;
    for (std::size_t j = 0; j < trajectory_.joints; ++j) {
      const double difference_rad = std::abs(end[j] - limits_.standing_rad[j]);
      if (difference_rad > distance_rad) {
        farthest = j;
        distance_rad = difference_rad;
      }
    }
    if (distance_rad <= kAtStanding_rad) return;
    add("C013", Severity::kWarning, trajectory_.ticks() - 1,
        fmt::format("an end with {} {:.0f} deg away from the standing pose", joint_name(farthest),
                    distance_rad * kDegreesPerRad),
        "the standing pose, from which motions begin");
  }

  void name_cut() {
    if (trajectory_.stop_tick > 0)
      add("C019", Severity::kNote, trajectory_.stop_tick,
          fmt::format("the motion still running after {:.0f} s", time_s(kStopTick)),
          "a shorter motion: from there on it is checked with a stop command");
    if (trajectory_.cut)
      add("C019", Severity::kNote, trajectory_.ticks() - 1 - kHoldTicks,
          fmt::format("the check cut after {:.0f} s", time_s(kMaxPathTicks)),
          "a shorter motion: its rest is not checked");
  }

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  const Trajectory& trajectory_;
  const std::vector<TickState>& states_;
  const std::vector<MixExtreme>& extremes_;
  const sim_board::RobotDescription& robot_;
  const CheckLimits& limits_;
  std::vector<std::size_t> report_of_step_;
  PathReport report_;
};

}  // namespace

Finding finding_at(const Trajectory& trajectory, std::size_t tick, std::string code, Severity severity,
                   std::string found, std::string expected, std::string hint) {
  return {.code = std::move(code),
          .severity = severity,
          .step = trajectory.steps[tick],
          .time_s = static_cast<double>(tick) * kTick_s,
          .found = std::move(found),
          .expected = std::move(expected),
          .hint = std::move(hint),
          .path = trajectory.path};
}

PathReport judge(const Trajectory& trajectory, const std::vector<TickState>& states,
                 const sim_board::RobotDescription& robot, const CheckLimits& limits,
                 const std::vector<MixExtreme>& extremes) {
  if (trajectory.ticks() == 0) return {};
  return Judge(trajectory, states, extremes, robot, limits).run();
}

}  // namespace koboshi::tools
