#include "tools/tune/study_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "sim_board/input/text.h"
#include "sim_board/record/output_file.h"
#include "sim_board/scenario/reader.h"
#include "tools/experiment/files.h"
#include "tools/experiment/scenario_trial.h"
#include "tools/tune/optimiser.h"

namespace koboshi::tools {
namespace {

std::vector<Measure> measures() {
  using enum Measure::Kind;
  return {{.name = "fell", .kind = kEvent},  {.name = "distance_m"},        {.name = "speed_m_per_s"},
          {.name = "lateral_drift_m"},       {.name = "heading_drift_rad"}, {.name = "duration_s"},
          {.name = "failed", .kind = kEvent}};
}

class StudySearch {
 public:
  StudySearch(const Study& study, const StudyOptions& options,
              const std::function<void(const StudyProgress&)>& progress)
      : study_(study), options_(options), progress_(progress), log_(options.out / "evaluations.csv") {
    std::string head = "evaluation";
    for (const StudiedNumber& number : study.numbers) head += "," + number.path;
    for (const StudiedTrial& trial : study.trials) head += "," + trial.name;
    log_.write(head + ",worth\n");
  }

  StudyResult search() {
    std::vector<double> start;
    for (const StudiedNumber& n : study_.numbers) start.push_back((n.start - n.low) / (n.high - n.low));
    const std::vector<double> best = minimise(
        [this](const std::vector<double>& x) { return -evaluate(numbers_of(x)); }, start,
        {.evaluations = options_.evaluations, .population = options_.population, .spread = options_.spread});
    log_.close();
    StudyResult result{.numbers = {}, .worth = best_};
    std::string text;
    const std::vector<double> numbers = numbers_of(best);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      result.numbers.emplace_back(study_.numbers[i].path, numbers[i]);
      text += study_.numbers[i].path + ": " + sim::number_text(numbers[i]) + "\n";
    }
    sim::write_whole_file(options_.out / "best.yaml", text);
    return result;
  }

 private:
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

  double evaluate(const std::vector<double>& numbers) {
    const Experiment experiment = make_experiment(numbers);
    const ExperimentResult result = play_experiment(
        experiment, {.log = options_.out / "trials.jsonl", .jobs = options_.jobs, .batch = options_.seeds});
    std::string line = std::to_string(++done_);
    for (const double number : numbers) line += "," + sim::number_text(number);
    double sum = 0.0;
    double weights = 0.0;
    for (std::size_t cell = 0; cell < study_.trials.size(); ++cell) {
      double worth_of_cell = 0.0;
      for (const Trial& trial : result.cells[cell].played) {
        worth_of_cell += worth(study_.trials[cell], trial.values, durations_s_[cell]);
      }
      worth_of_cell /= static_cast<double>(options_.seeds);
      line += "," + sim::number_text(worth_of_cell);
      sum += study_.trials[cell].weight * worth_of_cell;
      weights += study_.trials[cell].weight;
    }
    const double mean = sum / weights;
    best_ = std::max(best_, mean);
    log_.write(line + "," + sim::number_text(mean) + "\n");
    log_.flush();  // an evaluation takes minutes
    if (progress_) progress_({done_, options_.evaluations, mean, best_});
    return mean;
  }

  Experiment make_experiment(const std::vector<double>& numbers) {
    std::vector<std::string> texts;
    std::vector<sim::Override> shared = options_.overrides;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      shared.push_back({study_.numbers[i].path, sim::number_text(numbers[i])});
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
    const std::filesystem::path files[] = {study_.file, study_.scenario, scenarios->front().robot};
    experiment.inputs = hash_inputs(files, texts);
    experiment.play = [scenarios, world = study_.world](std::size_t cell, std::uint64_t seed) {
      return play_in_world((*scenarios)[cell], world, seed);
    };
    return experiment;
  }

  const Study& study_;
  const StudyOptions& options_;
  const std::function<void(const StudyProgress&)>& progress_;
  sim::OutputFile log_;
  std::vector<double> durations_s_;  // of the trials that do not end with a fall
  std::size_t done_ = 0;
  double best_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

StudyResult search_study(const Study& study, const StudyOptions& options,
                         const std::function<void(const StudyProgress&)>& progress) {
  std::filesystem::create_directories(options.out);
  return StudySearch(study, options, progress).search();
}

}  // namespace koboshi::tools
