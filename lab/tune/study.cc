#include "lab/tune/study.h"

#include <algorithm>
#include <cmath>

#include "base/yaml/yaml_reader.h"
#include "simulation/disturbance/world_ranges.h"
#include "simulation/scenario/paths.h"

namespace koboshi::lab {
namespace {

constexpr NumberRange kAny{.min = -1e6, .max = 1e6};

SearchedNumber read_number(const std::string& path, const YamlValue& value) {
  const YamlMap map = value.map();
  const std::vector<double> range = map.numbers("range", 2, kAny);
  if (!(range[0] < range[1]))
    throw map.error_at("range", "a range that ends before it begins", "[low, high]");
  SearchedNumber number{.path = path, .low = range[0], .high = range[1]};
  number.grid = map.number("grid", {.min = 1e-9, .max = range[1] - range[0]});
  number.start = map.number("start", {.min = range[0], .max = range[1]});
  return number;
}

StudiedTrial read_trial(const YamlValue& value) {
  static const std::vector<std::string> kRewards{"forward",  "backward", "left",       "turn",    "survival",
                                                 "stand_up", "one_leg",  "ball_speed", "push_ups"};
  const YamlMap map = value.map();
  StudiedTrial trial{.name = map.text("name")};
  if (const auto set = map.optional_child("set")) {
    for (const auto& [path, text] : set->entries())
      trial.set.push_back({path, text.text(), text.source().string()});
  }
  const std::string reward = map.one_of("reward", kRewards, "survival");
  trial.reward = static_cast<StudiedTrial::Reward>(std::ranges::find(kRewards, reward) - kRewards.begin());
  trial.wanted = map.number("wanted", {.min = 1e-6, .max = 1e3}, 1.0);
  trial.weight = map.number("weight", {.min = 1e-6, .max = 1e3}, 1.0);
  return trial;
}

}  // namespace

Study read_study(const std::filesystem::path& file) {
  const YamlFile yaml(file);
  const YamlMap root = yaml.root();
  root.require_version(1);
  Study study;
  study.file = file;
  study.scenario =
      simulation::read_input(root.value("scenario"), file.parent_path(), simulation::InputKind::kScenario);
  study.world = root.one_of("world", simulation::world_names(), study.world);
  for (const auto& [path, value] : root.child("numbers").entries()) {
    study.numbers.push_back(read_number(path, value));
  }
  for (const YamlValue& trial : root.list("trials")) study.trials.push_back(read_trial(trial));
  if (study.numbers.empty()) throw root.error_at("numbers", "no number", "at least one");
  if (study.trials.empty()) throw root.error_at("trials", "no trial", "at least one");
  yaml.finish();
  return study;
}

double score(const StudiedTrial& trial, const StudyTrial& played, double duration_s) {
  using enum StudiedTrial::Reward;
  constexpr double kStrayCost = 0.25;  // of a way off the wanted one that is as long
  if (trial.reward == kStandUp) {
    if (!played.stood_s) return played.uprightness.value_or(0.0) - 1.0;
    return trial.wanted / std::max(*played.stood_s, trial.wanted);
  }
  const bool lost = trial.reward == kPushUps ? !played.error.empty() : played.lost();
  if (lost) return played.duration_s / duration_s - 1.0;
  if (trial.reward == kSurvival) return 1.0;
  if (played.achieved) return std::min(*played.achieved / trial.wanted, 1.0);
  if (!played.walked()) return -1.0;  // it has not even begun
  const simulation::WalkSummary& walk = played.walk;
  const double time_s =
      std::abs(walk.speed_m_per_s) > 1e-6 ? walk.distance_m / walk.speed_m_per_s : duration_s;
  double made = 0.0;
  double strayed = 0.0;
  switch (trial.reward) {
    case kForward:
    case kBackward:
      made = trial.reward == kForward ? walk.distance_m : -walk.distance_m;
      strayed = std::abs(walk.lateral_drift_m);
      break;
    case kLeft:
      made = walk.lateral_drift_m;
      strayed = std::abs(walk.distance_m);
      break;
    case kTurn:
      made = walk.heading_drift_rad;
      strayed = std::hypot(walk.distance_m, walk.lateral_drift_m);
      break;
    case kSurvival:
    case kStandUp:
    case kOneLeg:
    case kBallSpeed:
    case kPushUps:
      break;
  }
  return std::min(made / time_s / trial.wanted, 1.0) -
         kStrayCost * std::min(1.0, strayed / (time_s * trial.wanted));
}

}  // namespace koboshi::lab
