#include "lab/learn/training.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "base/table/table.h"
#include "base/text/error.h"
#include "lab/cluster/search_trials.h"
#include "lab/experiment/field_table.h"
#include "lab/experiment/files.h"
#include "lab/learn/episode.h"
#include "lab/learn/explorer.h"
#include "lab/policy_search/evolution.h"
#include "lab/policy_search/mirrored_network.h"
#include "lab/policy_search/ppo.h"
#include "lab/trial/trial_recordings.h"
#include "simulation/batch/parallel.h"
#include "simulation/policy/signal_names.h"
#include "simulation/scenario/reader.h"
#include "tools/plot/figure.h"
#include "tools/policy/quantise.h"

namespace koboshi::lab {
namespace {

// Generations whose surviving share decides whether the next stage begins.
constexpr std::size_t kAdvanceWindow = 3;

std::vector<Override> episode_overrides(const LearningStudy& study, const TrainingOptions& options) {
  std::vector<Override> overrides{{"physics.stepper", study.stepper, study.file.string()}};
  overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
  return overrides;
}

MirroredNetwork network_of(const LearningStudy& study, const tools::PolicyMap& map,
                           const simulation::NamedModel& robot) {
  if (!study.mirror)
    return {MirrorImage::none(map.inputs.size()), study.hidden, MirrorImage::none(map.outputs.size()), false};
  return {mirrored_inputs(map, robot), study.hidden, mirrored_outputs(map, robot), true};
}

struct Sums {
  double reward = 0.0;
  double survived = 0.0;

  void add(const Episode& episode, const LearningStudy& study, double share) {
    reward += share * reward_of(episode, study.reward, study.walk_s);
    survived += episode.lost() ? 0.0 : share;
  }
};

PpoOptions ppo_options(const LearningStudy& study) {
  PpoOptions options = study.ppo;
  options.learning_rate = study.learning_rate;
  options.seed = study.seed;
  return options;
}

Ppo ppo_of(const LearningStudy& study, const MirroredNetwork& network, const tools::PolicyMap& map,
           const simulation::NamedModel& robot) {
  return {ppo_options(study), network, map.inputs.size(),
          study.mirror ? mirrored_outputs(map, robot) : MirrorImage::none(map.outputs.size())};
}

// Keeps what the policy has seen.
class InputRows final : public CycleObserver {
 public:
  explicit InputRows(const tools::PolicyMap& map) : map_(map) {}

  void cycle(const policy::Signals::Values& signals) override {
    std::vector<double>& row = rows.emplace_back();
    for (const tools::MappedInput& input : map_.inputs) row.push_back(signals[input.signal] * input.unit);
  }

  std::vector<std::vector<double>> rows;

 private:
  const tools::PolicyMap& map_;
};

// What the training needs to know of an episode, as a shard keeps it.
const FieldTable<Episode>& episode_fields() {
  using T = Episode;
  static const FieldTable<T> kFields{outcome_fields<T>(&T::outcome),
                                     Fields<T>{{{"walk_s"}, &T::walk_s},
                                               {{"drift_m_per_s"}, &T::drift_m_per_s},
                                               {{"turn_rad_per_s"}, &T::turn_rad_per_s},
                                               {{"power_W"}, &T::power_W},
                                               {{"lean_rad2"}, &T::lean_rad2},
                                               {{"offset"}, &T::offset},
                                               {{"policy_stopped"}, &T::policy_stopped}}};
  return kFields;
}

TrialFormat episode_format() { return {"learn", episode_fields().metrics()}; }

// The images of some networks, each made when it is first asked for, from any thread: a shard plays a part of
// them.
class LazyImages {
 public:
  using Make = std::function<std::vector<std::byte>(std::size_t)>;

  LazyImages(std::size_t count, Make make)
      : make_(std::move(make)), once_(std::make_unique<std::once_flag[]>(count)), images_(count) {}

  const std::vector<std::byte>& at(std::size_t i) {
    std::call_once(once_[i], [&] { images_[i] = make_(i); });
    return images_[i];
  }

