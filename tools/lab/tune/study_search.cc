#include "tools/lab/tune/study_search.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <utility>

#include "sim_board/input/text.h"
#include "sim_board/record/output_file.h"
#include "sim_board/record/output_folder.h"
#include "sim_board/scenario/reader.h"
#include "tools/lab/experiment/files.h"
#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/getting_up.h"
#include "tools/lab/trial/scenario_trial.h"
#include "tools/lab/tune/infeasible.h"
#include "tools/lab/tune/optimiser.h"
#include "tools/lab/plot/figure.h"

namespace koboshi::tools {
namespace {

// Below what any run is worth, yet near: optimisers rank candidates, and some fit models to their values.
constexpr double kInfeasibleWorth = -10.0;

std::vector<Measure> measures() {
  using enum Measure::Kind;
  return {{.name = "fell", .kind = kEvent},
          {.name = "distance_m"},
          {.name = "speed_m_per_s"},
          {.name = "lateral_drift_m"},
          {.name = "heading_drift_rad"},
          {.name = "duration_s"},
          {.name = "failed", .kind = kEvent},
          {.name = "stood", .kind = kEvent},
          {.name = "stood_s"},
          {.name = "uprightness"}};
}

class StudySearch {
 public:
  StudySearch(const Study& study, const StudyOptions& options,
              const std::function<void(const StudyProgress&)>& progress)
      : study_(study), options_(options), progress_(progress), log_(options.out / "evaluations.csv") {
    log_.write(head());
  }

  StudyResult search() {
    std::vector<double> start;
    for (const StudiedNumber& n : study_.numbers) start.push_back((n.start - n.low) / (n.high - n.low));
    const OptimiserOptions how{
        .evaluations = options_.evaluations, .population = options_.population, .spread = options_.spread};
    if (options_.search == Search::kCmaEs) {
      static_cast<void>(minimise([this](const auto& x) { return -evaluate(x).worth; }, start, how));
    } else {
      minimise_each([this](const auto& x) { return losses(evaluate(x)); }, study_.trials.size(), start, how);
    }
    log_.close();
    const Evaluation& best = *std::ranges::max_element(evaluations_, {}, &Evaluation::worth);
    StudyResult result{.numbers = {},
                       .worth = best.worth,
                       .evaluations = evaluations_.size(),
                       .infeasible = infeasible_.counts()};
    std::string text;
    for (std::size_t i = 0; i < best.numbers.size(); ++i) {
      result.numbers.emplace_back(study_.numbers[i].path, best.numbers[i]);
      text += study_.numbers[i].path + ": " + sim::number_text(best.numbers[i]) + "\n";
    }
    sim::write_whole_file(options_.out / "best.yaml", text);
    if (options_.search == Search::kNsga2) write_front();
    write_report(best);
    return result;
  }

 private:
  struct Evaluation {
    std::vector<double> numbers;
    std::vector<double> worths;  // by trial
    double worth = 0.0;          // their weighted mean
    std::string violated{};      // the limit that makes the numbers infeasible; empty: feasible
  };

  // To be made small, by trial.
  static std::vector<double> losses(const Evaluation& evaluation) {
    std::vector<double> losses = evaluation.worths;
    for (double& value : losses) value = -value;
    return losses;
  }

  std::string head() const {
    std::string head = "evaluation";
    for (const StudiedNumber& number : study_.numbers) head += "," + number.path;
    for (const StudiedTrial& trial : study_.trials) head += "," + trial.name;
    return head + ",worth,violated_limit\n";
  }

  std::string line(std::size_t number) const {
    const Evaluation& evaluation = evaluations_[number];
    std::string line = std::to_string(number + 1);
    for (const double value : evaluation.numbers) line += "," + sim::number_text(value);
    const bool feasible = evaluation.violated.empty();
    for (const double value : evaluation.worths) line += "," + (feasible ? sim::number_text(value) : "");
    return line + "," + (feasible ? sim::number_text(evaluation.worth) : "") + "," +
           csv_cell(evaluation.violated) + "\n";
  }

