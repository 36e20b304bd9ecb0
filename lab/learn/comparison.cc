#include "lab/learn/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "base/text/text.h"
#include "lab/experiment/files.h"
#include "lab/learn/episode.h"
#include "lab/trial/pushes.h"
#include "sim_board/random/random_stream.h"
#include "simulation/policy/policy_file.h"

namespace koboshi::lab {
namespace {

constexpr double kComparedStride_s = 2.5;  // before a push, at least: as in the experiment robustness
constexpr double kComparedFall_s = 3.0;    // a robot that is going to fall lies after one second
constexpr std::uint64_t kComparedDirections = 16;

struct ComparedActivity {
  const char* name;
  double speed_share;  // of the full speed
  bool pushed;
};
constexpr std::array<ComparedActivity, 5> kComparedActivities{{{"push-on-the-spot", 0.0, true},
                                                               {"push-half", 0.5, true},
                                                               {"push-full", 1.0, true},
                                                               {"walk-half", 0.5, false},
                                                               {"walk-full", 1.0, false}}};

struct ComparedCase {
  ComparedActivity activity;
  double impulse_N_s_per_kg = 0.0;
  bool has_policy = false;
};

std::vector<ComparedCase> cases_of(const ComparisonOptions& options) {
  std::vector<ComparedCase> cases;
  for (const ComparedActivity& activity : kComparedActivities) {
    if (std::ranges::find(options.activities, activity.name) == options.activities.end()) continue;
    const std::vector<double> impulses = activity.pushed ? options.impulses_N_s_per_kg : std::vector{0.0};
    for (const double impulse : impulses) {
      cases.push_back({activity, impulse, false});
      if (!options.policy.empty()) cases.push_back({activity, impulse, true});
    }
  }
  return cases;
}

EpisodePlayer::Course course_of(const ComparedCase& played, const ComparisonOptions& options,
                                const EpisodePlayer& player, std::uint64_t seed) {
  EpisodePlayer::Course course{.world = options.world, .walk_s = options.walk_s};
  course.velocity.x() = played.activity.speed_share * player.full_speed_m_per_s();
  if (!played.activity.pushed) return course;
  sim_board::RandomStream random(seed, "phase of the push");
  const double at_s = kComparedStride_s + player.cycle_s() * random.uniform();
  const double towards_rad =
      kTurn_rad * static_cast<double>(seed % kComparedDirections) / kComparedDirections;
  course.pushes = {{.at_s = at_s,
                    .duration_s = kPush_s,
                    .impulse_N_s_per_kg = played.impulse_N_s_per_kg *
                                          Eigen::Vector2d(std::cos(towards_rad), std::sin(towards_rad))}};
  course.walk_s = at_s + kPush_s + kComparedFall_s;
  return course;
}

ComparedTrial compared(const Episode& episode) {
  ComparedTrial trial{.outcome = episode.outcome,
                      .error = episode.error,
                      .lost = episode.lost(),
                      .policy_stopped = episode.policy_stopped};
  if (trial.lost) return trial;
  trial.drift_m_per_s = episode.drift_m_per_s;
  trial.power_W = episode.power_W;
  trial.lean_rad = std::sqrt(episode.lean_rad2);
  return trial;
}

std::string label_of(const ComparedCase& played) {
  return played.activity.pushed
             ? fmt::format("{}, {} N s/kg", played.activity.name, number_text(played.impulse_N_s_per_kg))
             : std::string(played.activity.name);
}

// A line for each activity and impulse that both have played.
Conclusions conclude_comparison(const std::vector<ComparedCase>& cases, const ExperimentResult& result) {
  Conclusions conclusions;
  for (std::size_t i = 0; i + 1 < cases.size(); i += 2) {
    const std::vector<ComparedTrial> without = compared_fields().trials(result.cells.at(i));
    const std::vector<ComparedTrial> with = compared_fields().trials(result.cells.at(i + 1));
    const std::size_t pairs = std::min(without.size(), with.size());
    std::size_t only_without = 0;
    std::size_t only_with = 0;
    for (std::size_t k = 0; k < pairs; ++k) {
      only_without += without[k].lost && !with[k].lost ? 1u : 0u;
      only_with += with[k].lost && !without[k].lost ? 1u : 0u;
    }
    const double probability = sign_test(only_without, only_with);
    conclusions.lines += fmt::format(
        "{}: of {} seeds {} are lost by the engine alone only, {} with the policy only, p {:.3f}\n",
        label_of(cases[i]), pairs, only_without, only_with, probability);
    conclusions.values[label_of(cases[i])] = {{"seeds", pairs},
                                              {"lost_by_engine_only", only_without},
                                              {"lost_with_policy_only", only_with},
                                              {"sign_test", probability}};
  }
  return conclusions;
}

}  // namespace

const std::vector<std::string>& ComparisonOptions::all_activities() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const ComparedActivity& activity : kComparedActivities) names.emplace_back(activity.name);
    return names;
  }();
  return kNames;
}

