#include "lab/bring_up/value_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/text/error.h"
#include "sim_board/engine/mujoco/has_mujoco.h"
#include "sim_board/random/random_stream.h"

namespace koboshi::lab {
namespace {

constexpr std::size_t kPatience = 25;   // candidates without success, once all robots are carried
constexpr std::size_t kShowEvery = 10;  // candidates
constexpr double kLeastGain = 1e-3;     // of a score, to count as better

struct Score {
  double value = 0.0;
  bool carries_all = false;  // no robot is lost
};

// How well robots walk: those that are lost count by how long they last, the others by what they make good
// of the speed and how little they lean.
Score score_in(const TriedRobot& robot, const PlayOptions& options, const Walk& walk, double speed) {
  const std::vector<Played> all = robot.standing(options).play(walk.command(speed), robot.walk_s());
  double sum = 0.0;
  for (const Played& one : all) {
    const bool walks = !one.lost && one.state == behaviour::State::kWalking;
    const double good = speed > 0.0 ? std::clamp(walk.made_good(one) / speed, -1.0, 1.0) : 1.0;
    sum += walks ? 1.0 + 0.5 * good - one.lean_rad : 0.9 * std::clamp(one.at_s / robot.walk_s(), 0.0, 1.0);
  }
  return {sum / static_cast<double>(all.size()), losses(all, behaviour::State::kWalking) == 0};
}

// The score in the engine that likes the robot least. The others are not played once one is below
// `uninteresting`: the candidate is then worse in any case.
Score worst_score(const ValueSearch& search, const TriedRobot& robot, double uninteresting) {
  Score worst{.value = std::numeric_limits<double>::infinity(), .carries_all = true};
  for (const std::string& engine : search_engines()) {
    PlayOptions play = search.play;
    play.stepper = engine;
    const Score score = score_in(robot, play, search.walk, search.speed);
    worst.value = std::min(worst.value, score.value);
    worst.carries_all = worst.carries_all && score.carries_all;
    if (worst.value < uninteresting) break;
  }
  return worst;
}

StartFactors drawn(sim_board::RandomStream& random, const StartFactors& best, double width) {
  const auto about = [&](double value, double reach, double low, double high) {
    return std::clamp(value + width * random.within(reach), low, high);
  };
  return {.com_height = about(best.com_height, 0.08, 0.85, 1.05),
          .step_time = about(best.step_time, 0.3, 0.6, 1.8),
          .gains = about(best.gains, 0.6, 0.0, 2.5),
          .trunk_pitch_deg = about(best.trunk_pitch_deg, 5.0, -8.0, 12.0)};
}

}  // namespace

SearchEnd::SearchEnd(std::optional<std::size_t> candidates, std::chrono::steady_clock::time_point end)
    : candidates_(candidates), end_(std::chrono::steady_clock::now()) {
  if (end > end_) end_ += (end - end_) / 2;
}

bool SearchEnd::is_reached(std::size_t candidates) const {
  if (candidates_) return candidates >= *candidates_;
  return std::chrono::steady_clock::now() >= end_;
}

std::string SearchEnd::count_text(std::size_t candidate) const {
  return candidates_ ? fmt::format("{} of {}", candidate, *candidates_) : fmt::format("{}", candidate);
}

std::vector<std::string> search_engines() {
  std::vector<std::string> engines{"lumped"};
  if (sim_board::has_mujoco()) engines.emplace_back("mujoco");
  return engines;
}

SearchedValues search_values(const ValueSearch& search, const StartFactors& start,
                             const TriedRobot& start_robot, const SearchEnd& end, std::size_t first) {
  SearchedValues found{.factors = start, .robot = nullptr, .candidates = 0};
  if (end.is_reached(0)) return found;
  sim_board::RandomStream random(1 + first, "bring-up");
  Score best = worst_score(search, start_robot, -std::numeric_limits<double>::infinity());
  std::size_t since = 0;
  std::size_t refused = 0;
  std::size_t not_fitting = 0;
  for (std::size_t i = 0; !end.is_reached(i); ++i, ++since) {
    if (best.carries_all && since >= kPatience) break;
    found.candidates = i + 1;
    if (found.candidates % kShowEvery == 0)
      search.progress(
          fmt::format("candidate {}, best score {:.2f}; {} fell on lower rungs, {} do not fit the legs",
                      end.count_text(found.candidates), best.value, refused, not_fitting));
    const StartFactors factors = drawn(random, found.factors, best.carries_all ? 0.3 : 1.0);
    std::shared_ptr<TriedRobot> robot;
    try {
      robot = search.make(factors);
      const Score score = worst_score(search, *robot, best.value + kLeastGain);
      if (score.value < best.value + kLeastGain) continue;
      if (!search.lower_rungs(*robot)) {
        ++refused;
        continue;
      }
      best = score;
    } catch (const InputError&) {
      ++not_fitting;
      continue;
    }
    found.factors = factors;
    found.robot = robot;
    since = 0;
    search.progress(fmt::format("candidate {}: score {:.2f} with {}", end.count_text(found.candidates),
                                best.value, factors_text(factors)));
  }
  return found;
}

std::string factors_text(const StartFactors& factors) {
  return fmt::format("CoM height x {:.3f}, step time x {:.3f}, gains x {:.2f}, lean {:+.1f} degrees",
                     factors.com_height, factors.step_time, factors.gains, factors.trunk_pitch_deg);
}

}  // namespace koboshi::lab
