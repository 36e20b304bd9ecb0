#include "lab/cluster/job_file.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/file/output_file.h"
#include "base/text/error.h"
#include "base/text/shell_word.h"
#include "base/text/text.h"

namespace koboshi::lab {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kJobName = "job.json";
constexpr int kJobVersion = 1;

std::string job_text(const JobFile& job) {
  const Json json{{"version", kJobVersion},
                  {"command", job.command},
                  {"directory", job.directory.string()},
                  {"shards", job.shards},
                  {"inputs", job.inputs}};
  return json.dump(2) + "\n";
}

void check_same(const fs::path& file, const JobFile& found, const JobFile& wanted) {
  const auto refuse = [&](const std::string& was, const std::string& is) {
    throw InputError(file, 0, was, is + ", or a new folder");
  };
  if (found.command != wanted.command) refuse(found.command_line(), wanted.command_line());
  if (found.shards != wanted.shards)
    refuse(std::to_string(found.shards) + " shards", std::to_string(wanted.shards));
  if (found.inputs != wanted.inputs)
    refuse("shards of another build of the program or of other files", "the same program and files");
}

}  // namespace

std::string JobFile::command_line() const {
  std::string line = "koboshi";
  for (const std::string& argument : command) line += " " + shell_word(argument);
  return line;
}

std::vector<std::string> job_command(const std::vector<std::string>& arguments) {
  static constexpr std::array<std::string_view, 5> kOfOneShard{"--shard", "--shards", "--out", "--jobs",
                                                               "--budget-s"};
  std::vector<std::string> command;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view name = std::string_view(arguments[i]).substr(0, arguments[i].find('='));
    if (std::ranges::find(kOfOneShard, name) == kOfOneShard.end()) {
      command.push_back(arguments[i]);
    } else if (name.size() == arguments[i].size()) {
      ++i;  // its value is the next argument
    }
  }
  return command;
}

JobFile read_job(const fs::path& folder) {
  const fs::path file = folder / kJobName;
  const std::string text = read_text_file(file, "one that koboshi lab submit or a shard has written");
  try {
    const Json json = Json::parse(text);
    if (json.at("version") != kJobVersion)
      throw InputError(file, 0, "version " + json.at("version").dump(), std::to_string(kJobVersion));
    return {json.at("command"), json.at("directory").get<std::string>(), json.at("shards"),
            json.at("inputs")};
  } catch (const Json::exception&) {
    throw InputError(file, 0, "a malformed file", "one that koboshi lab submit or a shard has written");
  }
}

void keep_job(const fs::path& folder, const JobFile& job) {
  const fs::path file = folder / kJobName;
  if (!fs::exists(file)) {
    if (fs::exists(folder) && !fs::is_directory(folder))
      throw InputError(folder, 0, "a file", "a folder for the results");
    // Shards begin at the same time: another one's file, or the beginning of it, is no other file.
    const auto is_other = [](const fs::directory_entry& entry) {
      const std::string name = entry.path().filename().string();
      return !name.starts_with(kJobName) && !name.starts_with("shard-") && !name.starts_with("slurm-");
    };
    if (fs::exists(folder) && std::ranges::any_of(fs::directory_iterator(folder), is_other))
      throw InputError(folder, 0, "a folder with other files", "a new or empty folder, or one of shards");
    fs::create_directories(folder);
    write_whole_file(file, job_text(job));
  }
  check_same(file, read_job(folder), job);
}

}  // namespace koboshi::lab
