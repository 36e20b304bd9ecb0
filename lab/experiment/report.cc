#include "lab/experiment/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "base/text/text.h"
#include "lab/experiment/statistics.h"

namespace koboshi::lab {
namespace {

using Json = nlohmann::ordered_json;

struct StopText {
  const char* name;
  const char* reason;
};

StopText text_of(Stop stop) {
  static constexpr std::array<StopText, 5> kTexts{{{"all_seeds", "all are played"},
                                                   {"tight_enough", "the intervals are tight enough"},
                                                   {"too_many", "too many had failed"},
                                                   {"budget", "the time was over"},
                                                   {"not_reached", "the ladder ended before"}}};
  return kTexts.at(static_cast<std::size_t>(stop));
}

// Calls `act` with each cell that was reached and its result.
template <typename Act>
void for_each_cell(const Experiment& experiment, const ExperimentResult& result, const Act& act) {
  for (std::size_t c = 0; c < experiment.cells.size(); ++c) {
    if (result.cells[c].stop != Stop::kNotReached) act(experiment.cells[c], result.cells[c]);
  }
}

// nlohmann writes what is not a number as null.
Json metric_json(const Metric& metric, const std::vector<double>& values) {
  if (metric.is_event) {
    const ShareEstimate share = estimate_share(values);
    return {{"count", share.count},
            {"events", share.events},
            {"share", share.share},
            {"confidence_95", {share.confidence_95.low, share.confidence_95.high}}};
  }
  const MeanEstimate mean = estimate_mean(values);
  return {{"count", mean.count},
          {"mean", mean.mean},
          {"standard_deviation", mean.standard_deviation},
          {"confidence_95", {mean.confidence_95.low, mean.confidence_95.high}}};
}

// Settings are text; programs get those that are numbers as numbers.
Json setting_json(const std::string& value) {
  const std::optional<double> number = koboshi::parse_number(value);
  return number ? Json(*number) : Json(value);
}

// A mean of a hair less than zero is zero, not -0.0.
std::string fixed_text(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string table_cell(const Metric& metric, const std::vector<double>& values, std::size_t trials) {
  if (values.empty()) return "-";
  if (metric.is_event) {
    const ShareEstimate share = estimate_share(values);
    return fmt::format("{} of {} ({:.0f} .. {:.0f} %)", share.events, share.count,
                       100.0 * share.confidence_95.low, 100.0 * share.confidence_95.high);
  }
  const MeanEstimate mean = estimate_mean(values);
  const std::string value = fixed_text(metric.factor * mean.mean, metric.decimals);
  if (mean.count == 1) return value;
  const double reach = metric.factor * mean.confidence_95.half_width();
  const std::string few = mean.count < trials ? fmt::format(" (n = {})", mean.count) : "";
  return fmt::format("{} +- {:.{}f}{}", value, reach, metric.decimals, few);
}

// Names the cells that have fewer seeds than they should, one line for each reason.
std::string stop_notes(const Experiment& experiment, const ExperimentResult& result) {
  struct Stopped {
    std::vector<std::string> names;
    std::set<std::size_t> seeds;
  };
  constexpr std::size_t kNamed = 4;
  std::map<std::string, Stopped> by_reason;
  std::size_t cells = 0;
  for_each_cell(experiment, result, [&](const Cell& cell, const CellResult& played) {
    ++cells;
    if (played.stop == Stop::kAllSeeds || played.played.size() >= experiment.seeds) return;
    Stopped& stopped = by_reason[text_of(played.stop).reason];
    stopped.names.push_back(cell.name);
    stopped.seeds.insert(played.played.size());
  });
  std::string notes;
  for (const auto& [why, stopped] : by_reason) {
    const auto& [names, seeds] = stopped;
    notes += names.size() > kNamed ? fmt::format("{} of {} cells", names.size(), cells)
                                   : fmt::format("{}", fmt::join(names, ", "));
    notes += fmt::format(": stopped after {} of {} seeds, {}\n",
                         seeds.size() == 1 ? std::to_string(*seeds.begin())
                                           : fmt::format("{} to {}", *seeds.begin(), *seeds.rbegin()),
                         experiment.seeds, why);
  }
  return notes;
}

}  // namespace

std::string stop_name(Stop stop) { return text_of(stop).name; }

std::string result_table(const Experiment& experiment, const ExperimentResult& result, TableStyle style) {
  Row head;
  for (const auto& [name, value] : experiment.cells.front().settings) head.push_back(name);
  head.push_back("trials");
  for (const Metric& metric : experiment.metrics) {
    if (!metric.label.empty()) head.push_back(metric.label);
  }
  std::vector<Row> rows;
  for_each_cell(experiment, result, [&](const Cell& cell, const CellResult& played) {
    Row& row = rows.emplace_back();
    for (const auto& [name, value] : cell.settings) row.push_back(value);
    row.push_back(std::to_string(played.played.size()));
    for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
      const Metric& metric = experiment.metrics[i];
      if (!metric.label.empty())
        row.push_back(table_cell(metric, values_of(played, i), played.played.size()));
    }
  });
  return table_text(head, rows, style);
}

std::string notes(const Experiment& experiment, const ExperimentResult& result) {
  std::string notes;
  for_each_cell(experiment, result, [&](const Cell& cell, const CellResult& played) {
    for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
      const Metric& metric = experiment.metrics[i];
      if (!metric.is_event || !metric.label.empty()) continue;
      const ShareEstimate share = estimate_share(values_of(played, i));
      if (share.events > 0)
        notes += fmt::format("{}: {} of {} {}\n", cell.name, share.events, share.count, metric.name);
    }
    std::set<std::string> seen;  // each error is shown with the first seed that met it
    for (const Trial& trial : played.played) {
      const std::string& error = trial.record.error;
      if (!error.empty() && seen.insert(error).second)
        notes += fmt::format("{}: seed {}: {}\n", cell.name, trial.seed, error);
    }
  });
  return notes + stop_notes(experiment, result);
}

Json to_json(const Experiment& experiment, const ExperimentResult& result) {
  Json cells = Json::array();
  for_each_cell(experiment, result, [&](const Cell& cell, const CellResult& played) {
    Json json{{"cell", cell.name}};
    for (const auto& [name, value] : cell.settings) json[name] = setting_json(value);
    json["trials"] = played.played.size();
    json["stop"] = stop_name(played.stop);
    for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
      json[experiment.metrics[i].name] = metric_json(experiment.metrics[i], values_of(played, i));
    }
    cells.push_back(json);
  });
  Json json{{"experiment", experiment.name},
            {"first_seed", experiment.first_seed},
            {"seeds", experiment.seeds},
            {"inputs", experiment.inputs}};
  for (const auto& [name, value] : experiment.conditions) json[name] = setting_json(value);
  json["cells"] = cells;
  return json;
}

std::string to_csv(const Experiment& experiment, const ExperimentResult& result) {
  Row head;
  for (const auto& [name, value] : experiment.cells.front().settings) head.push_back(name);
  head.push_back("seed");
  for (const Metric& metric : experiment.metrics) head.push_back(metric.name);
  std::vector<Row> rows;
  for_each_cell(experiment, result, [&](const Cell& cell, const CellResult& played) {
    for (const Trial& trial : played.played) {
      Row& row = rows.emplace_back();
      for (const auto& [name, value] : cell.settings) row.push_back(value);
      row.push_back(std::to_string(trial.seed));
      for (const auto& value : trial.record.values) row.push_back(value ? csv_cell(*value) : "");
    }
  });
  return table_text(head, rows, TableStyle::kCsv);
}

}  // namespace koboshi::lab
