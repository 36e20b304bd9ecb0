#include "lab/tune/gait_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "base/text/error.h"
#include "base/text/text.h"
#include "lab/tune/gait_text.h"
#include "lab/tune/optimiser.h"

namespace koboshi::lab {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kWorst = -1.0;  // a fall at once
// The costs of a drift as long as the distance walked, and of a slide of a metre.
constexpr double kDriftCost_m_per_s = 0.1;
constexpr double kSlipCost_per_s = 0.5;
constexpr double kMinDistance_m = 0.1;  // bounds the drift of a robot that marks time

// {period_s: 0.5, feedback.knee_s: 0.01}
std::string flow_map(const GaitNumbers& numbers) {
  std::string text;
  for (const auto& [key, value] : numbers) {
    text += (text.empty() ? "{" : ", ") + key + ": " + number_text(value);
  }
  return text + "}";
}

double duration_of(const GyroFeedbackOptions& options) {
  const simulation::Scenario scenario =
      gyro_feedback_scenario(options, options.points.front(), options.feedback.front());
  return 1e-6 * static_cast<double>(scenario.duration_us);
}

std::vector<SearchedNumber> numbers_of(const GaitSearchOptions& options, const std::string& text) {
  std::vector<SearchedNumber> numbers;
  for (SearchedNumber number : gait_parameters()) {
    const bool effective = !number.path.starts_with("feedback.") || options.experiment.feedback.front();
    if (!effective || !has_number(text, number.path)) continue;
    number.start = gait_number(text, number.path, options.start);
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace

std::vector<SearchedNumber> gait_parameters() {
  // Half a period is a whole number of ticks: otherwise left and right steps are sampled differently, and
  // the robot turns. A foot that clears an ideal floor by a few millimetres, as fast walks would have it,
  // stumbles over any real one.
  constexpr double kTwoTicks_s = 0.02;
  constexpr double kGrid = 1e-5;
  return {{"period_s", 0.3, 1.0, kTwoTicks_s},         {"step_length_m", 0.01, 0.08, kGrid},
          {"step_width_m", 0.055, 0.085, kGrid},       {"step_height_m", 0.015, 0.035, kGrid},
          {"swing_profile", 0.0, 1.0, kGrid},          {"com_height_m", 0.15, 0.19, kGrid},
          {"double_support", 0.03, 0.6, kGrid},        {"trunk_pitch_deg", -4.0, 12.0, kGrid},
          {"zmp_forward_m", -0.015, 0.03, kGrid},      {"zmp_inward_m", -0.01, 0.02, kGrid},
          {"sag_compensation", 0.0, 1.2, kGrid},       {"feedback.ankle_pitch_s", 0.0, 0.12, kGrid},
          {"feedback.ankle_roll_s", 0.0, 0.12, kGrid}, {"feedback.hip_roll_s", 0.0, 0.12, kGrid},
          {"feedback.knee_s", 0.0, 0.12, kGrid}};
}

double reward(const ScenarioTrial& trial, double duration_s) {
  if (!trial.walked()) return kWorst;  // it has not even begun
  if (trial.lost()) return kWorst * (1.0 - trial.duration_s / duration_s);
  const double distance_m = std::max(std::abs(trial.walk.distance_m), kMinDistance_m);
  const double drift = std::min(1.0, std::abs(trial.walk.lateral_drift_m) / distance_m);
  return trial.walk.speed_m_per_s - kDriftCost_m_per_s * drift - kSlipCost_per_s * trial.foot_slip_max_m;
}

GaitSearchResult search_gait(const GaitSearchOptions& options, const ShowProgress& progress) {
  const std::string text = read_text_file(options.start, "a gait file");
  const double duration_s = duration_of(options.experiment);
  const std::vector<SearchedNumber> numbers = numbers_of(options, text);
  if (numbers.empty())
    throw InputError(options.start, 0, "a gait without parameters", "one with those that are searched for");
  const auto gait_of = [&](const Candidate& candidate) {
    GaitNumbers gait;
    for (std::size_t i = 0; i < numbers.size(); ++i) gait[numbers[i].path] = candidate.numbers[i];
    return gait;
  };
  const auto experiment_of = [&](const std::optional<GaitNumbers>& gait) {
    GyroFeedbackOptions setup = options.experiment;
    setup.first_seed = options.first_seed;
    setup.seeds = options.seeds;
    setup.overrides.push_back({"gait.file", "\"" + std::filesystem::absolute(options.start).string() + "\""});
    if (gait) setup.overrides.push_back({"gait.set", flow_map(*gait)});
    return make_gyro_feedback(setup);
  };
  static_cast<void>(experiment_of({}));  // throws for what it cannot read, before the first write
  std::filesystem::create_directories(options.out);
  const FolderLock lock(options.out);
  // The lift that was achieved: legs and ground that give way leave less than the gait commands.
  double foot_lift_m = kNotANumber;
  const auto evaluate = [&](Candidate& candidate) {
    foot_lift_m = kNotANumber;
    const ExperimentResult result =
        play_experiment(experiment_of(gait_of(candidate)),
                        {.log = options.out / "trials.jsonl", .jobs = options.jobs, .batch = options.seeds});
    const std::vector<ScenarioTrial> trials = walk_fields().trials(result.cells.front());
    for (const ScenarioTrial& trial : trials) candidate.score += reward(trial, duration_s);
    candidate.score /= static_cast<double>(options.seeds);
    foot_lift_m = mean_of(trials, [](const ScenarioTrial& trial) { return trial.walk.foot_lift_m; }).mean;
  };
  Search search({.numbers = numbers,
                 .evaluate = evaluate,
                 .infeasible = {.score = kWorst},
                 .columns = {"foot_lift_m", "reward_m_per_s"},
                 .cells =
                     [&](const Candidate& candidate) {
                       return Row{csv_cell(foot_lift_m), csv_cell(candidate.score)};
                     }},
                options, progress);
  static_cast<void>(minimise(
      [&](const std::vector<double>& x) { return -search.evaluate(x).score; }, start_of(numbers),
      {.evaluations = options.evaluations, .population = options.population, .spread = options.spread}));
  GaitSearchResult result{search.finish(), with_numbers(text, gait_of(search.best()), options.start)};
  write_whole_file(options.out / "gait.yaml", result.text);
  return result;
}

}  // namespace koboshi::lab
