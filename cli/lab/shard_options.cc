#include "cli/lab/shard_options.h"

#include <fmt/format.h>

#include "base/table/table.h"
#include "cli/options.h"
#include "lab/cluster/job_file.h"
#include "tools/run/exit_status.h"

namespace koboshi::cli {

std::size_t ShardArguments::count(const std::filesystem::path& folder) const {
  return shard ? shard->count : lab::read_job(folder).shards;
}

void add_shard_options(CLI::App& command, ShardArguments& arguments) {
  command
      .add_option_function<std::string>(
          "--shard", [&arguments](const std::string& text) { arguments.shard = lab::parse_shard(text); },
          "Play only part K of N of the trials, into a file of its own in --out")
      ->check(taken_by(lab::parse_shard));
  command
      .add_option("--shards", arguments.action,
                  "Play nothing: begin a folder of shards, show them, or merge them (koboshi lab)")
      ->check(CLI::IsMember({"plan", "status", "merge"}));
}

int show_shards(const ShardArguments& arguments, const std::vector<lab::ShardProgress>& shards) {
  const bool is_plan = arguments.action == "plan";
  std::string incomplete;
  std::vector<Row> rows;
  for (std::size_t i = 0; i < shards.size(); ++i) {
    const lab::ShardProgress& shard = shards[i];
    rows.push_back({std::to_string(i + 1), std::to_string(shard.finished), std::to_string(shard.remaining),
                    shard.is_complete() ? "complete" : "incomplete"});
    if (!shard.is_complete()) incomplete += (incomplete.empty() ? "" : ",") + std::to_string(i + 1);
  }
  if (is_plan) {
    fmt::print("{}\n", incomplete);
    return 0;
  }
  fmt::print("{}", table_text({"shard", "trials", "to go", "state"}, rows, TableStyle::kTerminal));
  return incomplete.empty() ? 0 : tools::kFailed;
}

}  // namespace koboshi::cli
