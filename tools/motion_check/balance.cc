#include "tools/motion_check/balance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text/user_units.h"
#include "tools/motion_check/sample.h"

namespace koboshi::tools {
namespace {

using simulation::Severity;

constexpr double kRoll_rad = 2.0 / kDegreesPerRad;  // a roll onto an edge that the targets do not intend
constexpr double kSuddenRoll_rad = 1.0 / kDegreesPerRad;  // in one tick: faster than targets turn a sole

std::string_view opposite_of(const Eigen::Vector2d& outward) { return direction_of(-outward); }

class BalanceJudge {
 public:
  BalanceJudge(const Trajectory& trajectory, const std::vector<TickState>& states, const CheckLimits& limits,
               PathReport& report)
      : trajectory_(trajectory), states_(states), limits_(limits), report_(report) {}

  // One finding per step in which the margin is small, at the least margin of the step.
  void run() {
    double least_landing_m = std::numeric_limits<double>::infinity();
    std::map<std::uint16_t, std::size_t> worst;
    std::map<std::uint16_t, std::size_t> rolls;
    std::vector<std::size_t> unjudged;
    for (std::size_t tick = 1; tick < trajectory_.ticks(); ++tick) {
      if (!trajectory_.on_feet[tick]) {
        unjudged.push_back(tick);
        continue;
      }
      const double margin_m = states_[tick].margin().distance_m;
      if (margin_m < report_.least_margin_m) {
        report_.least_margin_m = margin_m;
        report_.least_margin_s = time_s(tick);
      }
      least_landing_m = std::min(least_landing_m, landing_margin_m(tick));
      const auto [found, is_new] = worst.emplace(trajectory_.steps[tick], tick);
      if (!is_new && margin_m < states_[found->second].margin().distance_m) found->second = tick;
      if (states_[tick].tip_rad > kRoll_rad) {
        const auto [roll, first] = rolls.emplace(trajectory_.steps[tick], tick);
        if (!first && states_[tick].tip_rad > states_[roll->second].tip_rad) roll->second = tick;
      }
    }
    if (worst.empty()) return;
    report_.balance = report_.least_margin_m < -limits_.beyond_m ? Balance::kUnstable
                      : report_.least_margin_m < limits_.close_m ? Balance::kClose
                                                                 : Balance::kStable;
    // Only a bound of a roll's speed is known: a roll alone does not make a motion unstable.
    if (least_landing_m < limits_.close_m && report_.balance == Balance::kStable)
      report_.balance = Balance::kClose;
    for (const auto& [step, tick] : worst) add_margin(step, tick);
    if (!unjudged.empty() && !trajectory_.cut)
      add("C022", Severity::kNote, unjudged.front(),
          fmt::format("a balance that is not judged for {:.2f} s",
                      kTick_s * static_cast<double>(unjudged.size())),
          "an attitude about upright (`expect`) where the robot stands");
    for (const auto& [step, tick] : rolls) {
      if (!states_[tick].rests) continue;
      add("C008", Severity::kWarning, tick,
          fmt::format("the robot rolling by {:.0f} deg onto another edge of its soles",
                      states_[tick].tip_rad * kDegreesPerRad),
          "soles in one plane, or the centre of mass above the lower one");
    }
  }

 private:
  // Returns the margin with which the robot lands after a roll that begins in this tick; infinite without
  // one. The drop of the centre of mass gives it at most the speed v = sqrt(2 g drop), which moves its
  // capture point v sqrt(h / g) = sqrt(2 h drop) ahead (Pratt, Carff, Drakunov and Goswami 2006). The energy
  // that the impact takes is left out.
  double landing_margin_m(std::size_t tick) const {
    const TickState& before = states_[tick - 1];
    const TickState& now = states_[tick];
    if (std::abs(now.tip_rad - before.tip_rad) <= kSuddenRoll_rad)
      return std::numeric_limits<double>::infinity();
    const double drop_m = std::max(before.drop_m, now.drop_m);
    return now.com.distance_m - std::sqrt(2.0 * now.com_height_m * drop_m);
  }

