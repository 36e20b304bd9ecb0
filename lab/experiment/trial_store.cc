#include "lab/experiment/trial_store.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/text/error.h"

namespace koboshi::lab {

using Json = nlohmann::ordered_json;

std::string trial_line(const Experiment& experiment, const Trial& trial) {
  Json values = Json::object();
  for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
    if (const auto value = trial.record.values.at(i)) values[experiment.metrics[i].name] = *value;
  }
  Json json{{"experiment", experiment.name},
            {"cell", experiment.cells.at(trial.cell).name},
            {"seed", trial.seed},
            {"inputs", experiment.inputs},
            {"values", values}};
  if (!trial.record.error.empty()) json["error"] = trial.record.error;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::uintmax_t TrialStore::read(const std::filesystem::path& file, std::uintmax_t offset) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return offset;
  in.seekg(static_cast<std::streamoff>(offset));
  std::string line;
  // Counted from the offset: whoever follows a growing file has read the lines before it.
  for (int number = 1; std::getline(in, line); ++number) {
    if (in.eof()) break;
    try {
      read_line(line);
    } catch (const Json::exception&) {
      throw InputError(file, number, "a malformed line", "a trial, or no such file to begin anew");
    }
    offset += line.size() + 1;
  }
  return offset;
}

void TrialStore::read_line(const std::string& line) {
  const Json json = Json::parse(line);
  const bool same = json.at("experiment") == experiment_;
  Key key{json.at("inputs"), json.at("cell"), json.at("seed")};
  const auto values = json.at("values").get<std::map<std::string, double>>();
  if (!same) return;
  Record record{.error = json.value("error", "")};
  for (const Metric& metric : metrics_) {
    const auto value = values.find(metric.name);
    record.values.push_back(value == values.end() ? std::nullopt : std::optional(value->second));
  }
  known_[std::move(key)] = std::move(record);
}

void TrialStore::add(const Experiment& experiment, const Trial& trial) {
  known_[{experiment.inputs, experiment.cells.at(trial.cell).name, trial.seed}] = trial.record;
}

const Record* TrialStore::find(const Experiment& experiment, std::size_t cell, std::uint64_t seed) const {
  const auto known = known_.find({experiment.inputs, experiment.cells.at(cell).name, seed});
  return known == known_.end() ? nullptr : &known->second;
}

std::size_t TrialStore::count_of_others(const std::string& inputs) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(known_, [&](const auto& trial) { return trial.first.inputs != inputs; }));
}

}  // namespace koboshi::lab
