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
constexpr double kNearlyUpright = 0.85;   // GettingUp::uprightness()
constexpr std::uint64_t kRiseSeed = 910'000;
constexpr std::size_t kRiseRobots = 2;
constexpr std::size_t kFurtherRobots = 10;  // played where all of those stand

struct Rise {
  std::optional<double> stood_s;
  int attempts = 0;
  double best_uprightness = 0.0;  // at any time
  double up_s = 0.0;              // time during which it was nearly upright
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
      if (getting_up.uprightness() > kNearlyUpright) rise.up_s += 0.01;  // a tick
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

// 1 to 2 for a robot that stands, more the sooner; below that by how far it came, and for how long it stayed
// there: most fall again, and how they then lie says nothing.
double score_of(const std::vector<Rise>& rises) {
  constexpr double kStays_s = 2.0;
  double sum = 0.0;
  for (const Rise& rise : rises)
    sum += rise.stood_s ? 1.0 + 1.0 / (1.0 + *rise.stood_s / 4.0)
                        : 0.6 * rise.best_uprightness + 0.4 * std::min(1.0, rise.up_s / kStays_s);
  return sum / static_cast<double>(rises.size());
}

class RiseOptimisation {
 public:
  RiseOptimisation(const RiseSearch& search, const SearchEnd& end) : search_(search), end_(end) {}

  SearchedMotion run(const std::vector<RecoveryMotion>& starts, std::optional<std::size_t> candidates) {
    try {
      const RecoveryMotion* best = nullptr;
      double best_score = -std::numeric_limits<double>::infinity();
      for (const RecoveryMotion& start : starts) {
        const double value = score(start, {});
        if (value <= best_score) continue;
        best = &start;
        best_score = value;
      }
      if (best != nullptr) improve(*best, best_score, candidates);
    } catch (const Ended&) {
    }
    std::string head = "candidate";
    for (const std::string& engine : search_engines()) head += "," + engine;
    head += ",share,errors";
    for (const RecoveryMotion::Variable& variable : variables_)
      head += fmt::format(",{}_{}", variable.role.empty() ? "time" : variable.role, variable.pose);
    result_.log = head + "\n" + result_.log;
    return std::move(result_);
  }

 private:
  class Ended {};  // leaves the optimiser
  static constexpr std::size_t kPopulation = 12;
  static constexpr std::size_t kMostCandidates = 5'000;
  static constexpr std::size_t kShowEvery = 20;

  void improve(const RecoveryMotion& start, double start_score, std::optional<std::size_t> candidates) {
    variables_ = start.variables();
    if (variables_.empty()) return;
    const std::size_t known = result_.candidates;
    const std::vector<double> middle(variables_.size(), 0.5);
    const std::size_t most = candidates.value_or(kMostCandidates);
    if (most <= known) return;
    static_cast<void>(minimise(
        [&](const std::vector<double>& x) {
          return -(x == middle ? start_score : score(start.with(variables_, x), x));
        },
        middle, {.evaluations = most - known + 1, .population = kPopulation, .spread = 0.15, .seed = 1}));
  }

  // How the robots of a candidate rise.
  struct Rises {
    std::vector<std::optional<double>> scores;  // by engine; nothing: not played
    double worst = std::numeric_limits<double>::infinity();
    double share = 0.0;  // of the further robots that stand, in the engine in which fewest do
  };

  Rises play(const TriedRobot& robot) const {
    Rises rises;
    bool all_stand = true;
    PlayOptions play = search_.play;
    play.first_seed = kRiseSeed;
    play.seeds = kRiseRobots;
    for (const std::string& engine : search_engines()) {
      // An engine that likes a candidate much less than the best one has decided.
      if (rises.worst < best_of_search_ - kHopeless) {
        rises.scores.emplace_back();
        all_stand = false;
        continue;
      }
      play.stepper = engine;
      const std::vector<Rise> played = play_rises(robot, play, search_.lying, 1, kFirstAttempt_s);
      rises.scores.emplace_back(score_of(played));
      rises.worst = std::min(rises.worst, *rises.scores.back());
      all_stand = all_stand && standing(played) == played.size();
    }
    if (!all_stand) return rises;
    constexpr double kFew = 0.5;  // another engine is not asked
    rises.share = 1.0;
    play.first_seed = kRiseSeed + kRiseRobots;
    play.seeds = kFurtherRobots;
    for (const std::string& engine : search_engines()) {
      if (rises.share < kFew) break;
      play.stepper = engine;
      const std::vector<Rise> played = play_rises(robot, play, search_.lying, 1, kFirstAttempt_s);
      rises.share =
          std::min(rises.share, static_cast<double>(standing(played)) / static_cast<double>(played.size()));
    }
    rises.worst += kShareCounts * rises.share;
    return rises;
  }

  double score(const RecoveryMotion& candidate, const std::vector<double>& x) {
    if (end_.is_reached(result_.candidates)) throw Ended();
    ++result_.candidates;
    double value = kRefused;
    bool is_enough = false;
    std::optional<RecoveryMotion> motion;
    Rises rises{.scores = std::vector<std::optional<double>>(search_engines().size())};
    std::size_t errors = 0;
    try {
      motion = search_.check.mended(candidate);
      errors = search_.check.errors(*motion).size();
      const TriedRobot robot = search_.make(*motion);
      rises = play(robot);
      best_of_search_ = std::max(best_of_search_, rises.worst - kShareCounts * rises.share);
      value = rises.worst - kErrorCosts * static_cast<double>(std::min<std::size_t>(errors, 5));
      is_enough = rises.share >= kEnough && errors == 0 && search_.is_enough(robot);
    } catch (const InputError&) {  // of the compiler: a move that is too fast, say
    }
    log(rises, errors, x);
    if (result_.candidates % kShowEvery == 0)
      search_.progress(
          fmt::format("candidate {}, best score {:.2f}", end_.count_text(result_.candidates), best_));
    if (result_.candidates == 1) {
      best_ = value;
    } else if (motion && (value > best_ || is_enough)) {
      best_ = value;
      result_.motion = motion;
      search_.progress(fmt::format("candidate {}: {} rises with score {:.2f}",
                                   end_.count_text(result_.candidates), motion->name(), best_));
    }
    if (is_enough) throw Ended();
    return value;
  }

  void log(const Rises& rises, std::size_t errors, const std::vector<double>& x) {
    result_.log += std::to_string(result_.candidates);
    for (const std::optional<double>& score : rises.scores)
      result_.log += score ? fmt::format(",{:.4f}", *score) : ",";
    result_.log += fmt::format(",{:.2f},{}", rises.share, errors);
    for (const double value : x) result_.log += fmt::format(",{:.4f}", value);
    result_.log += "\n";
  }

  static constexpr double kRefused = -1.0;     // score of a motion that does not compile
  static constexpr double kHopeless = 0.15;    // below the best score, in one engine
  static constexpr double kShareCounts = 2.0;  // more than standing soon
  static constexpr double kErrorCosts = 0.1;
  static constexpr double kEnough = 0.95;  // with 0.9, 6 of 10 other robots stood (Sigmaban)

  const RiseSearch& search_;
  const SearchEnd& end_;
  std::vector<RecoveryMotion::Variable> variables_;
  double best_ = 0.0;
  double best_of_search_ = -1.0;  // of the robots of the search alone
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

SearchedMotion search_rise(const RiseSearch& search, const std::vector<RecoveryMotion>& starts,
                           std::optional<std::size_t> candidates, const SearchEnd& end) {
  return RiseOptimisation(search, end).run(starts, candidates);
}

}  // namespace koboshi::lab