  void write_front() const {
    std::vector<std::vector<double>> values;
    for (const Evaluation& evaluation : evaluations_) values.push_back(losses(evaluation));
    std::string text = head();
    for (const std::size_t number : non_dominated(values)) text += line(number);
    sim::write_whole_file(options_.out / "front.csv", text);
  }

  void write_report(const Evaluation& best) const {
    const Evaluation& first = evaluations_.front();
    std::vector<Row> numbers;
    for (std::size_t i = 0; i < study_.numbers.size(); ++i) {
      const StudiedNumber& n = study_.numbers[i];
      numbers.push_back({n.path, sim::number_text(n.low) + " to " + sim::number_text(n.high),
                         sim::number_text(first.numbers[i]), sim::number_text(best.numbers[i])});
    }
    std::vector<Row> trials;
    for (std::size_t i = 0; i < study_.trials.size(); ++i) {
      trials.push_back({study_.trials[i].name, sim::number_text(study_.trials[i].weight),
                        fmt::format("{:.4f}", first.worths[i]), fmt::format("{:.4f}", best.worths[i])});
    }
    trials.push_back({"mean", "", fmt::format("{:.4f}", first.worth), fmt::format("{:.4f}", best.worth)});
    const std::string figure = "\n" + draw_course() + "\n\n";
    sim::write_whole_file(
        options_.out / "report.md",
        fmt::format(
            "# {}\n\n{} evaluations in {} worlds each, seeds {} to {}: judge what was found on others.\n",
            study_.file.filename().string(), evaluations_.size(), options_.seeds, options_.first_seed,
            options_.first_seed + options_.seeds - 1) +
            infeasible_text(infeasible_.counts(), evaluations_.size()) + figure +
            table_text({"number", "range", "start", "found"}, numbers, TableStyle::kMarkdown) + "\n" +
            table_text({"trial", "weight", "worth of the start", "of what was found"}, trials,
                       TableStyle::kMarkdown));
  }

  // The worth of each evaluation and of each trial in it, as Markdown; where nothing can draw, why.
  std::string draw_course() const {
    Figure figure{
        .title = study_.file.filename().string(), .x_column = "evaluation", .x_label = "evaluation"};
    figure.panels.push_back(
        {.y_label = "worth", .series = {{.column = "worth", .style = LineStyle::kPoints}}});
    Panel each{.y_label = "worth of each trial"};
    Columns columns = make_columns({"evaluation", "worth"});
    for (const StudiedTrial& trial : study_.trials) {
      columns.push_back({trial.name, {}});
      each.series.push_back({.column = trial.name, .label = trial.name, .style = LineStyle::kPoints});
    }
    figure.panels.push_back(std::move(each));
    for (const Evaluation& evaluation : evaluations_) {
      const auto shown = [&](double worth) { return evaluation.violated.empty() ? worth : std::nan(""); };
      std::vector<double> row{static_cast<double>(columns[0].second.size() + 1), shown(evaluation.worth)};
      std::ranges::transform(evaluation.worths, std::back_inserter(row), shown);
      add_row(columns, row);
    }
    try {
      draw(figure, columns, options_.out / "figure");
      return "![Worth of each evaluation](figure.png)";
    } catch (const PlotError& error) {
      return std::string("No figure: ") + error.what();
    }
  }

  // On their grids, so that what is written down is what was tried.
  std::vector<double> numbers_of(const std::vector<double>& x) const {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const StudiedNumber& n = study_.numbers[i];
      const double steps = std::round((n.low + x[i] * (n.high - n.low)) / n.grid);
      const double per_unit = 1.0 / n.grid;
      // A grid of 0.02 is no binary fraction, the 50 steps of a unit are.
      const double value = per_unit == std::round(per_unit) ? steps / per_unit : steps * n.grid;
      numbers.push_back(std::clamp(value, n.low, n.high));
    }
    return numbers;
  }

