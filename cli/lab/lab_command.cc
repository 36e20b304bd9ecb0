#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/shell_word.h"
#include "base/text/text.h"
#include "cli/commands.h"
#include "cli/lab/session.h"
#include "lab/cluster/child.h"
#include "lab/cluster/job_file.h"
#include "lab/cluster/scripts.h"
#include "tools/run/exit_status.h"

namespace koboshi::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSubmitted = "submitted.json";
constexpr const char* kSlurm = "Slurm's (apt install slurm-client)";
constexpr const char* kParallel = "GNU parallel (apt install parallel openssh-client)";

struct SubmitArguments {
  fs::path out{};
  std::size_t shards = 8;
  std::size_t jobs = 1;
  bool slurm = false;
  std::vector<std::string> sbatch{};
  std::string parallel{};
};

std::string lab_text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path this_program() { return fs::read_symlink("/proc/self/exe"); }

// Calls the command of a folder's shards in this program, in the directory in which it was submitted, which
// another machine may not have.
lab::ChildResult call(const lab::JobFile& job, const fs::path& folder, const std::vector<std::string>& more,
                      lab::ChildOutput output) {
  std::vector<std::string> arguments{this_program().string()};
  arguments.insert(arguments.end(), job.command.begin(), job.command.end());
  arguments.insert(arguments.end(), {"--out", fs::absolute(folder).lexically_normal().string()});
  arguments.insert(arguments.end(), more.begin(), more.end());
  std::fflush(stdout);
  return lab::run_child(arguments, output, "this program",
                        fs::is_directory(job.directory) ? job.directory : fs::path());
}

// The command that follows the options, without a "--" before it. Throws InputError.
std::vector<std::string> lab_command_of(std::vector<std::string> words) {
  static const std::vector<std::string> kShared{"experiment", "tune", "learn"};
  if (!words.empty() && words.front() == "--") words.erase(words.begin());
  if (words.empty() || std::ranges::find(kShared, words.front()) == kShared.end())
    throw InputError("koboshi lab submit", 0, words.empty() ? "no command" : one_line(words.front()),
                     "experiment, tune or learn with their options, after those of submit");
  if (lab::job_command(words) != words)
    throw InputError("koboshi lab submit", 0, "--out, --jobs, --budget-s or --shard in the command",
                     "--out and --jobs before it");
  return words;
}

// The number of the Slurm job that was submitted last for a folder; empty if there is none.
std::string slurm_job_of(const fs::path& folder) {
  const auto json = nlohmann::ordered_json::parse(lab_text_of(folder / kSubmitted), nullptr, false);
  return json.is_object() ? json.value("slurm_job", "") : "";
}

