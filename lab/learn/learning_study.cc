#include "lab/learn/learning_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text/error.h"
#include "base/text/text.h"
#include "base/yaml/yaml_reader.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/policy/policy.h"
#include "hal/port/period.h"
#include "simulation/policy/signal_names.h"
#include "simulation/scenario/paths.h"

namespace koboshi::lab {
namespace {

constexpr double kLearnRadPerDegree = std::numbers::pi / 180.0;
constexpr std::int64_t kLearnTick_ms = hal::kControlPeriod_us / 1'000;
// A tanh of 32767/32768 must stay within the bound after all roundings.
constexpr double kWithinBound = 0.999;

simulation::Range read_range(const YamlMap& map, const std::string& key, const NumberRange& range,
                             simulation::Range fallback) {
  if (!map.has(key)) return fallback;
  const std::vector<double> ends = map.numbers(key, 2, range);
  if (ends[0] > ends[1]) throw map.error_at(key, "a range that ends before it begins", "[low, high]");
  return {ends[0], ends[1]};
}

LearnedInput read_learned_input(const YamlValue& value) {
  const YamlMap map = value.map();
  LearnedInput input{.signal = map.text("signal"), .line = map.line_of("signal")};
  input.typical = map.number("typical", {.min = 1e-6, .max = 1e6}, 1.0);
  input.range =
      read_range(map, "range", {.min = -1e6, .max = 1e6}, {-10.0 * input.typical, 10.0 * input.typical});
  if (input.range.low == input.range.high)
    throw map.error_at("range", "a range without width", "[low, high]");
  return input;
}

LearnedOutput read_learned_output(const YamlValue& value) {
  const YamlMap map = value.map();
  LearnedOutput output{.joint = map.text("joint"), .line = map.line_of("joint")};
  output.bound_rad = map.number("bound_deg", {.min = 0.01, .max = 15.0}) * kLearnRadPerDegree;
  output.rate_rad_per_s = map.number("rate_deg_per_s", {.min = 0.1, .max = 1'400.0}) * kLearnRadPerDegree;
  return output;
}

LearningStage read_stage(const YamlValue& value, bool is_last) {
  const YamlMap map = value.map();
  constexpr NumberRange kSpeed{.min = -2.0, .max = 2.0};
  LearningStage stage{.name = map.text("name")};
  stage.world = map.one_of("world", simulation::world_names(), stage.world);
  stage.forward_m_per_s = read_range(map, "forward_m_per_s", kSpeed, {});
  stage.left_m_per_s = read_range(map, "left_m_per_s", kSpeed, {});
  stage.turn_rad_per_s = read_range(map, "turn_rad_per_s", kSpeed, {});
  stage.impulse_N_s_per_kg = read_range(map, "impulse_N_s_per_kg", {.min = 0.0, .max = 10.0}, {});
  stage.interval_s = read_range(map, "interval_s", {.min = 0.2, .max = 1'000.0}, stage.interval_s);
  if (is_last) {
    if (map.has("advance_at"))
      throw map.error_at("advance_at", "advance_at in the last stage", "no later stage, no advance_at");
  } else {
    stage.advance_at = map.number("advance_at", {.min = 0.0, .max = 1.0});
  }
  return stage;
}

std::size_t read_size(const YamlMap& map, const std::string& key, std::int64_t min, std::int64_t max,
                      std::size_t fallback) {
  return static_cast<std::size_t>(
      map.integer(key, {.min = min, .max = max}, static_cast<std::int64_t>(fallback)));
}

// Seeds are below 2^53, so that every reader of JSON keeps them.
std::uint64_t read_seed(const YamlMap& map, const std::string& key, std::uint64_t fallback) {
  return static_cast<std::uint64_t>(
      map.integer(key, {.min = 0, .max = std::int64_t{1} << 53}, static_cast<std::int64_t>(fallback)));
}

void read_network(const YamlMap& root, LearningStudy& study) {
  const YamlMap network = root.child("network");
  for (const YamlValue& value : network.list("hidden"))
    study.hidden.push_back(
        static_cast<std::size_t>(value.integer({.min = 1, .max = std::int64_t{policy::kMaxWidth}})));
  if (study.hidden.size() >= policy::kMaxLayers)
    throw network.error_at("hidden", count_text(study.hidden.size(), "hidden layer"),
                           fmt::format("at most {}", policy::kMaxLayers - 1));
  study.mirror = network.boolean("mirror", true);
  if (study.mirror && std::ranges::any_of(study.hidden, [](std::size_t width) { return width % 2 != 0; }))
    throw network.error_at("hidden", "an odd number of neurons",
                           "even numbers: with `mirror` neurons come in pairs");
  study.patience_ticks = static_cast<std::uint8_t>(
      network.integer("patience_ms",
                      {.min = kLearnTick_ms, .max = policy::kMaxPatience_ticks * kLearnTick_ms},
                      study.patience_ticks * kLearnTick_ms) /
      kLearnTick_ms);
  for (const YamlValue& value : root.list("inputs")) study.inputs.push_back(read_learned_input(value));
  for (const YamlValue& value : root.list("outputs")) study.outputs.push_back(read_learned_output(value));
}

void read_evolution(const YamlMap& search, LearningStudy& study) {
  study.population = read_size(search, "population", 2, 10'000, study.population);
  if (study.population % 2 != 0)
    throw search.error_at("population", count_text(study.population, "candidate"),
                          "an even number: candidates come in opposite pairs");
  study.noise = search.number("noise", {.min = 1e-4, .max = 1.0}, study.noise);
  study.weight_decay = search.number("weight_decay", {.min = 0.0, .max = 0.5}, study.weight_decay);
}

void read_ppo(const YamlMap& search, LearningStudy& study) {
  constexpr NumberRange kShare{.min = 0.0, .max = 1.0};
  PpoOptions& ppo = study.ppo;
  study.learning_rate = ppo.learning_rate;
  ppo.deviation = search.number("deviation", {.min = 0.02, .max = 0.5}, ppo.deviation);
  study.held_cycles =
      read_size(search, "hold_ms", kLearnTick_ms, 1'000, study.held_cycles * kLearnTick_ms) / kLearnTick_ms;
  ppo.discount = search.number("discount", kShare, ppo.discount);
  ppo.trace = search.number("trace", kShare, ppo.trace);
  ppo.clip = search.number("clip", {.min = 0.01, .max = 1.0}, ppo.clip);
  ppo.epochs = read_size(search, "epochs", 1, 100, ppo.epochs);
  ppo.minibatch = read_size(search, "minibatch", 16, 1'000'000, ppo.minibatch);
  if (!search.has("critic")) return;
  ppo.critic.clear();
  for (const YamlValue& value : search.list("critic"))
    ppo.critic.push_back(static_cast<std::size_t>(value.integer({.min = 1, .max = 1'024})));
}

void read_search(const YamlMap& root, LearningStudy& study) {
  static const std::vector<std::string> kAlgorithms{"es", "ppo"};
  const YamlMap search = root.child("search");
  const bool is_ppo = search.one_of("algorithm", kAlgorithms, "es") == "ppo";
  study.algorithm = is_ppo ? LearningAlgorithm::kPpo : LearningAlgorithm::kEvolution;
  study.algorithm_line = search.has("algorithm") ? search.line_of("algorithm") : 0;
  is_ppo ? read_ppo(search, study) : read_evolution(search, study);
  study.generations = read_size(search, "generations", 1, 1'000'000, study.generations);
  study.learning_rate = search.number("learning_rate", {.min = 1e-5, .max = 1.0}, study.learning_rate);
}

// The seeds of training and of validation must not meet.
void read_episodes(const YamlMap& root, LearningStudy& study) {
  const YamlMap episodes = root.child("episodes");
  study.episodes = read_size(episodes, "count", 1, 10'000, study.episodes);
  study.walk_s = episodes.number("walk_s", {.min = 0.1, .max = 3'600.0}, study.walk_s);
  study.first_seed = read_seed(episodes, "first_seed", study.first_seed);
  const YamlMap validation = root.child("validation");
  study.validation_episodes = read_size(validation, "count", 1, 100'000, study.validation_episodes);
  study.validate_every = read_size(validation, "every", 1, 1'000'000, study.validate_every);
  study.validation_first_seed = read_seed(validation, "first_seed", study.validation_first_seed);
  const std::uint64_t end = study.first_seed + study.generations * study.episodes;
  if (study.validation_first_seed < end &&
      study.first_seed < study.validation_first_seed + study.validation_episodes)
    throw validation.error_at(
        "first_seed",
        fmt::format("seeds {} to {}", study.validation_first_seed,
                    study.validation_first_seed + study.validation_episodes - 1),
        fmt::format("other seeds than those of training, {} to {}", study.first_seed, end - 1));
}

void read_reward(const YamlMap& root, RewardWeights& reward) {
  const auto map = root.optional_child("reward");
  if (!map) return;
  constexpr NumberRange kWeight{.min = 0.0, .max = 1e3};
  reward.survival = map->number("survival", kWeight, reward.survival);
  reward.drift = map->number("drift", kWeight, reward.drift);
  reward.turn = map->number("turn", kWeight, reward.turn);
  reward.power = map->number("power", kWeight, reward.power);
  reward.lean = map->number("lean", kWeight, reward.lean);
  reward.offset = map->number("offset", kWeight, reward.offset);
}

std::string other_side(const std::string& name) {
  if (name.starts_with("left_")) return "right_" + name.substr(5);
  if (name.starts_with("output.left_")) return "output.right_" + name.substr(12);
  return {};
}

void require_left(const LearningStudy& study, const std::string& name, int line) {
  if (study.mirror && (name.starts_with("right_") || name.starts_with("output.right_")))
    throw InputError(study.file, line, name, "names of the left side: `mirror` adds those of the right");
}

void add_output(const LearningStudy& study, const LearnedOutput& learned, const std::string& joint,
                const simulation::NamedModel& robot, tools::PolicyMap& map) {
  using enum robot::JointRole;
  const auto may_move = [](robot::JointRole role) {
    return role >= kLeftHipYaw && role <= kRightAnkleRoll && role != kLeftKnee && role != kRightKnee;
  };
  std::vector<std::string> hips_and_ankles;
  for (std::size_t i = 0; i < robot.joint_names.size(); ++i) {
    if (may_move(robot.model.joints[i].role)) hips_and_ankles.push_back(robot.joint_names[i]);
  }
  if (std::ranges::find(hips_and_ankles, joint) == hips_and_ankles.end())
    throw InputError(study.file, learned.line, one_line(joint),
                     "a hip or ankle: " + join_alternatives(hips_and_ankles));
  if (std::ranges::find(map.outputs, joint, &tools::MappedOutput::joint) != map.outputs.end())
    throw InputError(study.file, learned.line, "a second output for " + joint, "one output for a joint");
  tools::MappedOutput output{.joint = joint};
  output.index =
      static_cast<std::uint8_t>(std::ranges::find(robot.joint_names, joint) - robot.joint_names.begin());
  const double fastest_rad_per_s = fixed::to_double(robot.model.joints[output.index].max_speed);
  if (learned.rate_rad_per_s > fastest_rad_per_s)
    throw InputError(study.file, learned.line,
                     fmt::format("{:.0f} deg/s for {}", learned.rate_rad_per_s / kLearnRadPerDegree, joint),
                     fmt::format("at most the servo's {:.0f} deg/s", fastest_rad_per_s / kLearnRadPerDegree));
  output.scale_rad = kWithinBound * learned.bound_rad;
  output.bound_rad = learned.bound_rad;
  output.rate_rad_per_s = learned.rate_rad_per_s;
  map.outputs.push_back(output);
}

void add_input(const LearningStudy& study, const LearnedInput& learned, const std::string& signal,
               const std::vector<simulation::SignalName>& signals, tools::PolicyMap& map) {
  const auto found = std::ranges::find(signals, signal, &simulation::SignalName::name);
  if (found == signals.end()) {
    std::vector<std::string> names;
    for (const simulation::SignalName& each : signals) names.push_back(each.name);
    throw InputError(study.file, learned.line, one_line(signal), expected_names(signal, names));
  }
  if (std::ranges::find(map.inputs, signal, &tools::MappedInput::name) != map.inputs.end())
    throw InputError(study.file, learned.line, "a second input " + signal, "each signal once");
  map.inputs.push_back({.name = signal,
                        .signal = found->signal,
                        .unit = found->unit,
                        .scale = 1.0 / learned.typical,
                        .range = std::pair{learned.range.low, learned.range.high},
                        .column = signal});
}

}  // namespace

LearningStudy read_learning_study(const std::filesystem::path& file) {
  static const std::vector<std::string> kTargets{"residual"};
  const YamlFile yaml(file);
  const YamlMap root = yaml.root();
  root.require_version(1);
  LearningStudy study;
  study.file = file;
  study.scenario =
      simulation::read_input(root.value("scenario"), file.parent_path(), simulation::InputKind::kScenario);
  static_cast<void>(root.one_of("target", kTargets));
  study.stepper = root.one_of("stepper", sim_board::stepper_names(), study.stepper);
  study.seed = read_seed(root, "seed", study.seed);
  read_network(root, study);
  read_search(root, study);
  read_episodes(root, study);
  const std::vector<YamlValue> stages = root.list("stages");
  for (std::size_t i = 0; i < stages.size(); ++i)
    study.stages.push_back(read_stage(stages[i], i + 1 == stages.size()));
  if (study.stages.empty()) throw root.error_at("stages", "no stage", "at least one");
  if (study.inputs.empty()) throw root.error_at("inputs", "no input", "at least one");
  if (study.outputs.empty()) throw root.error_at("outputs", "no output", "at least one");
  read_reward(root, study.reward);
  yaml.finish();
  return study;
}

tools::PolicyMap learned_map(const LearningStudy& study, const simulation::NamedModel& robot) {
  tools::PolicyMap map{.name = study.file.stem().string().substr(0, policy::kPolicyNameSize),
                       .patience_ticks = study.patience_ticks};
  const bool is_ascii = std::ranges::all_of(map.name, [](char c) { return c >= ' ' && c <= '~'; });
  if (!is_ascii) map.name = "learned";
  for (const LearnedOutput& output : study.outputs) {
    require_left(study, output.joint, output.line);
    add_output(study, output, output.joint, robot, map);
    if (const std::string other = other_side(output.joint); study.mirror && !other.empty())
      add_output(study, output, other, robot, map);
  }
  if (map.outputs.size() > policy::kMaxOutputs)
    throw InputError(study.file, study.outputs.back().line, count_text(map.outputs.size(), "output"),
                     fmt::format("at most {}", policy::kMaxOutputs));
  std::vector<std::string> joints;
  for (const tools::MappedOutput& output : map.outputs) joints.push_back(output.joint);
  const auto signals = simulation::signal_names(robot.joint_names, joints);
  for (const LearnedInput& input : study.inputs) {
    require_left(study, input.signal, input.line);
    add_input(study, input, input.signal, signals, map);
    if (const std::string other = other_side(input.signal); study.mirror && !other.empty())
      add_input(study, input, other, signals, map);
  }
  if (map.inputs.size() > policy::kMaxInputs)
    throw InputError(study.file, study.inputs.back().line, count_text(map.inputs.size(), "input"),
                     fmt::format("at most {}", policy::kMaxInputs));
  return map;
}

std::string map_text(const tools::PolicyMap& map) {
  std::string text = fmt::format("version: 1\nname: {}\npatience_ms: {}\ninputs:\n", map.name,
                                 map.patience_ticks * kLearnTick_ms);
  for (const tools::MappedInput& input : map.inputs) {
    text += fmt::format("  - {{signal: {}, scale: {}", input.name, number_text(input.scale));
    if (input.range)
      text +=
          fmt::format(", range: [{}, {}]", number_text(input.range->first), number_text(input.range->second));
    text += "}\n";
  }
  text += "outputs:\n";
  const auto degrees = [](double angle_rad) {
    return number_text(std::round(angle_rad / kLearnRadPerDegree * 1e6) / 1e6);
  };
  for (const tools::MappedOutput& output : map.outputs)
    text +=
        fmt::format("  - {{joint: {}, scale_rad: {}, bound_deg: {}, rate_deg_per_s: {}}}\n", output.joint,
                    number_text(output.scale_rad), degrees(output.bound_rad), degrees(output.rate_rad_per_s));
  return text;
}

}  // namespace koboshi::lab
