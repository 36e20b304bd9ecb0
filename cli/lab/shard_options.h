#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/cluster/shard.h"
#include "lab/cluster/shard_run.h"

namespace koboshi::cli {

// --shard and --shards of the commands whose trials several programs may share.
struct ShardArguments {
  std::optional<lab::Shard> shard{};
  std::string action{};  // plan, status or merge; empty: play

  [[nodiscard]] bool is_used() const { return shard.has_value() || !action.empty(); }
  [[nodiscard]] bool is_merge() const { return action == "merge"; }
  // The number of shards: from --shard, otherwise from the folder's job.json. Throws InputError.
  [[nodiscard]] std::size_t count(const std::filesystem::path& folder) const;
};

void add_shard_options(CLI::App& command, ShardArguments& arguments);

// With `plan`, prints the numbers of the incomplete shards, with commas between; with `status`, a table.
// Returns the exit status: 0, or kFailed if `status` shows incomplete ones.
[[nodiscard]] int show_shards(const ShardArguments& arguments, const std::vector<lab::ShardProgress>& shards);

}  // namespace koboshi::cli
