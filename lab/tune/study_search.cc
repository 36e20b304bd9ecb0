#include "lab/tune/study_search.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "base/text/text.h"
#include "lab/cluster/search_trials.h"
#include "lab/experiment/files.h"
#include "lab/experiment/report.h"
#include "lab/trial/getting_up.h"
#include "lab/trial/motion_measure.h"
#include "lab/trial/scenario_trial.h"
#include "lab/tune/checked_motions.h"
#include "lab/tune/cma_es.h"
#include "lab/tune/infeasible.h"
#include "lab/tune/lost_trials.h"
#include "lab/tune/optimiser.h"
#include "simulation/assembly/prepared_scenario.h"
#include "simulation/disturbance/world_text.h"
#include "simulation/record/summary.h"
#include "simulation/scenario/reader.h"
#include "tools/plot/figure.h"

namespace koboshi::lab {
namespace {

// Below the score of any run, yet near it: optimisers rank candidates, and some fit models to their values.
constexpr double kInfeasibleWorth = -10.0;
constexpr const char* kInfeasible = "infeasible: ";  // begins the error of a trial that could not be built
constexpr const char* kTrials = "trials.jsonl";

const FieldTable<StudyTrial>& trial_fields() {
  using T = StudyTrial;
  using Walk = simulation::WalkSummary;
  static const FieldTable<T> kFields{outcome_fields<T>(&T::outcome),
                                     Fields<T>{{{"distance_m"}, &T::walk, &Walk::distance_m},
                                               {{"speed_m_per_s"}, &T::walk, &Walk::speed_m_per_s},
                                               {{"lateral_drift_m"}, &T::walk, &Walk::lateral_drift_m},
                                               {{"heading_drift_rad"}, &T::walk, &Walk::heading_drift_rad},
                                               {{"duration_s"}, &T::duration_s},
                                               {{"stood_s"}, &T::stood_s},
                                               {{"uprightness"}, &T::uprightness},
                                               {{"achieved"}, &T::achieved}}};
  return kFields;
}

using Points = std::vector<std::vector<double>>;

class StudySearch {
 public:
  // With an empty folder in the options, the search writes nothing.
  StudySearch(const Study& study, const StudyOptions& options, SearchTrials& trials,
              const ShowProgress& progress)
      : study_(study),
        options_(options),
        trials_(trials),
        progress_([this, progress](const SearchProgress& now) {
          write_state(now, "running");
          if (progress) progress(now);
        }),
        search_(setup(), options, progress_) {
    write_state({.total = options.evaluations}, "running");
  }

  SearchResult search() {
    if (options_.method == Method::kNsga2) {
      const auto losses = [this](const std::vector<double>& x) {
        evaluate({x});
        return losses_of(search_.candidates().back());
      };
      minimise_each(losses, study_.trials.size(), start_of(study_.numbers),
                    {.evaluations = options_.evaluations,
                     .population = options_.population,
                     .spread = options_.spread});
    } else {
      search_with_islands();
    }
    SearchResult result = search_.finish();
    result.lost = lost_.text();
    if (options_.out.empty()) return result;
    std::string text;
    for (const auto& [path, value] : result.numbers) text += path + ": " + number_text(value) + "\n";
    write_whole_file(options_.out / "best.yaml", text);
    if (options_.method == Method::kNsga2) write_front();
    write_report(search_.best());
    write_state({search_.counts(), options_.evaluations, 0.0, result.score}, "finished");
    return result;
  }

  std::vector<double> start_values() const { return values_at(study_.numbers, start_of(study_.numbers)); }
  // Candidates whose scores are known.
  std::size_t done() const { return search_.candidates().size(); }

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
            .infeasible = {.scores = std::vector(study_.trials.size(), kInfeasibleWorth),
                           .score = kInfeasibleWorth},
            .columns = columns,
            .cells = cells};
  }

