#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "lab/cluster/shard.h"
#include "lab/cluster/shard_run.h"
#include "lab/learn/checkpoint.h"
#include "lab/learn/learning_study.h"

namespace koboshi::lab {

struct TrainingOptions {
  std::vector<Override> overrides{};  // of the scenario
  std::filesystem::path out{};        // folder of the results
  std::size_t jobs = 1;
  std::uint64_t until = 0;  // the last generation of this call; 0: that of the study
};

struct TrainingProgress {
  std::uint64_t generation = 0;
  std::uint64_t generations = 0;
  std::string stage{};
  double reward = 0.0;    // mean of the candidates
  double survived = 0.0;  // share of their episodes
  ValidationMean last{};
  ValidationMean best{};
};

using ShowTraining = std::function<void(const TrainingProgress&)>;

struct TrainingResult {
  ValidationMean engine{};  // without a policy, in the validation's episodes
  ValidationMean best{};
  std::uint64_t generations = 0;
};

// Trains a policy by an evolution strategy. Each candidate is a network in floating point; the firmware runs
// its quantised image in closed loop, so that the training feels the rounding. Results do not depend on the
// number of jobs. Leaves in the folder: log.jsonl, a line for each generation; state.json, from which an
// interrupted training resumes with the same bytes; policy.kpol and policy.yaml, the best network so far, by
// validation; report.md, curve.png and best.mcap at the end. Throws InputError, also for the folder of a
// training with other inputs.
[[nodiscard]] TrainingResult train(const LearningStudy& study, const TrainingOptions& options,
                                   const ShowTraining& progress = {});

// The same training in shards, each of which plays its part of the episodes of every generation and of every
// validation (lab/cluster/search_trials.h).

// Throws InputError for a study that shards cannot play: by proximal policy optimisation.
void require_shards(const LearningStudy& study);

// A hash of all on which the episodes depend, beside their candidates and seeds.
[[nodiscard]] std::string training_inputs(const LearningStudy& study, const TrainingOptions& options);

// Plays a shard until the training has ended. The folder of the options gets its episodes only.
TrainingResult play_training_shard(const LearningStudy& study, const TrainingOptions& options,
                                   const Shard& shard, const ShowTraining& progress = {});

// Leaves the files that train() leaves. Throws InputError if episodes are missing; the folder is then
// unchanged.
[[nodiscard]] TrainingResult merge_training(const LearningStudy& study, const TrainingOptions& options,
                                            std::size_t shards, const ShowTraining& progress = {});

// How far the shards are: each has a part of the generations that are not complete.
[[nodiscard]] std::vector<ShardProgress> training_progress(const LearningStudy& study,
                                                           const TrainingOptions& options,
                                                           std::size_t shards);

}  // namespace koboshi::lab
