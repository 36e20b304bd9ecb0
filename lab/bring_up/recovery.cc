#include "lab/bring_up/recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "lab/trial/fall_observer.h"
#include "lab/trial/getting_up.h"
#include "lab/tune/optimiser.h"
#include "sim_board/world/gravity.h"
#include "simulation/batch/parallel.h"
#include "simulation/observe/event_words.h"

namespace koboshi::lab {
namespace {

using behaviour::State;
using simulation::WatchedSimulation;

// --- Falls

constexpr double kPush_s = 0.1;
constexpr double kPushAt_s = 5.0;
constexpr double kFallEnds_s = 3.0;  // after the push
// Speed that the push gives, as a Froude number v / sqrt(g h): the capture point is then v / omega = 0.8 h in
// front of the feet, beyond the soles of any humanoid, and the fall is that of a robot that trips at a run.
constexpr double kFroude = 0.8;

struct Direction {
  const char* name;
  double x;
  double y;
};
constexpr std::array<Direction, 4> kDirections{
    {{"front", 1, 0}, {"back", -1, 0}, {"left", 0, 1}, {"right", 0, -1}}};

struct Fall {
  FallHistory history;
  State state = State::kBoot;
  std::string reason;
  std::string error;  // of the physics
};

Fall play_fall(const std::shared_ptr<const simulation::PreparedScenario>& prepared, std::uint64_t seed,
               const GoOn& go_on) {
  WatchedSimulation world(prepared, seed);
  FallObserver observer;
  Fall fall;
  const auto end_us = static_cast<std::uint64_t>(1e6 * (kPushAt_s + kFallEnds_s));
  try {
    while (world.now_us() < end_us && fall.history.attempts == 0) {
      if (!go_on()) throw Stopped();
      world.step(1);
      observer.observe(world.simulation(), world.recorder());
      fall.history = observer.history();
      if (world.recorder().telemetry().state == State::kFault) break;
    }
  } catch (const sim_board::WorldBlewUp& error) {
    fall.error = one_line(error.what());
  }
  fall.state = world.recorder().telemetry().state;
  fall.reason = simulation::name_of(world.recorder().telemetry().reason);
  return fall;
}

std::vector<Override> pushed(const TriedRobot& robot, const sim_board::RobotDescription& description,
                             const Direction& direction) {
  const double speed_m_per_s =
      kFroude * std::sqrt(sim_board::kGravity_m_per_s2 * robot.values().com_height_m);
  // The mean of a half sine is 2 / pi of its peak.
  const double peak_N = description.total_mass_kg() * speed_m_per_s * M_PI / (2.0 * kPush_s);
  return {
      {"commands", "[{at_s: 2, enable: true}]"},
      {"pushes", fmt::format("[{{at_s: {}, duration_s: {}, shape: half-sine, link: '{}', force_N: [{:.3f}, "
                             "{:.3f}, 0]}}]",
                             kPushAt_s, kPush_s, description.links.front().name, peak_N * direction.x,
                             peak_N * direction.y)}};
}

bool is_fall_motion(const std::filesystem::path& name) { return name.stem().string().starts_with("fall_"); }

std::vector<Fall> play_falls(const TriedRobot& robot, const PlayOptions& options, const Direction& direction,
                             const sim_board::RobotDescription& description) {
  const auto prepared = robot.prepare(options, pushed(robot, description, direction));
  std::vector<Fall> falls(options.seeds);
  simulation::for_each_parallel(options.seeds, options.jobs, [&](std::size_t i) {
    falls[i] = play_fall(prepared, options.first_seed + i, options.go_on);
  });
  return falls;
}

double mean_impact_m_per_s(const std::vector<Fall>& falls) {
  double sum = 0.0;
  for (const Fall& fall : falls) sum += fall.history.impact_m_per_s.value_or(0.0);
  return sum / static_cast<double>(falls.size());
}

// --- Getting up

constexpr double kGetUpAt_s = 3.0;
constexpr double kPatience_s = 30.0;      // for all attempts
constexpr double kFirstAttempt_s = 10.0;  // of a search
constexpr std::uint64_t kRiseSeed = 910'000;
constexpr std::size_t kRiseRobots = 2;

struct Rise {
  std::optional<double> stood_s;
  int attempts = 0;
  double uprightness = 0.0;       // at the end
  double best_uprightness = 0.0;  // at any time
  State state = State::kBoot;
  std::string reason;
};

Rise play_rise(const std::shared_ptr<const simulation::PreparedScenario>& prepared, std::uint64_t seed,
               double patience_s, const GoOn& go_on) {
  WatchedSimulation world(prepared, seed);
  GettingUp getting_up(prepared->scenario);
  Rise rise;
  bool stands = false;
  State last = State::kBoot;
  const auto end_us = static_cast<std::uint64_t>(1e6 * (kGetUpAt_s + patience_s));
  try {
    while (world.now_us() < end_us && !stands) {
      if (!go_on()) throw Stopped();
      world.step(10);
      stands = getting_up.observe(world.recorder().truth(), world.now_us());
      rise.best_uprightness = std::max(rise.best_uprightness, getting_up.uprightness());
      rise.state = world.recorder().telemetry().state;
      if (rise.state == State::kRighting && last == State::kFallen) ++rise.attempts;
      last = rise.state;
      if (rise.state == State::kFault) break;
    }
    rise.stood_s = stands ? getting_up.stood_s() : std::nullopt;
  } catch (const sim_board::WorldBlewUp& error) {
    rise.reason = one_line(error.what());
    return rise;
  }
  rise.uprightness = getting_up.uprightness();
  rise.reason = simulation::name_of(world.recorder().telemetry().reason);
  return rise;
}

std::vector<Rise> play_rises(const TriedRobot& robot, const PlayOptions& options, Lying lying,
                             std::optional<int> attempts, double patience_s) {
  std::vector<Override> overrides{
      {"commands", fmt::format("[{{at_s: {}, get_up: true}}]", kGetUpAt_s)},
      {"initial", fmt::format("{{attitude_deg: {{pitch: {}}}}}", lying == Lying::kProne ? 90 : -90)}};
  if (attempts) overrides.push_back({"parameters.attempts_to_get_up", std::to_string(*attempts)});
  const auto prepared = robot.prepare(options, std::move(overrides));
  std::vector<Rise> rises(options.seeds);
  simulation::for_each_parallel(options.seeds, options.jobs, [&](std::size_t i) {
    rises[i] = play_rise(prepared, options.first_seed + i, patience_s, options.go_on);
  });
  return rises;
}

std::size_t standing(const std::vector<Rise>& rises) {
  return static_cast<std::size_t>(
      std::ranges::count_if(rises, [](const Rise& rise) { return rise.stood_s.has_value(); }));
}

// 1 to 2 for a robot that stands, more the sooner; below that by how far it came.
double score_of(const std::vector<Rise>& rises) {
  double sum = 0.0;
  for (const Rise& rise : rises)
    sum += rise.stood_s ? 1.0 + 1.0 / (1.0 + *rise.stood_s / 4.0)
                        : 0.5 * (rise.best_uprightness + rise.uprightness);
  return sum / static_cast<double>(rises.size());
}

class RiseOptimisation {
 public:
  RiseOptimisation(const RiseSearch& search, const RecoveryMotion& start, const SearchEnd& end)
      : search_(search), start_(start), variables_(start.variables()), end_(end) {
    result_.log = "candidate";
    for (const std::string& engine : search_engines()) result_.log += "," + engine;
    for (const RecoveryMotion::Variable& variable : variables_)
      result_.log += fmt::format(",{}_{}", variable.role.empty() ? "time" : variable.role, variable.pose);
    result_.log += "\n";
  }