// "3 running, 2 pending"; empty if the queue does not have the job. Throws InputError without Slurm.
std::string states_of(const std::string& job) {
  static_cast<void>(lab::run_child({"squeue", "--version"}, lab::ChildOutput::kCaptured, kSlurm));
  // A job that has ended long ago is an error of squeue.
  const lab::ChildResult listed = lab::run_child(
      {"sh", "-c", "exec squeue --noheader --array --format=%T --jobs=\"$0\" 2>/dev/null", job},
      lab::ChildOutput::kCaptured, kSlurm);
  std::map<std::string, int> counts;
  std::istringstream in(listed.output);
  for (std::string state; std::getline(in, state);) ++counts[state];
  std::string text;
  for (const auto& [state, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, state);
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

int submit_to_slurm(const lab::ScriptSetup& setup, const std::string& incomplete,
                    const SubmitArguments& arguments) {
  if (const std::string job = slurm_job_of(setup.folder); !job.empty()) {
    if (const std::string states = states_of(job); !states.empty())
      throw InputError(setup.folder, 0, "job " + job + " in the queue: " + states,
                       "the end of that job, or scancel " + job);
  }
  const fs::path script = setup.folder / "submit.sbatch";
  write_whole_file(script, lab::slurm_script(setup, arguments.sbatch));
  const std::string array = lab::ranges_text(incomplete);
  const lab::ChildResult submitted = lab::run_child(
      {"sbatch", "--parsable", "--array=" + array, script.string()}, lab::ChildOutput::kCaptured, kSlurm);
  if (submitted.status != 0) return tools::kFailed;  // sbatch has said why
  const std::string job = submitted.output.substr(0, submitted.output.find_first_of(";\n"));
  write_whole_file(setup.folder / kSubmitted, nlohmann::ordered_json{{"slurm_job", job}}.dump() + "\n");
  fmt::print("job {} plays the shards {}; koboshi lab status {}\n", job, array,
             shell_word(arguments.out.string()));
  return 0;
}

// Waits until the shards are played.
int run_parallel(const lab::ScriptSetup& setup, const std::string& incomplete,
                 const SubmitArguments& arguments) {
  const fs::path log = setup.folder / "parallel.joblog";
  if (fs::exists(log)) {
    std::set<std::string> shards;
    std::istringstream in(incomplete);
    for (std::string number; std::getline(in, number, ',');) shards.insert(number);
    write_whole_file(log, lab::without_shards(lab_text_of(log), shards));
  }
  const fs::path script = setup.folder / "parallel.sh";
  write_whole_file(script, lab::parallel_script(setup, arguments.parallel));
  const int failed = lab::run_child({"sh", script.string()}, lab::ChildOutput::kShown, kParallel).status;
  if (failed == 0) return 0;
  fmt::print("parallel ended with status {}; parallel.joblog names the shards that failed\n", failed);
  return tools::kFailed;
}

int submit(const SubmitArguments& arguments, const std::vector<std::string>& words) {
  if (arguments.slurm == !arguments.parallel.empty())
    throw InputError("koboshi lab submit", 0, arguments.slurm ? "--slurm and --parallel" : "neither",
                     "one of --slurm and --parallel HOSTS");
  const lab::JobFile job{.command = lab_command_of(words), .directory = fs::current_path()};
  // Throws where the program is missing, before the first write.
  static_cast<void>(lab::run_child({arguments.slurm ? "sbatch" : "parallel", "--version"},
                                   lab::ChildOutput::kCaptured, arguments.slurm ? kSlurm : kParallel));
  const std::string shard = fmt::format("1/{}", arguments.shards);
  const lab::ChildResult plan =
      call(job, arguments.out, {"--shards", "plan", "--shard", shard}, lab::ChildOutput::kCaptured);
  if (plan.status != 0) return plan.status;  // one line has said why
  const std::string incomplete = plan.output.substr(0, plan.output.find('\n'));
  if (incomplete.empty()) {
    fmt::print("all {} shards are complete; koboshi lab collect {}\n", arguments.shards,
               arguments.out.string());
    return 0;
  }
  const lab::ScriptSetup setup{this_program(),
                               fs::canonical(arguments.out),
                               lab::read_job(arguments.out).directory,
                               job.command,
                               arguments.shards,
                               arguments.jobs};
  write_whole_file(setup.folder / "shard.sh", lab::shard_script(setup));
  return arguments.slurm ? submit_to_slurm(setup, incomplete, arguments)
                         : run_parallel(setup, incomplete, arguments);
}

void add_submit_command(CLI::App& lab, Invocation& invocation) {
  const auto arguments = std::make_shared<SubmitArguments>();
  CLI::App* command =
      lab.add_subcommand("submit", "Play the shards of an experiment, a search or a training on a cluster");
  command->prefix_command();
  command->footer(
      "Submits a Slurm job array, or runs GNU parallel over ssh until all shards are played. The folder and\n"
      "the program have the same path on all machines. Called again, it submits the shards that are not\n"
      "complete. The command and its options follow those of submit.\n\n"
      "Examples:\n"
      "  koboshi lab submit --slurm --shards 100 --out runs/wide experiment stand-up --seeds 1000\n"
      "  koboshi lab submit --parallel 2/localhost --shards 4 --out runs/small experiment terrain --seeds "
      "20\n");
  command->add_option("-o,--out", arguments->out, "Folder of the shards")->required();
  add_number(*command, "--shards", arguments->shards, 1, lab::kMaxShards, "Parts of the work");
  add_number(*command, "--jobs", arguments->jobs, 1, 1024, "Cores of a shard");
  command->add_flag("--slurm", arguments->slurm, "Submit a job array with sbatch");
  command
      ->add_option("--sbatch", arguments->sbatch,
                   "Another option of sbatch, such as --sbatch=--time=60; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--parallel", arguments->parallel,
                      "Run GNU parallel on these hosts, as in its --sshlogin: 4/a,8/b; : is this machine");
  command->callback([arguments, command, &invocation] {
    invocation.exit_status = submit(*arguments, command->remaining());
  });
}

int show_status(const fs::path& folder) {
  const int status =
      call(lab::read_job(folder), folder, {"--shards", "status"}, lab::ChildOutput::kShown).status;
  if (const std::string job = slurm_job_of(folder); !job.empty()) {
    const std::string states = states_of(job);
    fmt::print("Slurm job {}: {}\n", job, states.empty() ? "not in the queue" : states);
  }
  return status;
}

}  // namespace

void add_lab_command(CLI::App& program, Invocation& invocation) {
  CLI::App* lab = program.add_subcommand("lab", "Experiments and searches on more than one machine");
  lab->require_subcommand(1);
  add_submit_command(*lab, invocation);
  const auto folder = std::make_shared<fs::path>();
  const auto add = [&](const char* name, const char* description, const char* footer) {
    CLI::App* command = lab->add_subcommand(name, description);
    command->footer(footer);
    command->add_option("FOLDER", *folder, "Folder of the shards")->required();
    return command;
  };
  add("status", "Show how far the shards are",
      "Exit status 1 while a shard is not complete.\n\n"
      "Example:\n"
      "  koboshi lab status runs/wide\n")
      ->callback([folder, &invocation] { invocation.exit_status = show_status(*folder); });
  add("collect", "Merge the shards into the results that one machine gets",
      "Leaves the files of the command as if one program with one thread had played all. It names the "
      "shards\n"
      "that miss trials (exit status 2), and may be repeated.\n\n"
      "Example:\n"
      "  koboshi lab collect runs/wide\n")
      ->callback([folder, &invocation] {
        invocation.exit_status =
            call(lab::read_job(*folder), *folder, {"--shards", "merge"}, lab::ChildOutput::kShown).status;
      });
}

}  // namespace koboshi::cli