  // Writes the state that a program needs to watch or resume the search.
  void write_state(const SearchProgress& now, const char* state) const {
    if (options_.out.empty()) return;
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
                                    {"islands", options_.islands},
                                    {"migrate", options_.migrate},
                                    {"first_seed", options_.first_seed},
                                    {"seeds", options_.seeds},
                                    {"set", overrides},
                                    {"numbers", numbers},
                                    {"trials", trials},
                                    {"state", state},
                                    {"done", now.done.candidates},
                                    {"evaluated", now.done.evaluated}};
    if (now.done.candidates > 0) document["best"] = now.best;
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
    write_whole_file(options_.out / "report.md",
                     fmt::format("# {}\n\n{}, in {} each, seeds {} to {}: judge what was found on others.\n",
                                 study_.file.filename().string(), counts_text(search_.counts()),
                                 count_text(options_.seeds, "world"), options_.first_seed,
                                 options_.first_seed + options_.seeds - 1) +
                         infeasible_text(search_.infeasible().counts(), search_.candidates().size()) +
                         lost_.text() + figure +
                         table_text({"number", "range", "start", "found"}, numbers, TableStyle::kMarkdown) +
                         "\n" +
                         table_text({"trial", "weight", "score of the start", "score of the result"}, trials,
                                    TableStyle::kMarkdown));
  }

  // Draws the score of each evaluation and of each trial in it. Returns the Markdown that shows the figure,
  // or the reason why none could be drawn.
  std::string draw_course() const {
    tools::Figure figure{
        .title = study_.file.filename().string(), .x_column = "evaluation", .x_label = "evaluation"};
    figure.panels.push_back(
        {.y_label = "score", .series = {{.column = "score", .style = tools::LineStyle::kPoints}}});
    tools::Panel each{.y_label = "score of each trial"};
    tools::Columns columns = tools::make_columns({"evaluation", "score"});
    for (const StudiedTrial& trial : study_.trials) {
      columns.push_back({trial.name, {}});
      each.series.push_back({.column = trial.name, .label = trial.name, .style = tools::LineStyle::kPoints});
    }
    figure.panels.push_back(std::move(each));
    for (const Candidate& candidate : search_.candidates()) {
      const auto shown = [&](double score) { return candidate.violated.empty() ? score : std::nan(""); };
      std::vector<double> row{static_cast<double>(columns[0].second.size() + 1), shown(candidate.score)};
      std::ranges::transform(candidate.scores, std::back_inserter(row), shown);
      tools::add_row(columns, row);
    }
    try {
      tools::draw(figure, columns, options_.out / "figure");
      return "![Score of each evaluation](figure.png)";
    } catch (const tools::PlotError& error) {
      return std::string("No figure: ") + error.what();
    }
  }

  // A generation is that of all islands, and a barrier: all candidates are evaluated before the strategies
  // learn from any, each in the order of their numbers.
  void search_with_islands() {
    std::vector<CmaEs> islands;
    for (std::size_t i = 0; i < options_.islands; ++i) {
      islands.emplace_back(start_of(study_.numbers), CmaEsOptions{.population = options_.population,
                                                                  .spread = options_.spread,
                                                                  .seed = static_cast<std::uint32_t>(i + 1)});
    }
    const std::size_t generations =
        std::max<std::size_t>(1, options_.evaluations / (options_.population * options_.islands));
    for (std::size_t generation = 1; generation <= generations; ++generation) {
      Points points;
      for (const CmaEs& island : islands)
        points.insert(points.end(), island.ask().begin(), island.ask().end());
      const std::size_t first = search_.candidates().size();
      evaluate(points);
      std::size_t number = first;
      for (CmaEs& island : islands) {
        for (std::size_t i = 0; i < options_.population; ++i)
          island.tell(i, -search_.candidates()[number++].score);
      }
      if (options_.migrate > 0 && generation % options_.migrate == 0) migrate(islands);
    }
  }

  // A candidate, and the experiment that it is if it is feasible.
  struct Evaluation {
    Candidate candidate{};
    std::optional<Experiment> experiment{};
    std::optional<InputError> error{};
    std::vector<double> durations_s{};  // of the trials that do not end with a fall, by cell
    std::size_t first_trial = 0;        // in the generation
    std::size_t missing = 0;            // trials without a record
  };

  // Evaluates points of the unit box, and adds the candidates in their order, each as soon as its trials and
  // those of all before it are known.
  void evaluate(const Points& points) {
    std::vector<Evaluation> evaluations;
    for (const std::vector<double>& x : points) evaluations.push_back(begin(x));
    std::vector<SearchTrial> trials;
    std::vector<std::size_t> owners;
    for (std::size_t i = 0; i < evaluations.size(); ++i) {
      Evaluation& evaluation = evaluations[i];
      if (!evaluation.experiment) continue;
      evaluation.first_trial = trials.size();
      for (std::size_t seed = 0; seed < options_.seeds; ++seed) {
        for (std::size_t cell = 0; cell < study_.trials.size(); ++cell)
          trials.push_back({&*evaluation.experiment, {cell, options_.first_seed + seed}});
      }
      evaluation.missing = trials.size() - evaluation.first_trial;
      owners.insert(owners.end(), evaluation.missing, i);
    }
    std::size_t next = 0;
    const auto add_those_that_are_known = [&] {
      for (; next < evaluations.size() && evaluations[next].missing == 0; ++next)
        finish(evaluations[next], trials);
    };
    add_those_that_are_known();  // the start may be infeasible, or a generation
    trials_.play(trials, [&](std::size_t number) {
      --evaluations[owners[number]].missing;
      add_those_that_are_known();
    });
  }

  Evaluation begin(const std::vector<double>& x) {
    Evaluation evaluation{.candidate = {.numbers = values_at(study_.numbers, x)}};
    try {
      evaluation.experiment = make_experiment(evaluation.candidate.numbers, evaluation.durations_s);
    } catch (const InputError& error) {
      evaluation.error = error;
    }
    return evaluation;
  }

  // A limit may show only when a simulation is built. The first trial in order counts.
  void find_violated_limit(Evaluation& evaluation, const std::vector<SearchTrial>& trials) const {
    const std::size_t count = options_.seeds * study_.trials.size();
    for (std::size_t i = 0; i < count && !evaluation.error; ++i) {
      const std::string& error = trials[evaluation.first_trial + i].trial.record.error;
      if (error.starts_with(kInfeasible))
        evaluation.error.emplace(study_.file, 0, error, "a feasible candidate",
                                 error.substr(std::string_view(kInfeasible).size()));
    }
  }

  void finish(Evaluation& evaluation, const std::vector<SearchTrial>& trials) {
    if (evaluation.experiment) find_violated_limit(evaluation, trials);
    if (evaluation.error) {
      search_.add_infeasible(std::move(evaluation.candidate), *evaluation.error);
      return;
    }
    set_scores(evaluation, trials);
    search_.add(std::move(evaluation.candidate));
  }

  void set_scores(Evaluation& evaluation, const std::vector<SearchTrial>& trials) {
    Candidate& candidate = evaluation.candidate;
    double sum = 0.0;
    double weights = 0.0;
    for (std::size_t cell = 0; cell < study_.trials.size(); ++cell) {
      const StudiedTrial& studied = study_.trials[cell];
      double mean = 0.0;
      for (std::size_t seed = 0; seed < options_.seeds; ++seed) {
        const std::size_t number = evaluation.first_trial + seed * study_.trials.size() + cell;
        const StudyTrial trial = trial_fields().trial(trials[number].trial.record);
        mean += score(studied, trial, evaluation.durations_s[cell]);
        lost_.add(trial);
      }
      mean /= static_cast<double>(options_.seeds);
      candidate.scores.push_back(mean);
      sum += studied.weight * mean;
      weights += studied.weight;
    }
    candidate.score = sum / weights;
  }

  static StudyTrial play(const StudiedTrial& trial, const simulation::Scenario& scenario,
                         std::uint64_t seed) {
    if (trial.reward == StudiedTrial::Reward::kStandUp) return {play_getting_up(scenario, seed)};
    const std::unique_ptr<MotionMeasure> measure = measure_of(trial.reward);
    if (!measure) return {{play_in_world(scenario, seed)}};
    const bool lies = trial.reward == StudiedTrial::Reward::kPushUps;
    const auto is_over = [&](const simulation::Simulation& simulation,
                             const simulation::RunRecorder& recorder) {
      measure->observe(simulation, recorder);
      return !lies && recorder.fell();
    };
    StudyTrial played{{watch_in_world(scenario, seed, is_over)}};
    played.achieved = measure->value();
    return played;
  }

  // Nothing for the rewards of walking, standing and getting up.
  static std::unique_ptr<MotionMeasure> measure_of(StudiedTrial::Reward reward) {
    using enum StudiedTrial::Reward;
    if (reward == kOneLeg) return std::make_unique<OneLegTime>();
    if (reward == kBallSpeed) return std::make_unique<BallSpeed>();
    if (reward == kPushUps) return std::make_unique<PushUps>();
    return nullptr;
  }

 public:
  // Throws InputError for a start that cannot be played: it is the user's.
  void check_start() {
    std::vector<double> durations_s;
    static_cast<void>(make_experiment(start_values(), durations_s));
    for (const simulation::Scenario& scenario : scenarios_of(start_values()))
      static_cast<void>(simulation::prepare(scenario));
  }

  // The experiment of these parameters. Throws InputError for infeasible ones.
  Experiment make_experiment(const std::vector<double>& numbers, std::vector<double>& durations_s) {
    std::vector<std::string> texts;
    const std::vector<simulation::Scenario> scenarios = scenarios_of(numbers, &texts);
    Experiment experiment{"study"};
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
      motions_.check(scenarios[i]);
      durations_s.push_back(1e-6 * static_cast<double>(scenarios[i].duration_us));
      const std::string& name = study_.trials[i].name;
      experiment.cells.push_back({.name = name, .settings = {{"trial", name}}});
    }
    for (const auto& [factor, range] : simulation::range_texts(simulation::world_named(study_.world)))
      texts.insert(texts.end(), {factor, range});
    experiment.first_seed = options_.first_seed;
    experiment.seeds = options_.seeds;
    experiment.inputs = hash_inputs(study_files(study_, scenarios), texts);
    // The error of the start is the user's. Others are results, which every shard has to know.
    const bool is_start = search_.candidates().empty() && numbers == start_values();
    set_trials(experiment, trial_fields(), [this, scenarios, is_start](std::size_t cell, std::uint64_t seed) {
      try {
        return play(study_.trials[cell], scenarios[cell], seed);
      } catch (const InputError& error) {
        if (is_start) throw;
        StudyTrial infeasible;
        infeasible.error = kInfeasible + error.limit();
        return infeasible;
      }
    });
    return experiment;
  }

 private:
  // The scenarios of the trials with these parameters. `texts` receives what they override.
  std::vector<simulation::Scenario> scenarios_of(const std::vector<double>& numbers,
                                                 std::vector<std::string>* texts = nullptr) const {
    std::vector<Override> shared = options_.overrides;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      shared.push_back({study_.numbers[i].path, number_text(numbers[i]), study_.file.string()});
    std::vector<simulation::Scenario> scenarios;
    for (const StudiedTrial& trial : study_.trials) {
      std::vector<Override> overrides = shared;
      overrides.insert(overrides.end(), trial.set.begin(), trial.set.end());
      if (texts != nullptr)
        for (const Override& item : overrides) texts->insert(texts->end(), {item.path, item.value});
      scenarios.push_back(simulation::read_scenario(study_.scenario, overrides));
      scenarios.back().world = {simulation::world_named(study_.world), std::nullopt};
    }
    return scenarios;
  }

  const Study& study_;
  const StudyOptions& options_;
  SearchTrials& trials_;
  const ShowProgress progress_;
  CheckedMotions motions_;
  Search search_;
  LostTrials lost_;
};