  SearchedMotion run(std::optional<std::size_t> candidates) {
    if (variables_.empty() || end_.is_reached(0)) return std::move(result_);
    const std::vector<double> middle(variables_.size(), 0.5);
    try {
      static_cast<void>(minimise([this](const std::vector<double>& x) { return -score(x); }, middle,
                                 {.evaluations = candidates.value_or(kMostCandidates),
                                  .population = kPopulation,
                                  .spread = 0.15,
                                  .seed = 1}));
    } catch (const Ended&) {
    }
    return std::move(result_);
  }

 private:
  class Ended {};  // leaves the optimiser
  static constexpr std::size_t kPopulation = 12;
  static constexpr std::size_t kMostCandidates = 2'000;

  double score(const std::vector<double>& x) {
    if (end_.is_reached(result_.candidates)) throw Ended();
    ++result_.candidates;
    const RecoveryMotion motion = start_.with(variables_, x);
    double worst = std::numeric_limits<double>::infinity();
    bool is_enough = true;
    result_.log += std::to_string(result_.candidates);
    try {
      const TriedRobot robot = search_.make(motion);
      PlayOptions play = search_.play;
      play.first_seed = kRiseSeed;
      play.seeds = kRiseRobots;
      for (const std::string& engine : search_engines()) {
        play.stepper = engine;
        const std::vector<Rise> rises = play_rises(robot, play, search_.lying, 1, kFirstAttempt_s);
        const double value = score_of(rises);
        worst = std::min(worst, value);
        is_enough = is_enough && standing(rises) == rises.size();
        result_.log += fmt::format(",{:.4f}", value);
      }
      // More robots than those of the search, which the optimiser knows by heart.
      is_enough = is_enough && search_.is_enough(robot);
    } catch (const InputError&) {  // of the compiler: a move that is too fast, say
      worst = -1.0;
      is_enough = false;
      for (std::size_t i = 0; i < search_engines().size(); ++i) result_.log += ",";
    }
    for (const double value : x) result_.log += fmt::format(",{:.4f}", value);
    result_.log += "\n";
    if (result_.candidates == 1) {
      best_ = worst;
    } else if (worst > best_ || is_enough) {
      best_ = worst;
      result_.motion = motion;
      search_.progress(fmt::format("candidate {}: {} rises with score {:.2f}",
                                   end_.count_text(result_.candidates), start_.name(), best_));
    }
    if (is_enough && result_.motion) throw Ended();
    return worst;
  }

