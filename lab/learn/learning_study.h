#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/policy_search/ppo.h"
#include "sim_board/world/options.h"
#include "simulation/disturbance/world_ranges.h"
#include "simulation/model/robot_model.h"
#include "tools/policy/policy_map.h"

namespace koboshi::lab {

// An input of the network, with the line of the file that names it.
struct LearnedInput {
  std::string signal;
  double typical = 1.0;       // the network's input is the signal divided by it
  simulation::Range range{};  // of training, in the signal's unit: the watchdog's
  int line = 0;
};

// An output of the network, in (-1, 1): the offset of a joint's target, as a share of its bound.
struct LearnedOutput {
  std::string joint;
  double bound_rad = 0.0;
  double rate_rad_per_s = 0.0;
  int line = 0;
};

// Conditions from which an episode is drawn, each uniformly within its range.
struct LearningStage {
  std::string name;
  std::string world = "mild";
  simulation::Range forward_m_per_s{};
  simulation::Range left_m_per_s{};
  simulation::Range turn_rad_per_s{};
  simulation::Range impulse_N_s_per_kg{};  // of each push, in any level direction; 0 to 0: none
  simulation::Range interval_s{1.5, 3.0};  // from one push to the next
  std::optional<double> advance_at{};      // share of episodes that must survive; none: the last stage
};

// Weights of the terms of an episode's reward (docs/reference/learn.md).
struct RewardWeights {
  double survival = 1.0;
  double drift = 0.0;   // per m/s
  double turn = 0.0;    // per rad/s
  double power = 0.0;   // per W
  double lean = 0.0;    // per rad^2
  double offset = 0.0;  // per squared share of the bounds
};

enum class LearningAlgorithm {
  kEvolution,  // lab/policy_search/evolution.h
  kPpo,        // lab/policy_search/ppo.h
};

// docs/reference/learn.md.
struct LearningStudy {
  std::filesystem::path file;
  std::filesystem::path scenario;
  std::string stepper = "lumped";
  std::uint64_t seed = 1;

  std::vector<std::size_t> hidden{};  // neurons of each hidden layer; empty: a layer of outputs only
  bool mirror = true;                 // left and right share their weights
  std::uint8_t patience_ticks = 10;
  std::vector<LearnedInput> inputs;
  std::vector<LearnedOutput> outputs;

  LearningAlgorithm algorithm = LearningAlgorithm::kEvolution;
  int algorithm_line = 0;
  PpoOptions ppo{};             // without its learning rate and seed
  std::size_t held_cycles = 5;  // in which the noise of the exploration is the same
  std::size_t population = 32;  // even
  std::size_t generations = 100;
  double noise = 0.05;  // standard deviation of the candidates' weights about the mean
  double learning_rate = 0.02;
  double weight_decay = 0.0;  // share of each weight that a generation removes

  std::size_t episodes = 4;  // of each candidate in a generation
  double walk_s = 10.0;
  std::uint64_t first_seed = 500'000;
  std::size_t validation_episodes = 32;
  std::size_t validate_every = 5;  // generations
  std::uint64_t validation_first_seed = 400'000;

  std::vector<LearningStage> stages;
  RewardWeights reward{};
};

// Reads a study. Signals and joints are checked by learned_map(). Throws InputError with file and line.
[[nodiscard]] LearningStudy read_learning_study(const std::filesystem::path& file);

// Returns the map of the network's inputs and outputs to this robot: with `mirror`, each input and output of
// the left side is followed by that of the right side. Throws InputError for a signal or joint that the robot
// does not have.
[[nodiscard]] tools::PolicyMap learned_map(const LearningStudy& study, const simulation::NamedModel& robot);

// The text of a map as `koboshi policy import` reads it (docs/reference/policy.md).
[[nodiscard]] std::string map_text(const tools::PolicyMap& map);

}  // namespace koboshi::lab
