#include "tools/lab/experiment/trial_log.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "sim_board/input/error.h"

namespace koboshi::tools {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

TrialLog::TrialLog(const std::filesystem::path& file, const Experiment& experiment)
    : file_(file), experiment_(experiment) {
  if (file_.empty()) return;
  out_.emplace(file_, sim::OutputFile::Mode::kAppend);
  read();
}

void TrialLog::read() {
  std::ifstream in(file_, std::ios::binary);
  std::uintmax_t whole_bytes = 0;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (in.eof()) break;  // no line feed at its end: the program was stopped while it wrote this
    whole_bytes += line.size() + 1;
    try {
      const Json json = Json::parse(line);
      Values& values = known_[{json.at("experiment"), json.at("cell"), json.at("seed"), json.at("inputs")}];
      json.at("values").get_to<std::map<std::string, double>>(values);
      values.error = json.value("error", "");
    } catch (const Json::exception&) {
      throw sim::InputError(file_, number, "a malformed line", "a trial, or no such file to begin anew");
    }
  }
  in.close();
  std::filesystem::resize_file(file_, whole_bytes);
}

TrialLog::Key TrialLog::key(std::size_t cell, std::uint64_t seed) const {
  return {experiment_.name, experiment_.cells.at(cell).name, seed, experiment_.inputs};
}

std::optional<Values> TrialLog::find(std::size_t cell, std::uint64_t seed) const {
  const auto known = known_.find(key(cell, seed));
  if (known == known_.end()) return std::nullopt;
  return known->second;
}

void TrialLog::add(const Trial& trial) {
  if (!out_) return;
  Json json{{"experiment", experiment_.name},
            {"cell", experiment_.cells.at(trial.cell).name},
            {"seed", trial.seed},
            {"inputs", experiment_.inputs},
            {"values", static_cast<const std::map<std::string, double>&>(trial.values)}};
  if (!trial.values.error.empty()) json["error"] = trial.values.error;
  const std::lock_guard lock(mutex_);
  out_->write(json.dump() + '\n');
  out_->flush();
}

}  // namespace koboshi::tools
