#include "tools/motion_check/mix_report.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "base/text/user_units.h"
#include "simulation/motion_language/parse/parse_settings.h"
#include "tools/motion_check/balance.h"

namespace koboshi::tools {
namespace {

using simulation::Severity;

constexpr double kNotedClamp_rad = 0.1 / kDegreesPerRad;  // poses are rounded to 0.02 degrees

class MixJudge {
 public:
  MixJudge(const Trajectory& trajectory, const std::vector<TickState>& states,
           const std::vector<MixExtreme>& extremes, const sim_board::RobotDescription& robot,
           const CheckLimits& limits, PathReport& report)
      : trajectory_(trajectory),
        states_(states),
        extremes_(extremes),
        robot_(robot),
        limits_(limits),
        report_(report) {}

  void run() {
    name_clamps();
    name_overlaps();
    name_margins();
  }

 private:
  void add(std::string code, std::size_t tick, std::string found, std::string expected, std::string hint) {
    report_.findings.push_back(finding_at(trajectory_, tick, std::move(code), Severity::kWarning,
                                          std::move(found), std::move(expected), std::move(hint)));
  }

  void name_clamps() {
    for (const auto& [joint, clamp] : trajectory_.clamps) {
      if (clamp.excess_rad < kNotedClamp_rad) continue;
      add("C012", clamp.tick,
          fmt::format(
              "a mix that may be clamped from here on: its bound is up to {:.1f} deg beyond the limit of {}",
              clamp.excess_rad * kDegreesPerRad, robot_.joints[joint].name),
          "the pose and the mix's bound within the joint's limits",
          "Keep the pose away from the limit, or reduce limit_deg.");
    }
  }

  // The corrections of an extreme in words, such as "if the mixes of pitch_rate (-) reach their limit_deg".
  static std::string extreme_text(const MixExtreme& extreme, std::uint8_t signs) {
    std::string names;
    for (std::size_t source = 0; source < simulation::kMixSources.size(); ++source) {
      if ((extreme.sources >> source & 1U) == 0) continue;
      names += fmt::format("{}{} ({})", names.empty() ? "" : " and ", simulation::kMixSources[source],
                           (signs >> source & 1U) != 0 ? '+' : '-');
    }
    return fmt::format("if the mixes of {} reach their limit_deg", names);
  }

  // Overlaps that the path has without corrections are C005.
  void name_overlaps() {
    std::map<std::pair<std::uint16_t, std::uint16_t>, const MixExtreme*> worst;
    for (const MixExtreme& extreme : extremes_) {
      const Overlap& overlap = extreme.overlap;
      const Overlap& without = states_[extreme.tick].overlap;
      if (overlap.depth_m <= kTouching_m + without.depth_m) continue;
      const MixExtreme*& kept = worst[{overlap.link, overlap.other_link}];
      if (kept == nullptr || overlap.depth_m > kept->overlap.depth_m) kept = &extreme;
    }
    for (const auto& [links, extreme] : worst) {
      add("C020", extreme->tick,
          fmt::format("{} and {} overlapping by {:.1f} mm {}", robot_.links[links.first].name,
                      robot_.links[links.second].name, extreme->overlap.depth_m * kMmPerM,
                      extreme_text(*extreme, extreme->overlap_signs)),
          "links apart from each other at the mixes' bounds", "Reduce limit_deg, or keep the links apart.");
    }
  }

  // A step that leaves the polygon without corrections is C006.
  void name_margins() {
    std::map<std::uint16_t, const MixExtreme*> worst;
    for (const MixExtreme& extreme : extremes_) {
      if (!trajectory_.on_feet[extreme.tick] || extreme.com.distance_m >= -limits_.beyond_m) continue;
      if (states_[extreme.tick].margin().distance_m < -limits_.beyond_m) continue;
      const MixExtreme*& kept = worst[trajectory_.steps[extreme.tick]];
      if (kept == nullptr || extreme.com.distance_m < kept->com.distance_m) kept = &extreme;
    }
    for (const auto& [step, extreme] : worst) {
      add("C021", extreme->tick,
          fmt::format("the centre of mass {:.0f} mm outside the support polygon to the {} {}",
                      -extreme->com.distance_m * kMmPerM, direction_of(extreme->com.outward),
                      extreme_text(*extreme, extreme->com_signs)),
          "the centre of mass inside at the mixes' bounds", "Reduce limit_deg.");
    }
    if (!worst.empty() && report_.balance == Balance::kStable) report_.balance = Balance::kClose;
  }

  const Trajectory& trajectory_;
  const std::vector<TickState>& states_;
  const std::vector<MixExtreme>& extremes_;
  const sim_board::RobotDescription& robot_;
  const CheckLimits& limits_;
  PathReport& report_;
};

}  // namespace

void judge_mixes(const Trajectory& trajectory, const std::vector<TickState>& states,
                 const std::vector<MixExtreme>& extremes, const sim_board::RobotDescription& robot,
                 const CheckLimits& limits, PathReport& report) {
  MixJudge(trajectory, states, extremes, robot, limits, report).run();
}

}  // namespace koboshi::tools
