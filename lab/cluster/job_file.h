#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace koboshi::lab {

// Describes the shards of a folder: job.json.
struct JobFile {
  std::vector<std::string> command{};  // {"experiment", "gyro-feedback", "--seeds", "100"}
  std::filesystem::path directory{};   // in which its relative paths are meant
  std::size_t shards = 1;
  std::string inputs{};  // hash of the files, the options and the program (hash_inputs)

  // "koboshi experiment gyro-feedback --seeds 100"
  [[nodiscard]] std::string command_line() const;
};

// The arguments of a command that decide on its results: without those of one shard or one machine (--shard,
// --shards, --out, --jobs, --budget-s).
[[nodiscard]] std::vector<std::string> job_command(const std::vector<std::string>& arguments);

// Throws InputError if the file is no job's.
[[nodiscard]] JobFile read_job(const std::filesystem::path& folder);

// Creates the folder with the file, or compares it with the one that is there: all shards write the same.
// Throws InputError if the folder holds something else, or the shards of another command, of other inputs or
// of another build of the program.
void keep_job(const std::filesystem::path& folder, const JobFile& job);

}  // namespace koboshi::lab
