#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace koboshi::lab {

// The scripts that `koboshi lab submit` leaves in the folder of the shards.

struct ScriptSetup {
  std::filesystem::path program{};     // koboshi, absolute, the same on all machines
  std::filesystem::path folder{};      // of the shards, absolute, shared by all machines
  std::filesystem::path directory{};   // in which the command's paths are meant
  std::vector<std::string> command{};  // {"experiment", "gyro-feedback"}
  std::size_t shards = 1;
  std::size_t jobs = 1;  // threads of a shard
};

// shard.sh, which plays the shard whose number is its argument.
[[nodiscard]] std::string shard_script(const ScriptSetup& setup);
// submit.sbatch, a Slurm job array with a task for each shard. `options` are further ones of sbatch.
[[nodiscard]] std::string slurm_script(const ScriptSetup& setup, const std::vector<std::string>& options);
// parallel.sh, which plays all shards on these hosts, in the notation of GNU parallel's --sshlogin, but not
// those that have succeeded by its log.
[[nodiscard]] std::string parallel_script(const ScriptSetup& setup, const std::string& hosts);

// "1-3,7": the numbers of "1,2,3,7", which rise, in Slurm's notation. Empty for an empty text.
[[nodiscard]] std::string ranges_text(const std::string& numbers);

// GNU parallel's log without the lines of these shards, which their files show to be incomplete.
[[nodiscard]] std::string without_shards(const std::string& joblog, const std::set<std::string>& shards);

}  // namespace koboshi::lab
