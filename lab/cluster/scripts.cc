#include "lab/cluster/scripts.h"

#include <fmt/format.h>

#include <sstream>

#include "base/text/shell_word.h"

namespace koboshi::lab {
namespace {

constexpr const char* kWrittenBy = "# Written by koboshi lab submit.\n";

std::string command_text(const ScriptSetup& setup) {
  std::string text = shell_word(setup.program.string());
  for (const std::string& word : setup.command) text += " " + shell_word(word);
  return text;
}

// Slurm reads a value in double quotes as one word.
std::string slurm_value(const std::string& text) {
  return text.find(' ') == std::string::npos ? text : "\"" + text + "\"";
}

}  // namespace

std::string shard_script(const ScriptSetup& setup) {
  return fmt::format(
      "#!/bin/sh\n{}# Plays the shard whose number is the argument; run again, it resumes.\n"
      "cd {} && exec {} --out {} --jobs {} --shard \"$1/{}\"\n",
      kWrittenBy, shell_word(setup.directory.string()), command_text(setup),
      shell_word(setup.folder.string()), setup.jobs, setup.shards);
}

std::string slurm_script(const ScriptSetup& setup, const std::vector<std::string>& options) {
  std::string lines;
  for (const std::string& option : options) lines += "#SBATCH " + option + "\n";
  const std::string folder = setup.folder.string();
  // A task of a node that fails is queued again. The log tells every attempt.
  return fmt::format(
      "#!/bin/sh\n{}# A task that died may be queued again: `scontrol requeue JOB_TASK`, or koboshi lab "
      "submit.\n"
      "#SBATCH --job-name=koboshi\n#SBATCH --array=1-{}\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task={}\n"
      "#SBATCH --output={}\n#SBATCH --open-mode=append\n#SBATCH --requeue\n{}"
      "exec sh {} \"$SLURM_ARRAY_TASK_ID\"\n",
      kWrittenBy, setup.shards, setup.jobs, slurm_value(folder + "/slurm-%a.log"), lines,
      shell_word(folder + "/shard.sh"));
}

std::string parallel_script(const ScriptSetup& setup, const std::string& hosts) {
  const std::string folder = setup.folder.string();
  // The remote shell reads the command once more.
  return fmt::format(
      "#!/bin/sh\n{}# Run again, it plays the shards that have not succeeded.\n"
      "seq 1 {} | parallel --will-cite --sshlogin {} --joblog {} --resume-failed {}\n",
      kWrittenBy, setup.shards, shell_word(hosts), shell_word(folder + "/parallel.joblog"),
      shell_word("sh " + shell_word(folder + "/shard.sh") + " {}"));
}

std::string ranges_text(const std::string& numbers) {
  std::istringstream in(numbers);
  std::string text;
  std::string first;
  std::string last;
  const auto close = [&] {
    if (first.empty()) return;
    text += (text.empty() ? "" : ",") + first + (first == last ? "" : "-" + last);
  };
  for (std::string word; std::getline(in, word, ',');) {
    if (last.empty() || std::stoul(word) != std::stoul(last) + 1) {
      close();
      first = word;
    }
    last = word;
  }
  close();
  return text;
}

std::string without_shards(const std::string& joblog, const std::set<std::string>& shards) {
  std::istringstream in(joblog);
  std::string kept;
  for (std::string line; std::getline(in, line);) {
    if (!shards.contains(line.substr(0, line.find('\t')))) kept += line + "\n";
  }
  return kept;
}

}  // namespace koboshi::lab
