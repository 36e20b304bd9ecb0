#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/table/table.h"
#include "lab/experiment/experiment.h"
#include "tools/plot/panel_grid.h"
#include "tools/plot/plane_figure.h"

namespace koboshi::lab {

// An experiment's results in every form in which they are read. Cells that were not reached are left out.

// A row for each cell: its settings, its number of trials, then shares as `1 of 20 (1 .. 24 %)` and means as
// `0.182 +- 0.003`, with 95 % confidence intervals.
[[nodiscard]] std::string result_table(const Experiment& experiment, const ExperimentResult& result,
                                       TableStyle style);
// Remarks below the table: cells that stopped early, events that are not in the table, and errors. Empty, or
// lines.
[[nodiscard]] std::string notes(const Experiment& experiment, const ExperimentResult& result);

// A figure of small multiples, and the end of its file's name.
struct NamedGrid {
  std::string name;
  tools::PanelGrid grid;
};

// Conclusions that an experiment draws from its cells.
struct Conclusions {
  nlohmann::ordered_json values = nlohmann::ordered_json::object();  // for programs, beside the cells
  std::string lines{};                                               // for readers, below the table
  std::function<std::string(TableStyle)> table{};                    // instead of result_table
  std::optional<tools::PlaneFigure> figure{};
  std::vector<NamedGrid> grids{};  // further figures
};

// "too_many": for programs.
[[nodiscard]] std::string stop_name(Stop stop);
// The same for programs, in SI units; nothing that depends on the machine or the time. Values that are
// no numbers are null.
[[nodiscard]] nlohmann::ordered_json to_json(const Experiment& experiment, const ExperimentResult& result);
// One line a trial: the cell's settings, the seed, the metrics; empty where there is no value.
[[nodiscard]] std::string to_csv(const Experiment& experiment, const ExperimentResult& result);

}  // namespace koboshi::lab