const FieldTable<ComparedTrial>& compared_fields() {
  using T = ComparedTrial;
  constexpr double kFieldDegrees = 360.0 / kTurn_rad;
  static const FieldTable<T> kFields{
      Fields<T>{{{.name = "lost", .label = "lost"}, &T::lost}}, outcome_fields<T>(&T::outcome),
      Fields<T>{
          {{.name = "drift_m_per_s", .label = "drift [mm/s]", .decimals = 1, .factor = 1e3},
           &T::drift_m_per_s},
          {{.name = "power_W", .label = "power [W]", .decimals = 2}, &T::power_W},
          {{.name = "lean_rad", .label = "lean [deg]", .decimals = 2, .factor = kFieldDegrees}, &T::lean_rad},
          {{.name = "policy_stopped", .label = "stopped by the watchdog"}, &T::policy_stopped}}};
  return kFields;
}

Experiment make_comparison(const ComparisonOptions& options) {
  const auto player = std::make_shared<const EpisodePlayer>(options.scenario, options.overrides);
  std::vector<std::byte> image;
  if (!options.policy.empty()) image = simulation::read_policy_image(options.policy, player->model().model);
  Experiment experiment = begin_experiment("learned", "Learned policies", options, player->scenario(),
                                           {{"walk_s", options.walk_s}});
  if (!options.policy.empty()) {
    const std::vector<std::filesystem::path> files{options.policy};
    const std::vector<std::string> texts{experiment.inputs};
    experiment.inputs = hash_inputs(files, texts);
  }
  const std::vector<ComparedCase> cases = cases_of(options);
  for (const ComparedCase& each : cases) {
    const std::string impulse = each.activity.pushed ? number_text(each.impulse_N_s_per_kg) : "-";
    const std::string controller = each.has_policy ? "with policy" : "engine alone";
    experiment.cells.push_back(
        {fmt::format("{}-{}-{}", each.activity.name, impulse, each.has_policy ? "policy" : "engine"),
         {{"activity", each.activity.name}, {"impulse [N s/kg]", impulse}, {"controller", controller}}});
  }
  set_trials(experiment, compared_fields(),
             [options, cases, player, image](std::size_t cell, std::uint64_t seed) {
               const ComparedCase& played = cases[cell];
               return compared(player->play(played.has_policy ? image : std::vector<std::byte>{},
                                            course_of(played, options, *player, seed), seed));
             });
  if (!options.policy.empty()) {
    experiment.conclude = [cases](const Experiment&, const ExperimentResult& result) {
      return conclude_comparison(cases, result);
    };
  }
  return experiment;
}

double sign_test(std::size_t only_first, std::size_t only_second) {
  const std::size_t count = only_first + only_second;
  const std::size_t most = std::max(only_first, only_second);
  // The tail of the binomial law with probability a half.
  double tail = 0.0;
  for (std::size_t k = most; k <= count; ++k)
    tail += std::exp(
        std::lgamma(static_cast<double>(count) + 1.0) - std::lgamma(static_cast<double>(k) + 1.0) -
        std::lgamma(static_cast<double>(count - k) + 1.0) - static_cast<double>(count) * std::log(2.0));
  return std::min(1.0, 2.0 * tail);
}

}  // namespace koboshi::lab
