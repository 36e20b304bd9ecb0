#include "lab/learn/training.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "base/file/output_file.h"
#include "base/file/output_folder.h"
#include "base/table/table.h"
#include "base/text/error.h"
#include "lab/experiment/files.h"
#include "lab/learn/episode.h"
#include "lab/learn/mirrored_network.h"
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
};

class Training {
 public:
  Training(const LearningStudy& study, const TrainingOptions& options,
           const std::function<void(const TrainingProgress&)>& progress)
      : study_(study),
        options_(options),
        progress_(progress),
        overrides_(episode_overrides(study, options)),
        player_(study.scenario, overrides_),
        map_(learned_map(study, player_.model())),
        network_(network_of(study, map_, player_.model())) {}

  TrainingResult run() {
    begin();
    const std::uint64_t until = options_.until == 0
                                    ? study_.generations
                                    : std::min<std::uint64_t>(options_.until, study_.generations);
    while (evolution_->state().generation < until) generation();
    if (evolution_->state().generation == study_.generations) finish();
    return {now_.validations.front(), now_.validations.at(now_.best), evolution_->state().generation};
  }

 private:
  std::filesystem::path file(const char* name) const { return options_.out / name; }

  void begin();
  void generation();
  void advance(double survived);
  Sums play_candidates(const std::vector<std::vector<double>>& candidates, std::vector<double>& scores) const;
  void validate();
  ValidationMean mean_of_validation(std::span<const std::byte> image) const;
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
  const std::function<void(const TrainingProgress&)>& progress_;
  const std::vector<Override> overrides_;
  const EpisodePlayer player_;
  const tools::PolicyMap map_;
  const MirroredNetwork network_;
  Checkpoint now_;
  std::optional<Evolution> evolution_;
};

tools::QuantisedPolicy Training::quantised(std::span<const double> weights,
                                           const std::vector<std::vector<double>>& rows) const {
  return tools::quantise(network_.network(weights), map_, rows, player_.model(), study_.file);
}

void Training::begin() {
  std::vector<std::filesystem::path> files{study_.file};
  for (const std::filesystem::path& each : simulation::input_files(player_.scenario())) files.push_back(each);
  std::vector<std::string> texts;
  for (const Override& item : overrides_) texts.insert(texts.end(), {item.path, item.value});
  const std::string inputs = hash_inputs(files, texts);
  if (auto found = read_checkpoint(file("state.json"))) {
    if (found->inputs != inputs)
      throw InputError(file("state.json"), 0, "a training with another study, robot or program",
                       "the same ones, or another folder by --out");
    if (found->evolution.mean.size() != network_.parameters())
      throw InputError(file("state.json"), 0, "weights of another network", "those of this study");
    now_ = std::move(*found);
    evolution_.emplace(evolution_options(), now_.evolution);
    std::error_code error;
    std::filesystem::resize_file(file("log.jsonl"), now_.log_bytes, error);
    if (error) throw WriteError(file("log.jsonl"), error.value());
    return;
  }
  now_.inputs = inputs;
  evolution_.emplace(evolution_options(), network_.start(study_.seed));
  write_whole_file(file("log.jsonl"), "");
  validate();
  save("");
}

Sums Training::play_candidates(const std::vector<std::vector<double>>& candidates,
                               std::vector<double>& scores) const {
  std::vector<std::vector<std::byte>> images(candidates.size());
  simulation::for_each_parallel(candidates.size(), options_.jobs,
                                [&](std::size_t i) { images[i] = image_of(candidates[i]); });
  const LearningStage& stage = study_.stages[now_.stage];
  const std::uint64_t first_seed = study_.first_seed + evolution_->state().generation * study_.episodes;
  std::vector<Episode> played(candidates.size() * study_.episodes);
  simulation::for_each_parallel(played.size(), options_.jobs, [&](std::size_t i) {
    const std::uint64_t seed = first_seed + i % study_.episodes;
    played[i] = player_.play(images[i / study_.episodes], draw_course(stage, study_.walk_s, seed), seed);
  });
  Sums sums;
  scores.assign(candidates.size(), 0.0);
  const double share = 1.0 / static_cast<double>(played.size());
  for (std::size_t i = 0; i < played.size(); ++i) {
    const double reward = reward_of(played[i], study_.reward, study_.walk_s);
    scores[i / study_.episodes] += reward / static_cast<double>(study_.episodes);
    sums.reward += share * reward;
    sums.survived += played[i].lost() ? 0.0 : share;
  }
  return sums;
}