 private:
  const Make make_;
  const std::unique_ptr<std::once_flag[]> once_;
  std::vector<std::vector<std::byte>> images_;
};

class Training {
 public:
  // With an empty folder in the options, the training writes nothing.
  Training(const LearningStudy& study, const TrainingOptions& options, SearchTrials& trials,
           const ShowTraining& progress)
      : study_(study),
        options_(options),
        trials_(trials),
        progress_(progress),
        overrides_(episode_overrides(study, options)),
        player_(study.scenario, overrides_),
        map_(learned_map(study, player_.model())),
        network_(network_of(study, map_, player_.model())),
        ppo_(ppo_of(study, network_, map_, player_.model())) {}

  TrainingResult run() {
    begin();
    while (done() < last_generation()) generation();
    if (writes() && done() == study_.generations) finish();
    return {now_.validations.front(), now_.validations.at(now_.best), done()};
  }

  std::string inputs() const;
  // Generations that are finished, and the last one of this call.
  std::uint64_t done() const { return now_.search.generation; }
  std::uint64_t last_generation() const {
    return options_.until == 0 ? study_.generations
                               : std::min<std::uint64_t>(options_.until, study_.generations);
  }

 private:
  bool writes() const { return !options_.out.empty(); }
  std::filesystem::path file(const char* name) const { return options_.out / name; }

  void begin();
  std::vector<double> first_parameters() const {
    return is_ppo() ? ppo_.start() : network_.start(study_.seed);
  }
  void generation();
  Sums evolve(nlohmann::ordered_json& line);
  Sums follow_gradient(nlohmann::ordered_json& line);
  void advance(double survived);
  using DrawCourse = std::function<EpisodePlayer::Course(std::uint64_t seed)>;
  std::vector<Episode> play(const std::string& phase, const std::vector<std::vector<double>>& networks,
                            const DrawCourse& draw, std::uint64_t first_seed, std::size_t seeds) const;
  Sums play_candidates(const std::vector<std::vector<double>>& candidates, std::vector<double>& scores) const;
  Sums explore(std::vector<Path>& paths) const;
  void validate();
  ValidationMean mean_of_validation(const std::vector<double>& weights) const;
  tools::QuantisedPolicy quantised(std::span<const double> weights,
                                   const std::vector<std::vector<double>>& rows) const;
  std::vector<std::byte> image_of(std::span<const double> weights) const {
    return quantised(weights, {std::vector<double>(map_.inputs.size(), 0.0)}).image;
  }
  void write_best() const;
  void save(const std::string& log_line);
  void finish();
  std::vector<std::vector<double>> recorded_rows(std::span<const std::byte> image) const;
  std::string draw_curve() const;
  std::string report(const tools::QuantisedPolicy& policy, std::size_t rows) const;
  bool is_ppo() const { return study_.algorithm == LearningAlgorithm::kPpo; }
  // The weights of the present network; the parameters of a search by gradients have others behind them.
  std::vector<double> weights() const {
    return {now_.search.mean.begin(),
            now_.search.mean.begin() + static_cast<std::ptrdiff_t>(network_.parameters())};
  }
  std::uint64_t generation_seed() const { return study_.first_seed + done() * study_.episodes; }
  EvolutionOptions evolution_options() const {
    return {.population = study_.population,
            .noise = study_.noise,
            .learning_rate = study_.learning_rate,
            .weight_decay = study_.weight_decay,
            .seed = study_.seed};
  }
  std::uint64_t validation_seed(std::size_t i) const { return study_.validation_first_seed + i; }
  EpisodePlayer::Course validation_course(std::uint64_t seed) const {
    return draw_course(study_.stages.back(), study_.walk_s, seed);
  }