  const Evaluation& evaluate(const std::vector<double>& x) {
    Evaluation evaluation{.numbers = numbers_of(x), .worths = {}};
    try {
      play(evaluation);
    } catch (const sim::InputError& error) {
      if (evaluations_.empty()) throw;  // the start is the user's, and wrong
      infeasible_.add(error);
      evaluation.violated = error.limit();
      evaluation.worths.assign(study_.trials.size(), kInfeasibleWorth);
      evaluation.worth = kInfeasibleWorth;
    }
    best_ = std::max(best_, evaluation.worth);
    evaluations_.push_back(std::move(evaluation));
    log_.write(line(evaluations_.size() - 1));
    log_.flush();  // an evaluation takes minutes
    if (progress_) progress_({evaluations_.size(), options_.evaluations, evaluations_.back().worth, best_});
    return evaluations_.back();
  }

  // Sets what its numbers are worth.
  void play(Evaluation& evaluation) {
    const Experiment experiment = make_experiment(evaluation.numbers);
    const ExperimentResult result = play_experiment(
        experiment, {.log = options_.out / "trials.jsonl", .jobs = options_.jobs, .batch = options_.seeds});
    double sum = 0.0;
    double weights = 0.0;
    for (std::size_t cell = 0; cell < study_.trials.size(); ++cell) {
      double worth_of_cell = 0.0;
      for (const Trial& trial : result.cells[cell].played) {
        worth_of_cell += worth(study_.trials[cell], trial.values, durations_s_[cell]);
      }
      worth_of_cell /= static_cast<double>(options_.seeds);
      evaluation.worths.push_back(worth_of_cell);
      sum += study_.trials[cell].weight * worth_of_cell;
      weights += study_.trials[cell].weight;
    }
    evaluation.worth = sum / weights;
  }

  Values play(const StudiedTrial& trial, const sim::Scenario& scenario, std::uint64_t seed) const {
    const bool stands_up = trial.reward == StudiedTrial::Reward::kStandUp;
    return stands_up ? play_getting_up(scenario, study_.world, seed)
                     : play_in_world(scenario, study_.world, seed);
  }

  Experiment make_experiment(const std::vector<double>& numbers) {
    std::vector<std::string> texts;
    std::vector<sim::Override> shared = options_.overrides;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      shared.push_back({study_.numbers[i].path, sim::number_text(numbers[i]), study_.file.string()});
    }
    auto scenarios = std::make_shared<std::vector<sim::Scenario>>();
    Experiment experiment{.name = "study", .measures = measures()};
    durations_s_.clear();
    for (const StudiedTrial& trial : study_.trials) {
      std::vector<sim::Override> overrides = shared;
      overrides.insert(overrides.end(), trial.set.begin(), trial.set.end());
      for (const sim::Override& item : overrides) texts.insert(texts.end(), {item.path, item.value});
      scenarios->push_back(sim::read_scenario(study_.scenario, overrides));
      durations_s_.push_back(1e-6 * static_cast<double>(scenarios->back().duration_us));
      experiment.cells.push_back({.name = trial.name, .settings = {{"trial", trial.name}}});
    }
    experiment.first_seed = options_.first_seed;
    experiment.seeds = options_.seeds;
    experiment.inputs = hash_inputs(study_files(study_, *scenarios), texts);
    experiment.play = [this, scenarios](std::size_t cell, std::uint64_t seed) {
      return play(study_.trials[cell], (*scenarios)[cell], seed);
    };
    return experiment;
  }

  const Study& study_;
  const StudyOptions& options_;
  const std::function<void(const StudyProgress&)>& progress_;
  InfeasibleCounter infeasible_;
  sim::OutputFile log_;
  std::vector<double> durations_s_;  // of the trials that do not end with a fall
  std::vector<Evaluation> evaluations_;
  double best_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<std::filesystem::path> study_files(const Study& study, std::span<const sim::Scenario> trials) {
  std::vector<std::filesystem::path> files{study.file};
  for (const sim::Scenario& trial : trials) {
    for (const std::filesystem::path& file : sim::input_files(trial)) {
      if (std::ranges::find(files, file) == files.end()) files.push_back(file);
    }
  }
  return files;
}

StudyResult search_study(const Study& study, const StudyOptions& options,
                         const std::function<void(const StudyProgress&)>& progress) {
  std::filesystem::create_directories(options.out);
  const sim::FolderLock lock(options.out);
  return StudySearch(study, options, progress).search();
}

}  // namespace koboshi::tools