// Before the first write.
void check_start(const Study& study, StudyOptions options) {
  options.out.clear();
  const auto none = make_no_trials();
  StudySearch(study, options, *none, {}).check_start();
}

void check_shards(const StudyOptions& options) {
  if (options.method != Method::kCmaEs) throw InputError("--search", 0, "nsga-2 in shards", "cma-es");
}

TrialFormat trial_format() { return {"study", trial_fields().metrics()}; }

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
  check_start(study, options);
  std::filesystem::create_directories(options.out);
  const FolderLock lock(options.out);
  const auto trials = make_local_trials(options.out / kTrials, trial_format(), options.jobs);
  return StudySearch(study, options, *trials, progress).search();
}

std::string study_inputs(const Study& study, const StudyOptions& options) {
  check_shards(options);
  StudyOptions silent = options;
  silent.out.clear();
  const auto none = make_no_trials();
  StudySearch search(study, silent, *none, {});
  search.check_start();
  std::vector<double> durations_s;
  return search.make_experiment(search.start_values(), durations_s).inputs;
}

SearchResult play_study_shard(const Study& study, const StudyOptions& options, const Shard& shard,
                              const ShowProgress& progress) {
  check_shards(options);
  const auto trials = make_shard_trials(options.out, shard, trial_format(), options.jobs);
  StudyOptions silent = options;
  silent.out.clear();
  return StudySearch(study, silent, *trials, progress).search();
}

