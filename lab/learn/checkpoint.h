#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/policy_search/search_state.h"

namespace koboshi::lab {

// A validation of the mean network: means over the validation's episodes.
struct ValidationMean {
  std::uint64_t generation = 0;
  double reward = 0.0;
  double survived = 0.0;  // share of the episodes
  double drift_m_per_s = 0.0;
  double turn_rad_per_s = 0.0;
  double power_W = 0.0;
  double lean_rad2 = 0.0;
  double offset = 0.0;
  double stopped = 0.0;  // share of the episodes in which the watchdog stopped the policy

  friend bool operator==(const ValidationMean&, const ValidationMean&) = default;
};

// A training between two generations: all that the later ones depend on. Numbers survive the file to the bit.
struct Checkpoint {
  std::string inputs{};  // a hash of the study, the scenario, their files and the program
  SearchState search{};
  std::size_t stage = 0;
  std::vector<double> survived{};  // share by generation of this stage, the last ones
  std::vector<ValidationMean> validations{};
  std::size_t best = 0;                // of the validations
  std::vector<double> best_weights{};  // parameters of the network
  std::uint64_t log_bytes = 0;  // of log.jsonl; a line that an interrupted program has begun is behind it
};

// Replaces the file atomically. Throws WriteError.
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint);
// Nothing if there is no such file. Throws InputError for a file that is no checkpoint.
[[nodiscard]] std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& file);

}  // namespace koboshi::lab
