#include "studio/parameters/study_runs.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/file/output_folder.h"
#include "base/table/table.h"
#include "base/text/error.h"
#include "base/text/foreign_text.h"
#include "base/text/text.h"
#include "base/yaml/yaml_tree.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kParameters = "parameters.";

bool is_study(const fs::path& file) {
  try {
    const YamlNode root = parse_yaml(read_text_file(file, "a study"), file);
    return root.find("numbers") != nullptr && root.find("trials") != nullptr;
  } catch (const InputError&) {
    return false;
  }
}

bool is_locked(const fs::path& folder) {
  try {
    const FolderLock lock(folder);
    return false;
  } catch (const InputError&) {
    return true;
  }
}

StudyRun read_state(const fs::path& file) {
  const auto bad = [&](const std::string& found) {
    return InputError(file, 0, found, "the state of a search, as `koboshi tune` writes it");
  };
  const nlohmann::json document =
      nlohmann::json::parse(read_text_file(file, "the state of a search"), nullptr, false);
  if (document.is_discarded()) throw bad("no JSON");
  try {
    StudyRun run;
    run.settings = {.study = document.at("study").get<std::string>(),
                    .out = file.parent_path(),
                    .evaluations = document.at("evaluations"),
                    .population = document.at("population"),
                    .seeds = document.at("seeds"),
                    .first_seed = document.at("first_seed"),
                    .spread = document.at("spread"),
                    .search = document.at("search"),
                    .stepper = document.at("set").value("physics.stepper", "")};
    run.paths = document.at("numbers").get<std::vector<std::string>>();
    run.trials = document.at("trials").get<std::vector<std::string>>();
    run.is_finished = document.at("state") == "finished";
    return run;
  } catch (const nlohmann::json::exception& error) {
    throw bad(one_line(error.what()));
  }
}

std::optional<double> score_of(const std::string& cell) { return parse_number(cell); }

// Columns: evaluation, the parameters, the trials, score, violated_limit.
std::size_t column_count(const StudyRun& run) { return 1 + run.paths.size() + run.trials.size() + 2; }

StudyEvaluation read_row(const Row& row, const StudyRun& run) {
  StudyEvaluation evaluation{.number = run.evaluations.size() + 1};
  auto cell = row.begin() + 1;
  for (std::size_t i = 0; i < run.paths.size(); ++i)
    evaluation.values.push_back(parse_number(*cell++).value_or(0.0));
  for (std::size_t i = 0; i < run.trials.size(); ++i) evaluation.trial_scores.push_back(score_of(*cell++));
  evaluation.score = score_of(*cell++);
  evaluation.violated = *cell;
  return evaluation;
}

void read_evaluations(const fs::path& file, StudyRun& run) {
  if (!fs::exists(file)) return;
  const std::string text = read_text_file(file, "the evaluations of a search");
  int line = 0;
  for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const Row row = csv_cells(std::string_view(text).substr(begin, end - begin));
    ++line;
    if (row.size() != column_count(run))
      throw InputError(file, line, std::to_string(row.size()) + " cells", std::to_string(column_count(run)));
    if (line > 1) run.evaluations.push_back(read_row(row, run));
  }
}

}  // namespace

std::vector<std::string> tune_arguments(const StudySettings& settings) {
  std::vector<std::string> arguments{"tune",          settings.study.string(),
                                     "--out",         settings.out.string(),
                                     "--evaluations", std::to_string(settings.evaluations),
                                     "--population",  std::to_string(settings.population),
                                     "--seeds",       std::to_string(settings.seeds),
                                     "--first-seed",  std::to_string(settings.first_seed),
                                     "--spread",      koboshi::number_text(settings.spread),
                                     "--search",      settings.search};
  if (!settings.stepper.empty()) arguments.insert(arguments.end(), {"--stepper", settings.stepper});
  if (settings.jobs > 0) arguments.insert(arguments.end(), {"--jobs", std::to_string(settings.jobs)});
  return arguments;
}

std::vector<fs::path> find_studies(const fs::path& folder) {
  std::vector<fs::path> studies;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (extension_of(entry.path()) == ".yaml" && is_study(entry.path())) studies.push_back(entry.path());
  std::ranges::sort(studies);
  return studies;
}

const StudyEvaluation* StudyRun::best() const {
  const auto found = best(1);
  return found.empty() ? nullptr : found.front();
}

std::vector<const StudyEvaluation*> StudyRun::best(std::size_t count) const {
  std::vector<const StudyEvaluation*> ranked;
  for (const StudyEvaluation& evaluation : evaluations)
    if (evaluation.score) ranked.push_back(&evaluation);
  std::ranges::stable_sort(ranked, std::greater(), [](const StudyEvaluation* one) { return *one->score; });
  if (ranked.size() > count) ranked.resize(count);
  return ranked;
}

std::optional<StudyRun> read_study_run(const fs::path& folder) {
  const fs::path state = folder / "search.json";
  if (!fs::exists(state)) return std::nullopt;
  StudyRun run = read_state(state);
  read_evaluations(folder / "evaluations.csv", run);
  run.is_running = !run.is_finished && is_locked(folder);
  return run;
}

Adoption adoption(const StudyRun& run, const StudyEvaluation& evaluation, ParameterTable table) {
  Adoption adopted;
  for (std::size_t i = 0; i < run.paths.size(); ++i) {
    const std::string& path = run.paths[i];
    const auto index = path.starts_with(kParameters) ? index_of(table, path.substr(kParameters.size()))
                                                     : std::optional<std::size_t>();
    if (index) {
      adopted.values.push_back({*index, evaluation.values[i]});
    } else {
      adopted.left_out.push_back(path);
    }
  }
  return adopted;
}

}  // namespace koboshi::studio