SearchResult merge_study(const Study& study, const StudyOptions& options, std::size_t shards,
                         const ShowProgress& progress) {
  check_shards(options);
  SearchResult result;
  CandidateCounts done;
  const auto merge = [&](const std::filesystem::path& folder) {
    StudyOptions beside = options;
    beside.out = folder;
    const auto trials = make_merged_trials(options.out, shards, trial_format(), folder / kTrials);
    result = StudySearch(study, beside, *trials, [&](const SearchProgress& now) {
               done = now.done;
               if (progress) progress(now);
             }).search();
  };
  merge_into(options.out, merge,
             [&] { return fmt::format("{} of {} candidates", done.candidates, options.evaluations); });
  return result;
}

std::vector<ShardProgress> study_progress(const Study& study, const StudyOptions& options,
                                          std::size_t shards) {
  check_shards(options);
  StudyOptions silent = options;
  silent.out.clear();
  const auto trials = make_merged_trials(options.out, shards, trial_format(), {});
  StudySearch search(study, silent, *trials, {});
  std::size_t left = 0;
  try {
    static_cast<void>(search.search());
  } catch (const TrialsMissing& error) {
    // As many trials as all candidates have that are not evaluated, if all of them are feasible.
    left = std::max(error.missing, (options.evaluations - std::min(options.evaluations, search.done())) *
                                       options.seeds * study.trials.size());
  }
  return search_progress(options.out, shards, left);
}

}  // namespace koboshi::lab