  const RiseSearch& search_;
  const RecoveryMotion& start_;
  const std::vector<RecoveryMotion::Variable> variables_;
  const SearchEnd& end_;
  double best_ = 0.0;
  SearchedMotion result_;
};

Rung failed_rung(std::string cause) {
  return {.name = {}, .result = Rung::Result::kFailed, .figure = {}, .cause = std::move(cause)};
}

}  // namespace

Rung protect_falls(const TriedRobot& robot, const PlayOptions& options) {
  const sim_board::RobotDescription description = robot.prepare(options, {})->robot;
  RobotFiles others = robot.files();
  std::erase_if(others, [](const auto& file) { return is_fall_motion(file.first); });
  const TriedRobot unprotected = robot.with(std::move(others));
  double least_lead_s = std::numeric_limits<double>::infinity();
  double with_sum = 0.0;
  double without_sum = 0.0;
  for (const Direction& direction : kDirections) {
    const std::vector<Fall> falls = play_falls(robot, options, direction, description);
    for (const Fall& fall : falls) {
      const FallHistory& history = fall.history;
      const std::string to = fmt::format("pushed to the {}, ", direction.name);
      if (!fall.error.empty()) return failed_rung(to + fall.error);
      if (fall.state == State::kFault) return failed_rung(to + "the robot is in fault: " + fall.reason);
      if (!history.predicted_s) return failed_rung(to + "no fall is predicted");
      const double lead_s = history.touched_s.value_or(*history.predicted_s + 1.0) - *history.predicted_s;
      if (lead_s < 0.0)
        return failed_rung(to +
                           fmt::format("the fall is predicted {:.0f} ms after the impact", -1e3 * lead_s));
      least_lead_s = std::min(least_lead_s, lead_s);
    }
    with_sum += mean_impact_m_per_s(falls);
    without_sum += mean_impact_m_per_s(play_falls(unprotected, options, direction, description));
  }
  const auto count = static_cast<double>(kDirections.size());
  const std::string impacts =
      (with_sum > 0.0
           ? fmt::format("trunk and head meet the ground with {:.2f} m/s in the mean", with_sum / count)
           : std::string("neither trunk nor head meets the ground")) +
      fmt::format(", without the motions with {:.2f} m/s", without_sum / count);
  if (with_sum > without_sum) return failed_rung(impacts);
  return {.name = {},
          .result = Rung::Result::kReached,
          .figure = fmt::format("{} falls, each predicted at least {:.0f} ms before the impact; {}",
                                kDirections.size() * options.seeds, 1e3 * least_lead_s, impacts),
          .cause = {}};
}

Rung get_up(const TriedRobot& robot, const PlayOptions& options, Lying lying) {
  const std::vector<Rise> rises = play_rises(robot, options, lying, std::nullopt, kPatience_s);
  const std::size_t stand = standing(rises);
  if (stand < rises.size()) {
    const auto down = std::ranges::find_if(rises, [](const Rise& rise) { return !rise.stood_s; });
    return failed_rung(fmt::format("{} of {} robots stay down after {} attempts, {}: {}",
                                   rises.size() - stand, rises.size(), down->attempts,
                                   simulation::name_of(down->state), down->reason));
  }
  double sum_s = 0.0;
  for (const Rise& rise : rises) sum_s += *rise.stood_s;
  const auto at_once = std::ranges::count_if(rises, [](const Rise& rise) { return rise.attempts == 1; });
  return {
      .name = {},
      .result = Rung::Result::kReached,
      .figure = fmt::format("{0} of {0} robots stand, {1} at the first attempt, after {2:.1f} s in the mean",
                            rises.size(), at_once, sum_s / static_cast<double>(rises.size())),
      .cause = {}};
}

SearchedMotion search_rise(const RiseSearch& search, const RecoveryMotion& start,
                           std::optional<std::size_t> candidates, const SearchEnd& end) {
  return RiseOptimisation(search, start, end).run(candidates);
}

}  // namespace koboshi::lab