void Training::generation() {
  std::vector<double> scores;
  const Sums sums = play_candidates(evolution_->ask(), scores);
  const std::string stage = study_.stages[now_.stage].name;
  const std::vector<double> before = evolution_->state().mean;
  evolution_->tell(scores);
  const EvolutionState& state = evolution_->state();
  double step = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) step += std::pow(state.mean[i] - before[i], 2);
  nlohmann::ordered_json line{
      {"generation", state.generation}, {"stage", stage},
      {"reward", sums.reward},          {"best_reward", *std::ranges::max_element(scores)},
      {"survived", sums.survived},      {"step", std::sqrt(step)}};
  if (state.generation % study_.validate_every == 0 || state.generation == study_.generations) {
    validate();
    const ValidationMean& last = now_.validations.back();
    line["validation_reward"] = last.reward;
    line["validation_survived"] = last.survived;
  }
  advance(sums.survived);
  save(line.dump() + "\n");
  if (progress_)
    progress_({state.generation, study_.generations, stage, sums.reward, sums.survived,
               now_.validations.back(), now_.validations[now_.best]});
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

ValidationMean Training::mean_of_validation(std::span<const std::byte> image) const {
  std::vector<Episode> played(study_.validation_episodes);
  simulation::for_each_parallel(played.size(), options_.jobs, [&](std::size_t i) {
    played[i] = player_.play(image, validation_course(validation_seed(i)), validation_seed(i));
  });
  ValidationMean mean{.generation = evolution_->state().generation};
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
  const std::vector<double>& weights = evolution_->state().mean;
  now_.validations.push_back(mean_of_validation(image_of(weights)));
  const bool is_best =
      now_.validations.size() == 1 || now_.validations.back().reward > now_.validations[now_.best].reward;
  if (!is_best) return;
  now_.best = now_.validations.size() - 1;
  now_.best_weights = weights;
  write_best();
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
  OutputFile log(file("log.jsonl"), OutputFile::Mode::kAppend);
  log.write(log_line);
  log.close();
  now_.log_bytes += log_line.size();
  now_.evolution = evolution_->state();
  write_checkpoint(file("state.json"), now_);
}

std::vector<std::vector<double>> Training::recorded_rows(std::span<const std::byte> image) const {
  constexpr std::size_t kRecorded = 4;  // episodes: some thousand rows
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < std::min(kRecorded, study_.validation_episodes); ++i) {
    static_cast<void>(player_.play(image, validation_course(validation_seed(i)), validation_seed(i),
                                   [&](const policy::Signals::Values& signals) {
                                     std::vector<double>& row = rows.emplace_back();
                                     for (const tools::MappedInput& input : map_.inputs)
                                       row.push_back(signals[input.signal] * input.unit);
                                   }));
  }
  return rows;
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
      "# {}\n\n{} generations of {} candidates, {} episodes each. The best network is that of generation {}, "
      "by "
      "{} episodes of validation, seeds {} to {}, in `{}`: judge it on other seeds.\n\n{}\n\n",
      study_.file.filename().string(), study_.generations, study_.population, study_.episodes,
      best.generation, study_.validation_episodes, study_.validation_first_seed,
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
                     const std::function<void(const TrainingProgress&)>& progress) {
  std::filesystem::create_directories(options.out);
  const FolderLock lock(options.out);
  return Training(study, options, progress).run();
}

}  // namespace koboshi::lab
