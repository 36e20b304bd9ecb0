#include "lab/tune/study_search.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "base/text/text.h"
#include "lab/experiment/files.h"
#include "lab/experiment/report.h"
#include "lab/trial/getting_up.h"
#include "lab/trial/scenario_trial.h"
#include "lab/tune/infeasible.h"
#include "lab/tune/lost_trials.h"
#include "lab/tune/optimiser.h"
#include "simulation/disturbance/world_text.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/reader.h"
#include "tools/plot/figure.h"

namespace koboshi::tools {
namespace {

// Below the score of any run, yet near it: optimisers rank candidates, and some fit models to their values.
constexpr double kInfeasibleWorth = -10.0;

const FieldTable<GettingUpTrial>& trial_fields() {
  using T = GettingUpTrial;
  using Walk = simulation::WalkSummary;
  static const FieldTable<T> kFields{outcome_fields<T>(&T::outcome),
                                     Fields<T>{{{"distance_m"}, &T::walk, &Walk::distance_m},
                                               {{"speed_m_per_s"}, &T::walk, &Walk::speed_m_per_s},
                                               {{"lateral_drift_m"}, &T::walk, &Walk::lateral_drift_m},
                                               {{"heading_drift_rad"}, &T::walk, &Walk::heading_drift_rad},
                                               {{"duration_s"}, &T::duration_s},
                                               {{"stood_s"}, &T::stood_s},
                                               {{"uprightness"}, &T::uprightness}}};
  return kFields;
}

class StudySearch {
 public:
  StudySearch(const Study& study, const StudyOptions& options, const ShowProgress& progress)
      : study_(study),
        options_(options),
        progress_([this, progress](const SearchProgress& now) {
          write_state(now, "running");
          if (progress) progress(now);
        }),
        search_(setup(), options, progress_) {
    write_state({.total = options.evaluations}, "running");
  }

  SearchResult search() {
    const std::vector<double> start = start_of(study_.numbers);
    const OptimiserOptions how{
        .evaluations = options_.evaluations, .population = options_.population, .spread = options_.spread};
    const auto losses = [this](const std::vector<double>& x) { return losses_of(search_.evaluate(x)); };
    if (options_.method == Method::kNsga2) {
      minimise_each(losses, study_.trials.size(), start, how);
    } else {
      static_cast<void>(minimise([this](const auto& x) { return -search_.evaluate(x).score; }, start, how));
    }
    SearchResult result = search_.finish();
    result.lost = lost_.text();
    std::string text;
    for (const auto& [path, value] : result.numbers) text += path + ": " + number_text(value) + "\n";
    write_whole_file(options_.out / "best.yaml", text);
    if (options_.method == Method::kNsga2) write_front();
    write_report(search_.best());
    write_state({search_.candidates().size(), options_.evaluations, 0.0, result.score}, "finished");
    return result;
  }

 private:
  Search::Setup setup() {
    Row columns;
    for (const StudiedTrial& trial : study_.trials) columns.push_back(trial.name);
    columns.insert(columns.end(), {"score", "violated_limit"});
    const auto cells = [](const Candidate& candidate) {
      Row row;
      for (const double score : candidate.scores) row.push_back(csv_cell(score));
      row.push_back(csv_cell(candidate.score));
      if (!candidate.violated.empty()) row.assign(row.size(), "");
      row.push_back(candidate.violated);
      return row;
    };
    return {.numbers = study_.numbers,
            .evaluate = [this](Candidate& candidate) { play(candidate); },
            .infeasible = {.scores = std::vector(study_.trials.size(), kInfeasibleWorth),
                           .score = kInfeasibleWorth},
            .columns = columns,
            .cells = cells};
  }