  const LearningStudy& study_;
  const TrainingOptions& options_;
  SearchTrials& trials_;
  const ShowTraining& progress_;
  const std::vector<Override> overrides_;
  const EpisodePlayer player_;
  const tools::PolicyMap map_;
  const MirroredNetwork network_;
  const Ppo ppo_;
  Checkpoint now_;
};

tools::QuantisedPolicy Training::quantised(std::span<const double> weights,
                                           const std::vector<std::vector<double>>& rows) const {
  return tools::quantise(network_.network(weights), map_, rows, player_.model(), study_.file);
}

std::string Training::inputs() const {
  std::vector<std::filesystem::path> files{study_.file};
  for (const std::filesystem::path& each : simulation::input_files(player_.scenario())) files.push_back(each);
  std::vector<std::string> texts;
  for (const Override& item : overrides_) texts.insert(texts.end(), {item.path, item.value});
  return hash_inputs(files, texts);
}

void Training::begin() {
  now_.inputs = inputs();
  auto found = writes() ? read_checkpoint(file("state.json")) : std::nullopt;
  if (found) {
    if (found->inputs != now_.inputs)
      throw InputError(file("state.json"), 0, "a training with another study, robot or program",
                       "the same ones, or another folder by --out");
    if (found->search.mean.size() != first_parameters().size() ||
        found->best_weights.size() != network_.parameters())
      throw InputError(file("state.json"), 0, "weights of another network", "those of this study");
    now_ = std::move(*found);
    std::error_code error;
    std::filesystem::resize_file(file("log.jsonl"), now_.log_bytes, error);
    if (error) throw WriteError(file("log.jsonl"), error.value());
    return;
  }
  now_.search = SearchState::at(first_parameters());
  if (writes()) write_whole_file(file("log.jsonl"), "");
  validate();
  save("");
}

// The episodes of these networks, network by network, each with the same seeds. The phase names them in the
// files of shards: with the inputs, it decides on the networks.
std::vector<Episode> Training::play(const std::string& phase,
                                    const std::vector<std::vector<double>>& networks, const DrawCourse& draw,
                                    std::uint64_t first_seed, std::size_t seeds) const {
  LazyImages images(networks.size(), [&](std::size_t i) { return image_of(networks[i]); });
  Experiment experiment{.name = episode_format().experiment, .inputs = now_.inputs};
  for (std::size_t i = 0; i < networks.size(); ++i)
    experiment.cells.push_back({.name = fmt::format("{}, network {}", phase, i + 1), .settings = {}});
  set_trials(experiment, episode_fields(), [&](std::size_t cell, std::uint64_t seed) {
    return player_.play(images.at(cell), draw(seed), seed);
  });
  std::vector<SearchTrial> trials;
  for (std::size_t i = 0; i < networks.size() * seeds; ++i)
    trials.push_back({&experiment, {.cell = i / seeds, .seed = first_seed + i % seeds, .record = {}}});
  trials_.play(trials, [](std::size_t) {});
  std::vector<Episode> played;
  for (const SearchTrial& each : trials) played.push_back(episode_fields().trial(each.trial.record));
  return played;
}

Sums Training::play_candidates(const std::vector<std::vector<double>>& candidates,
                               std::vector<double>& scores) const {
  const LearningStage& stage = study_.stages[now_.stage];
  const std::vector<Episode> played = play(
      fmt::format("generation {}", done() + 1), candidates,
      [&](std::uint64_t seed) { return draw_course(stage, study_.walk_s, seed); }, generation_seed(),
      study_.episodes);
  Sums sums;
  scores.assign(candidates.size(), 0.0);
  const double share = 1.0 / static_cast<double>(played.size());
  for (std::size_t i = 0; i < played.size(); ++i) {
    scores[i / study_.episodes] +=
        reward_of(played[i], study_.reward, study_.walk_s) / static_cast<double>(study_.episodes);
    sums.add(played[i], study_, share);
  }
  return sums;
}

Sums Training::evolve(nlohmann::ordered_json& line) {
  Evolution evolution(evolution_options(), now_.search);
  std::vector<double> scores;
  const Sums sums = play_candidates(evolution.ask(), scores);
  const std::vector<double> before = weights();
  evolution.tell(scores);
  now_.search = evolution.state();
  double step = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) step += std::pow(now_.search.mean[i] - before[i], 2);
  line = {{"best_reward", *std::ranges::max_element(scores)}, {"step", std::sqrt(step)}};
  return sums;
}

Sums Training::explore(std::vector<Path>& paths) const {
  const std::vector<std::byte> image = image_of(weights());
  const std::vector<double> deviations = ppo_.deviations(now_.search);
  std::vector<Episode> played(study_.episodes);
  paths.resize(study_.episodes);
  simulation::for_each_parallel(study_.episodes, options_.jobs, [&](std::size_t i) {
    const std::uint64_t seed = generation_seed() + i;
    Explorer explorer(map_, deviations, study_.held_cycles, study_.reward, study_.walk_s, seed);
    played[i] =
        player_.play(image, draw_course(study_.stages[now_.stage], study_.walk_s, seed), seed, &explorer);
    paths[i] = explorer.finish(played[i].lost());
  });
  Sums sums;
  for (const Episode& each : played) sums.add(each, study_, 1.0 / static_cast<double>(played.size()));
  return sums;
}

Sums Training::follow_gradient(nlohmann::ordered_json& line) {
  std::vector<Path> paths;
  const Sums sums = explore(paths);
  std::size_t steps = 0;
  for (const Path& path : paths) steps += path.learnable_steps();
  if (steps == 0) {  // no robot has walked
    ++now_.search.generation;
    line = {{"steps", 0}};
    return sums;
  }
  const PpoProgress progress = ppo_.improve(now_.search, paths);
  double deviation = 0.0;
  for (const double each : ppo_.deviations(now_.search))
    deviation += each / static_cast<double>(map_.outputs.size());
  line = {{"steps", steps},
          {"divergence", progress.divergence},
          {"clipped", progress.clipped},
          {"value_error", progress.value_error},
          {"epochs", progress.epochs},
          {"deviation", deviation}};
  return sums;
}

void Training::generation() {
  const std::string stage = study_.stages[now_.stage].name;
  nlohmann::ordered_json details;
  const Sums sums = is_ppo() ? follow_gradient(details) : evolve(details);
  nlohmann::ordered_json line{
      {"generation", done()}, {"stage", stage}, {"reward", sums.reward}, {"survived", sums.survived}};
  line.update(details);
  if (done() % study_.validate_every == 0 || done() == study_.generations) {
    validate();
    const ValidationMean& last = now_.validations.back();
    line["validation_reward"] = last.reward;
    line["validation_survived"] = last.survived;
  }
  advance(sums.survived);
  save(line.dump() + "\n");
  if (progress_)
    progress_({done(), study_.generations, stage, sums.reward, sums.survived, now_.validations.back(),
               now_.validations[now_.best]});
}

void Training::advance(double survived) {
  const std::optional<double>& wanted = study_.stages[now_.stage].advance_at;
  if (!wanted) return;
  now_.survived.push_back(survived);
  if (now_.survived.size() > kAdvanceWindow) now_.survived.erase(now_.survived.begin());
  double sum = 0.0;
  for (const double each : now_.survived) sum += each;
  if (now_.survived.size() < kAdvanceWindow || sum < *wanted * static_cast<double>(kAdvanceWindow)) return;
  ++now_.stage;
  now_.survived.clear();
}

ValidationMean Training::mean_of_validation(const std::vector<double>& weights) const {
  const std::vector<Episode> played = play(
      fmt::format("validation after {}", done()), {weights},
      [this](std::uint64_t seed) { return validation_course(seed); }, validation_seed(0),
      study_.validation_episodes);
  ValidationMean mean{.generation = done()};
  const double share = 1.0 / static_cast<double>(played.size());
  for (const Episode& episode : played) {
    mean.reward += share * reward_of(episode, study_.reward, study_.walk_s);
    mean.survived += episode.lost() ? 0.0 : share;
    mean.drift_m_per_s += share * episode.drift_m_per_s;
    mean.turn_rad_per_s += share * episode.turn_rad_per_s;
    mean.power_W += share * episode.power_W;
    mean.lean_rad2 += share * episode.lean_rad2;
    mean.offset += share * episode.offset;
    mean.stopped += episode.policy_stopped ? share : 0.0;
  }
  return mean;
}

// The first validation is that of the engine alone: the outputs of the first network are zero.
void Training::validate() {
  const std::vector<double> weights = this->weights();
  now_.validations.push_back(mean_of_validation(weights));
  const bool is_best =
      now_.validations.size() == 1 || now_.validations.back().reward > now_.validations[now_.best].reward;
  if (!is_best) return;
  now_.best = now_.validations.size() - 1;
  now_.best_weights = weights;
  if (writes()) write_best();
}

void Training::write_best() const {
  const std::vector<std::byte> image = image_of(now_.best_weights);
  write_whole_file(file("policy.kpol"), {reinterpret_cast<const char*>(image.data()), image.size()});
  write_whole_file(file("policy.yaml"),
                   fmt::format("# Inputs and outputs of policy.kpol, generation {} of {}.\n",
                               now_.validations[now_.best].generation, study_.file.filename().string()) +
                       map_text(map_));
}

// The log first: what it has beyond the state is removed when the training resumes.
void Training::save(const std::string& log_line) {
  if (!writes()) return;
  OutputFile log(file("log.jsonl"), OutputFile::Mode::kAppend);
  log.write(log_line);
  log.close();
  now_.log_bytes += log_line.size();
  write_checkpoint(file("state.json"), now_);
}

std::vector<std::vector<double>> Training::recorded_rows(std::span<const std::byte> image) const {
  constexpr std::size_t kRecorded = 4;  // episodes: some thousand rows
  InputRows seen(map_);
  for (std::size_t i = 0; i < std::min(kRecorded, study_.validation_episodes); ++i)
    static_cast<void>(player_.play(image, validation_course(validation_seed(i)), validation_seed(i), &seen));
  return std::move(seen.rows);
}

void Training::finish() {
  const std::vector<std::byte> image = image_of(now_.best_weights);
  std::vector<std::vector<double>> rows = recorded_rows(image);
  if (rows.empty()) rows.emplace_back(map_.inputs.size(), 0.0);  // no robot has walked
  write_whole_file(file("report.md"), report(quantised(now_.best_weights, rows), rows.size()));
  TrialRecordings recording(file("best"));
  static_cast<void>(player_.play(image, validation_course(validation_seed(0)), validation_seed(0)));
  recording.keep();
}

std::string Training::draw_curve() const {
  tools::Figure figure{
      .title = study_.file.filename().string(), .x_column = "generation", .x_label = "generation"};
  figure.panels.push_back(
      {.y_label = "reward", .series = {{.column = "reward", .style = tools::LineStyle::kLinesPoints}}});
  figure.panels.push_back(
      {.y_label = "survived [%]",
       .series = {{.column = "survived", .style = tools::LineStyle::kLinesPoints, .factor = 100.0}}});
  tools::Columns columns = tools::make_columns({"generation", "reward", "survived"});
  for (const ValidationMean& each : now_.validations)
    tools::add_row(columns, {static_cast<double>(each.generation), each.reward, each.survived});
  try {
    tools::draw(figure, columns, file("curve"));
    return "![Reward and survival in the validation's episodes](curve.png)";
  } catch (const tools::PlotError& error) {
    return std::string("No figure: ") + error.what();
  }
}

std::string Training::report(const tools::QuantisedPolicy& policy, std::size_t rows) const {
  constexpr double kReportDegrees = 180.0 / std::numbers::pi;
  const ValidationMean& engine = now_.validations.front();
  const ValidationMean& best = now_.validations[now_.best];
  const auto row = [&](const char* name, double ValidationMean::*member, int decimals) {
    return Row{name, fmt::format("{:.{}f}", engine.*member, decimals),
               fmt::format("{:.{}f}", best.*member, decimals)};
  };
  std::string text = fmt::format(
      "# {}\n\n{} generations of {}{} episodes each. The best network is that of generation {}, "
      "by "
      "{} episodes of validation, seeds {} to {}, in `{}`: judge it on other seeds.\n\n{}\n\n",
      study_.file.filename().string(), study_.generations,
      is_ppo() ? "" : count_text(study_.population, "candidate") + ", ", study_.episodes, best.generation,
      study_.validation_episodes, study_.validation_first_seed,
      validation_seed(study_.validation_episodes - 1), study_.stepper, draw_curve());
  text += table_text(
      {"validation", "engine alone", "with the policy"},
      {row("reward", &ValidationMean::reward, 4), row("survived", &ValidationMean::survived, 3),
       row("drift [m/s]", &ValidationMean::drift_m_per_s, 4),
       row("turn [rad/s]", &ValidationMean::turn_rad_per_s, 4), row("power [W]", &ValidationMean::power_W, 2),
       row("lean [rad^2]", &ValidationMean::lean_rad2, 4), row("offset, share^2", &ValidationMean::offset, 4),
       row("stopped by the watchdog", &ValidationMean::stopped, 3)},
      TableStyle::kMarkdown);
  text += fmt::format(
      "\n{} weights in the image, at most {} of {} instructions in a tick. Error of the integers against "
      "floating "
      "point, over {} recorded cycles:\n\n",
      policy.weights, policy.work, policy::kMaxWork, rows);
  std::vector<Row> errors;
  for (std::size_t i = 0; i < policy.errors.size(); ++i) {
    const tools::QuantisationError& error = policy.errors[i];
    errors.push_back({map_.outputs[i].joint, fmt::format("{:.4f}", error.largest_rad * kReportDegrees),
                      fmt::format("{:.4f}", error.rms_rad * kReportDegrees),
                      fmt::format("{:.3f}", error.range_rad * kReportDegrees)});
  }
  return text + table_text({"joint", "largest error [deg]", "rms error [deg]", "largest offset [deg]"},
                           errors, TableStyle::kMarkdown);
}

}  // namespace

