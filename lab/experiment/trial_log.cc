#include "lab/experiment/trial_log.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/text/error.h"

namespace koboshi::tools {

using Json = nlohmann::ordered_json;

TrialLog::TrialLog(const std::filesystem::path& file, const Experiment& experiment)
    : experiment_(experiment) {
  if (file.empty()) return;
  out_.emplace(file, OutputFile::Mode::kAppend);
  read(file);
}

void TrialLog::read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::uintmax_t whole_bytes = 0;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (in.eof()) break;  // no line feed at its end: the program was stopped while it wrote this
    whole_bytes += line.size() + 1;
    try {
      read_line(line);
    } catch (const Json::exception&) {
      throw InputError(file, number, "a malformed line", "a trial, or no such file to begin anew");
    }
  }
  in.close();
  std::filesystem::resize_file(file, whole_bytes);
}

void TrialLog::read_line(const std::string& line) {
  const Json json = Json::parse(line);
  const bool same = json.at("experiment") == experiment_.name && json.at("inputs") == experiment_.inputs;
  const std::pair<std::string, std::uint64_t> key{json.at("cell"), json.at("seed")};
  const auto values = json.at("values").get<std::map<std::string, double>>();
  if (!same) return;
  Record record{.error = json.value("error", "")};
  for (const Metric& metric : experiment_.metrics) {
    const auto value = values.find(metric.name);
    record.values.push_back(value == values.end() ? std::nullopt : std::optional(value->second));
  }
  known_[key] = std::move(record);
}

std::optional<Record> TrialLog::find(std::size_t cell, std::uint64_t seed) const {
  const auto known = known_.find({experiment_.cells.at(cell).name, seed});
  return known == known_.end() ? std::nullopt : std::optional(known->second);
}

void TrialLog::add(const Trial& trial) {
  if (!out_) return;
  Json values = Json::object();
  for (std::size_t i = 0; i < experiment_.metrics.size(); ++i) {
    if (const auto value = trial.record.values.at(i)) values[experiment_.metrics[i].name] = *value;
  }
  Json json{{"experiment", experiment_.name},
            {"cell", experiment_.cells.at(trial.cell).name},
            {"seed", trial.seed},
            {"inputs", experiment_.inputs},
            {"values", values}};
  if (!trial.record.error.empty()) json["error"] = trial.record.error;
  const std::lock_guard lock(mutex_);
  out_->write(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n');
  out_->flush();
}

}  // namespace koboshi::tools