  // Writes the state that a program needs to watch or resume the search.
  void write_state(const SearchProgress& now, const char* state) const {
    nlohmann::ordered_json overrides = nlohmann::ordered_json::object();
    for (const Override& item : options_.overrides) overrides[item.path] = item.value;
    nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
    for (const SearchedNumber& number : study_.numbers) numbers.push_back(number.path);
    nlohmann::ordered_json trials = nlohmann::ordered_json::array();
    for (const StudiedTrial& trial : study_.trials) trials.push_back(trial.name);
    nlohmann::ordered_json document{{"version", 1},
                                    {"study", study_.file.string()},
                                    {"search", options_.method == Method::kNsga2 ? "nsga-2" : "cma-es"},
                                    {"evaluations", options_.evaluations},
                                    {"population", options_.population},
                                    {"spread", options_.spread},
                                    {"first_seed", options_.first_seed},
                                    {"seeds", options_.seeds},
                                    {"set", overrides},
                                    {"numbers", numbers},
                                    {"trials", trials},
                                    {"state", state},
                                    {"done", now.done}};
    if (now.done > 0) document["best"] = now.best;
    simulation::write_json(options_.out / "search.json", document);
  }

  // By trial, to become small.
  static std::vector<double> losses_of(const Candidate& candidate) {
    std::vector<double> losses = candidate.scores;
    for (double& value : losses) value = -value;
    return losses;
  }

  void write_front() const {
    std::vector<std::vector<double>> values;
    for (const Candidate& candidate : search_.candidates()) values.push_back(losses_of(candidate));
    std::vector<Row> rows;
    for (const std::size_t number : non_dominated(values)) rows.push_back(search_.row(number));
    write_whole_file(options_.out / "front.csv", table_text(search_.head(), rows, TableStyle::kCsv));
  }

  void write_report(const Candidate& best) const {
    const Candidate& first = search_.candidates().front();
    const std::size_t evaluations = search_.candidates().size();
    std::vector<Row> numbers;
    for (std::size_t i = 0; i < study_.numbers.size(); ++i) {
      const SearchedNumber& n = study_.numbers[i];
      numbers.push_back({n.path, number_text(n.low) + " to " + number_text(n.high),
                         number_text(first.numbers[i]), number_text(best.numbers[i])});
    }
    std::vector<Row> trials;
    for (std::size_t i = 0; i < study_.trials.size(); ++i) {
      trials.push_back({study_.trials[i].name, number_text(study_.trials[i].weight),
                        fmt::format("{:.4f}", first.scores[i]), fmt::format("{:.4f}", best.scores[i])});
    }
    trials.push_back({"mean", "", fmt::format("{:.4f}", first.score), fmt::format("{:.4f}", best.score)});
    const std::string figure = "\n" + draw_course() + "\n\n";
    write_whole_file(
        options_.out / "report.md",
        fmt::format(
            "# {}\n\n{} evaluations in {} worlds each, seeds {} to {}: judge what was found on others.\n",
            study_.file.filename().string(), evaluations, options_.seeds, options_.first_seed,
            options_.first_seed + options_.seeds - 1) +
            infeasible_text(search_.infeasible().counts(), evaluations) + lost_.text() + figure +
            table_text({"number", "range", "start", "found"}, numbers, TableStyle::kMarkdown) + "\n" +
            table_text({"trial", "weight", "score of the start", "score of the result"}, trials,
                       TableStyle::kMarkdown));
  }

  // Draws the score of each evaluation and of each trial in it. Returns the Markdown that shows the figure,
  // or the reason why none could be drawn.
  std::string draw_course() const {
    Figure figure{
        .title = study_.file.filename().string(), .x_column = "evaluation", .x_label = "evaluation"};
    figure.panels.push_back(
        {.y_label = "score", .series = {{.column = "score", .style = LineStyle::kPoints}}});
    Panel each{.y_label = "score of each trial"};
    Columns columns = make_columns({"evaluation", "score"});
    for (const StudiedTrial& trial : study_.trials) {
      columns.push_back({trial.name, {}});
      each.series.push_back({.column = trial.name, .label = trial.name, .style = LineStyle::kPoints});
    }
    figure.panels.push_back(std::move(each));
    for (const Candidate& candidate : search_.candidates()) {
      const auto shown = [&](double score) { return candidate.violated.empty() ? score : std::nan(""); };
      std::vector<double> row{static_cast<double>(columns[0].second.size() + 1), shown(candidate.score)};
      std::ranges::transform(candidate.scores, std::back_inserter(row), shown);
      add_row(columns, row);
    }
    try {
      draw(figure, columns, options_.out / "figure");
      return "![Score of each evaluation](figure.png)";
    } catch (const PlotError& error) {
      return std::string("No figure: ") + error.what();
    }
  }

