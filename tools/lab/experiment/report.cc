#include "tools/lab/experiment/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "sim_board/input/text.h"

namespace koboshi::tools {
namespace {

using Json = nlohmann::ordered_json;

// nlohmann writes what is not a number as null.
Json interval_json(const Interval& interval) { return Json::array({interval.low, interval.high}); }

Json measure_json(const CellResult& cell, const Measure& measure) {
  if (measure.kind == Measure::Kind::kEvent) {
    const ShareEstimate share = share_of(cell, measure);
    return {{"count", share.count},
            {"events", share.events},
            {"share", share.share},
            {"confidence_95", interval_json(share.confidence_95)}};
  }
  const MeanEstimate mean = mean_of(cell, measure);
  return {{"count", mean.count},
          {"mean", mean.mean},
          {"standard_deviation", mean.standard_deviation},
          {"confidence_95", interval_json(mean.confidence_95)}};
}

// Settings are text; programs get those that are numbers as numbers.
Json setting_json(const std::string& value) {
  const std::optional<double> number = sim::parse_number(value);
  return number ? Json(*number) : Json(value);
}

std::string_view reason(Stop stop) {
  switch (stop) {
    case Stop::kAllSeeds:
      return "all are played";
    case Stop::kTightEnough:
      return "the intervals are tight enough";
    case Stop::kTooMany:
      return "too many had failed";
    case Stop::kBudget:
      return "the time was over";
  }
  return {};
}

// A mean of a hair less than zero is zero, not -0.0.
std::string fixed_text(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string table_cell(const CellResult& cell, const Measure& measure) {
  if (measure.kind == Measure::Kind::kEvent) {
    const ShareEstimate share = share_of(cell, measure);
    if (share.count == 0) return "-";
    return fmt::format("{} of {} ({:.0f} .. {:.0f} %)", share.events, share.count,
                       100.0 * share.confidence_95.low, 100.0 * share.confidence_95.high);
  }
  const MeanEstimate mean = mean_of(cell, measure);
  if (mean.count == 0) return "-";
  const std::string value = fixed_text(measure.factor * mean.mean, measure.decimals);
  if (mean.count == 1) return value;
  const std::string reach =
      fmt::format("{:.{}f}", measure.factor * mean.confidence_95.half_width(), measure.decimals);
  const std::string few = mean.count < cell.played.size() ? fmt::format(" (n = {})", mean.count) : "";
  return value + " +- " + reach + few;
}

std::string padded(const std::string& text, std::size_t width, bool first) {
  return first ? fmt::format("{:<{}}", text, width) : fmt::format("{:>{}}", text, width);
}

}  // namespace

std::string stop_name(Stop stop) {
  switch (stop) {
    case Stop::kAllSeeds:
      return "all_seeds";
    case Stop::kTightEnough:
      return "tight_enough";
    case Stop::kTooMany:
      return "too_many";
    case Stop::kBudget:
      return "budget";
  }
  return {};
}

std::string table_text(const Row& head, const std::vector<Row>& rows, TableStyle style) {
  const bool markdown = style == TableStyle::kMarkdown;
  std::vector<std::size_t> widths(head.size());
  for (std::size_t c = 0; c < head.size(); ++c) {
    widths[c] = head[c].size();
    for (const Row& row : rows) widths[c] = std::max(widths[c], row.at(c).size());
  }
  const auto line = [&](const Row& row) {
    std::string text = markdown ? "|" : "";
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (markdown) {
        text += " " + row[c] + " |";
      } else {
        text += (c > 0 ? "  " : "") + padded(row[c], widths[c], c == 0);
      }
    }
    return text + "\n";
  };
  std::string text = line(head);
  if (markdown) {
    text += "|";
    for (std::size_t c = 0; c < head.size(); ++c) text += c == 0 ? " --- |" : " ---: |";
    text += "\n";
  }
  for (const Row& row : rows) text += line(row);
  return text;
}

std::string result_table(const Experiment& experiment, const ExperimentResult& result, TableStyle style) {
  Row head;
  for (const auto& [name, value] : experiment.cells.front().settings) head.push_back(name);
  head.push_back("trials");
  for (const Measure& measure : experiment.measures) {
    if (!measure.label.empty()) head.push_back(measure.label);
  }
  std::vector<Row> rows;
  for (std::size_t c = 0; c < experiment.cells.size(); ++c) {
    Row row;
    for (const auto& [name, value] : experiment.cells[c].settings) row.push_back(value);
    row.push_back(std::to_string(result.cells[c].played.size()));
    for (const Measure& measure : experiment.measures) {
      if (!measure.label.empty()) row.push_back(table_cell(result.cells[c], measure));
    }
    rows.push_back(row);
  }
  return table_text(head, rows, style);
}

// Which cells have fewer seeds than they should, one line for each reason.
std::string stop_notes(const Experiment& experiment, const ExperimentResult& result) {
  struct Stopped {
    std::string names;
    std::size_t cells = 0;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    std::size_t most = 0;
  };
  constexpr std::size_t kNamed = 4;
  std::map<std::string, Stopped> by_reason;
  for (std::size_t c = 0; c < experiment.cells.size(); ++c) {
    const CellResult& cell = result.cells[c];
    if (cell.stop == Stop::kAllSeeds || cell.played.size() >= experiment.seeds) continue;
    Stopped& stopped = by_reason[std::string(reason(cell.stop))];
    if (stopped.cells < kNamed) stopped.names += (stopped.cells > 0 ? ", " : "") + experiment.cells[c].name;
    ++stopped.cells;
    stopped.fewest = std::min(stopped.fewest, cell.played.size());
    stopped.most = std::max(stopped.most, cell.played.size());
  }
  std::string notes;
  for (const auto& [why, stopped] : by_reason) {
    const std::string names = stopped.cells > kNamed
                                  ? fmt::format("{} of {} cells", stopped.cells, experiment.cells.size())
                                  : stopped.names;
    const std::string played = stopped.fewest == stopped.most
                                   ? std::to_string(stopped.most)
                                   : fmt::format("{} to {}", stopped.fewest, stopped.most);
    notes += fmt::format("{}: stopped after {} of {} seeds, {}\n", names, played, experiment.seeds, why);
  }
  return notes;
}

std::string notes(const Experiment& experiment, const ExperimentResult& result) {
  std::string notes;
  for (std::size_t c = 0; c < experiment.cells.size(); ++c) {
    const CellResult& cell = result.cells[c];
    const std::string& name = experiment.cells[c].name;
    for (const Measure& measure : experiment.measures) {
      if (measure.kind != Measure::Kind::kEvent || !measure.label.empty()) continue;
      const ShareEstimate share = share_of(cell, measure);
      if (share.events > 0)
        notes += fmt::format("{}: {} of {} {}\n", name, share.events, share.count, measure.name);
    }
    std::set<std::string> told;  // each error with the first seed that met it
    for (const Trial& trial : cell.played) {
      const std::string& error = trial.values.error;
      if (!error.empty() && told.insert(error).second)
        notes += fmt::format("{}: seed {}: {}\n", name, trial.seed, error);
    }
  }
  return notes + stop_notes(experiment, result);
}

Json to_json(const Experiment& experiment, const ExperimentResult& result) {
  Json cells = Json::array();
  for (std::size_t c = 0; c < experiment.cells.size(); ++c) {
    const CellResult& cell = result.cells[c];
    Json json{{"cell", experiment.cells[c].name}};
    for (const auto& [name, value] : experiment.cells[c].settings) json[name] = setting_json(value);
    json["trials"] = cell.played.size();
    json["stop"] = stop_name(cell.stop);
    for (const Measure& measure : experiment.measures) json[measure.name] = measure_json(cell, measure);
    cells.push_back(json);
  }
  Json json{{"experiment", experiment.name},
            {"first_seed", experiment.first_seed},
            {"seeds", experiment.seeds},
            {"inputs", experiment.inputs}};
  for (const auto& [name, value] : experiment.conditions) json[name] = setting_json(value);
  json["cells"] = cells;
  return json;
}

std::string to_csv(const Experiment& experiment, const ExperimentResult& result) {
  std::string csv;
  for (const auto& [name, value] : experiment.cells.front().settings) csv += name + ",";
  csv += "seed";
  for (const Measure& measure : experiment.measures) csv += "," + measure.name;
  csv += "\n";
  for (std::size_t c = 0; c < experiment.cells.size(); ++c) {
    for (const Trial& trial : result.cells[c].played) {
      for (const auto& [name, value] : experiment.cells[c].settings) csv += value + ",";
      csv += std::to_string(trial.seed);
      for (const Measure& measure : experiment.measures) {
        const auto value = trial.values.find(measure.name);
        csv += "," + (value == trial.values.end() ? std::string() : sim::number_text(value->second));
      }
      csv += "\n";
    }
  }
  return csv;
}

}  // namespace koboshi::tools