TrainingResult train(const LearningStudy& study, const TrainingOptions& options,
                     const ShowTraining& progress) {
  static_cast<void>(
      training_inputs(study, options));  // throws for what it cannot read, before the first write
  std::filesystem::create_directories(options.out);
  const FolderLock lock(options.out);
  const auto trials = make_passing_trials(options.jobs);
  return Training(study, options, *trials, progress).run();
}

// Shards keep an episode's score, and a gradient needs all of its steps.
void require_shards(const LearningStudy& study) {
  if (study.algorithm == LearningAlgorithm::kPpo)
    throw InputError(study.file, study.algorithm_line, "algorithm ppo in shards", "es, or one program");
}

std::string training_inputs(const LearningStudy& study, const TrainingOptions& options) {
  const auto none = make_no_trials();
  const ShowTraining silent;
  return Training(study, options, *none, silent).inputs();
}

TrainingResult play_training_shard(const LearningStudy& study, const TrainingOptions& options,
                                   const Shard& shard, const ShowTraining& progress) {
  require_shards(study);
  const auto trials = make_shard_trials(options.out, shard, episode_format(), options.jobs);
  TrainingOptions silent = options;
  silent.out.clear();
  return Training(study, silent, *trials, progress).run();
}

TrainingResult merge_training(const LearningStudy& study, const TrainingOptions& options, std::size_t shards,
                              const ShowTraining& progress) {
  require_shards(study);
  TrainingResult result;
  std::string so_far;
  const auto merge = [&](const std::filesystem::path& folder) {
    TrainingOptions beside = options;
    beside.out = folder;
    const auto trials = make_merged_trials(options.out, shards, episode_format(), {});
    Training training(study, beside, *trials, progress);
    try {
      result = training.run();
    } catch (const TrialsMissing&) {
      so_far = fmt::format("{} of {} generations", training.done(), training.last_generation());
      throw;
    }
  };
  merge_into(options.out, merge, [&] { return so_far; });
  return result;
}

std::vector<ShardProgress> training_progress(const LearningStudy& study, const TrainingOptions& options,
                                             std::size_t shards) {
  require_shards(study);
  const auto trials = make_merged_trials(options.out, shards, episode_format(), {});
  TrainingOptions silent = options;
  silent.out.clear();
  const ShowTraining nobody;
  Training training(study, silent, *trials, nobody);
  std::size_t left = 0;
  try {
    static_cast<void>(training.run());
  } catch (const TrialsMissing& error) {
    left = error.missing + (training.last_generation() - training.done()) * study.population * study.episodes;
  }
  return search_progress(options.out, shards, left);
}

}  // namespace koboshi::lab