  // Sets the scores of its parameters.
  void play(Candidate& candidate) {
    const Experiment experiment = make_experiment(candidate.numbers);
    const ExperimentResult result = play_experiment(
        experiment, {.log = options_.out / "trials.jsonl", .jobs = options_.jobs, .batch = options_.seeds});
    double sum = 0.0;
    double weights = 0.0;
    for (std::size_t cell = 0; cell < study_.trials.size(); ++cell) {
      const StudiedTrial& studied = study_.trials[cell];
      double mean = 0.0;
      for (const GettingUpTrial& trial : trial_fields().trials(result.cells[cell])) {
        mean += score(studied, trial, durations_s_[cell]);
        lost_.add(trial);
      }
      mean /= static_cast<double>(options_.seeds);
      candidate.scores.push_back(mean);
      sum += studied.weight * mean;
      weights += studied.weight;
    }
    candidate.score = sum / weights;
  }

  static GettingUpTrial play(const StudiedTrial& trial, const simulation::Scenario& scenario,
                             std::uint64_t seed) {
    if (trial.reward == StudiedTrial::Reward::kStandUp) return play_getting_up(scenario, seed);
    return {play_in_world(scenario, seed)};
  }

  Experiment make_experiment(const std::vector<double>& numbers) {
    std::vector<std::string> texts;
    std::vector<Override> shared = options_.overrides;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      shared.push_back({study_.numbers[i].path, number_text(numbers[i]), study_.file.string()});
    }
    std::vector<simulation::Scenario> scenarios;
    Experiment experiment{"study"};
    durations_s_.clear();
    for (const StudiedTrial& trial : study_.trials) {
      std::vector<Override> overrides = shared;
      overrides.insert(overrides.end(), trial.set.begin(), trial.set.end());
      for (const Override& item : overrides) texts.insert(texts.end(), {item.path, item.value});
      scenarios.push_back(simulation::read_scenario(study_.scenario, overrides));
      scenarios.back().world = {simulation::world_named(study_.world), std::nullopt};
      durations_s_.push_back(1e-6 * static_cast<double>(scenarios.back().duration_us));
      experiment.cells.push_back({.name = trial.name, .settings = {{"trial", trial.name}}});
    }
    for (const auto& [factor, range] : simulation::range_texts(simulation::world_named(study_.world)))
      texts.insert(texts.end(), {factor, range});
    experiment.first_seed = options_.first_seed;
    experiment.seeds = options_.seeds;
    experiment.inputs = hash_inputs(study_files(study_, scenarios), texts);
    set_trials(experiment, trial_fields(), [this, scenarios](std::size_t cell, std::uint64_t seed) {
      return play(study_.trials[cell], scenarios[cell], seed);
    });
    return experiment;
  }

  const Study& study_;
  const StudyOptions& options_;
  const ShowProgress progress_;
  std::vector<double> durations_s_;  // of the trials that do not end with a fall
  Search search_;
  LostTrials lost_;
};

}  // namespace

std::vector<std::filesystem::path> study_files(const Study& study,
                                               std::span<const simulation::Scenario> trials) {
  std::vector<std::filesystem::path> files{study.file};
  for (const simulation::Scenario& trial : trials) {
    for (const std::filesystem::path& file : simulation::input_files(trial)) {
      if (std::ranges::find(files, file) == files.end()) files.push_back(file);
    }
  }
  return files;
}

SearchResult search_study(const Study& study, const StudyOptions& options, const ShowProgress& progress) {
  std::filesystem::create_directories(options.out);
  const FolderLock lock(options.out);
  return StudySearch(study, options, progress).search();
}

}  // namespace koboshi::tools