  void add_margin(std::uint16_t step, std::size_t tick) {
    const TickState& state = states_[tick];
    const bool is_com = state.com.distance_m <= state.zmp.distance_m;
    const Margin& margin = state.margin();
    if (margin.distance_m >= limits_.close_m) return;
    const char* const point = is_com ? "centre of mass" : "ZMP";
    const std::string_view side = direction_of(margin.outward);
    const std::string expected = fmt::format("at least {:.0f} mm inside", limits_.close_m * kMmPerM);
    if (margin.distance_m >= -limits_.beyond_m) {
      add("C007", Severity::kWarning, tick,
          fmt::format("the {} {:.1f} mm {} the {} edge of the support polygon", point,
                      std::abs(margin.distance_m) * kMmPerM, margin.distance_m < 0.0 ? "beyond" : "inside",
                      side),
          expected, repair_of(tick));
      return;
    }
    std::size_t first = tick;
    while (first > 1 && trajectory_.steps[first - 1] == step && trajectory_.on_feet[first - 1] &&
           states_[first - 1].margin().distance_m < 0.0)
      --first;
    add("C006", Severity::kError, tick,
        fmt::format("the {} {:.0f} mm outside the support polygon to the {} (outside from {:.2f} s on)",
                    point, -margin.distance_m * kMmPerM, side, time_s(first)),
        expected, repair_of(tick));
  }

  // Either the pose is out of balance, or its accelerations are: their part of the ZMP falls with the square
  // of the time.
  std::string repair_of(std::size_t tick) const {
    const TickState& state = states_[tick];
    const double static_m = state.com.distance_m;
    const double dynamic_m = state.zmp.distance_m;
    if (static_m > 2.0 * limits_.close_m && dynamic_m < static_m) {
      const double factor = std::sqrt((static_m - dynamic_m) / (static_m - limits_.close_m));
      if (factor > 1.0)
        return fmt::format("Give the step {:.1f} times its time{}.", std::ceil(10.0 * factor) / 10.0,
                           moves_linearly(tick) ? ", or use minimum_jerk" : "");
    }
    return fmt::format("Move the centre of mass {:.0f} mm to the {}.",
                       std::ceil((limits_.close_m - static_m) * kMmPerM), opposite_of(state.com.outward));
  }

  // Whether the step of this tick begins with the speed of its second tick.
  bool moves_linearly(std::size_t tick) const {
    std::size_t first = tick;
    while (first > 1 && trajectory_.steps[first - 1] == trajectory_.steps[tick]) --first;
    if (first + 1 >= trajectory_.ticks()) return false;
    for (std::size_t j = 0; j < trajectory_.joints; ++j) {
      const double change_rad = trajectory_.row(first)[j] - trajectory_.row(first - 1)[j];
      const double next_rad = trajectory_.row(first + 1)[j] - trajectory_.row(first)[j];
      if (std::abs(next_rad - change_rad) > 1e-6) return false;
    }
    return true;
  }

  void add(std::string code, Severity severity, std::size_t tick, std::string found, std::string expected,
           std::string hint = {}) {
    report_.findings.push_back(finding_at(trajectory_, tick, std::move(code), severity, std::move(found),
                                          std::move(expected), std::move(hint)));
  }
  static double time_s(std::size_t tick) { return static_cast<double>(tick) * kTick_s; }

  const Trajectory& trajectory_;
  const std::vector<TickState>& states_;
  const CheckLimits& limits_;
  PathReport& report_;
};

}  // namespace

std::string_view direction_of(const Eigen::Vector2d& outward) {
  if (std::abs(outward.x()) >= std::abs(outward.y())) return outward.x() > 0.0 ? "front" : "back";
  return outward.y() > 0.0 ? "left" : "right";
}

void judge_balance(const Trajectory& trajectory, const std::vector<TickState>& states,
                   const CheckLimits& limits, PathReport& report) {
  BalanceJudge(trajectory, states, limits, report).run();
}

}  // namespace koboshi::tools
