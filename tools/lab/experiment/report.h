#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/lab/experiment/experiment.h"

namespace koboshi::tools {

// An experiment's results in every form in which they are read.

// A table as text: columns aligned, for a terminal, or as Markdown.
enum class TableStyle { kTerminal, kMarkdown };
using Row = std::vector<std::string>;
[[nodiscard]] std::string table_text(const Row& head, const std::vector<Row>& rows, TableStyle style);

// A row a cell: its settings, trials, then shares as `1 of 20 (1 .. 24 %)` and means as `0.182 +- 0.003`,
// with 95 % intervals.
[[nodiscard]] std::string result_table(const Experiment& experiment, const ExperimentResult& result,
                                       TableStyle style);
// What a reader of the table must know of how it came about: cells that stopped early, and events that are
// not in the table. Empty, or lines.
[[nodiscard]] std::string notes(const Experiment& experiment, const ExperimentResult& result);

// What an experiment concludes from its cells.
struct Conclusions {
  nlohmann::ordered_json values = nlohmann::ordered_json::object();  // for programs, beside the cells
  std::string lines{};                                               // for readers, below the table
  std::function<std::string(TableStyle)> table{};                    // instead of a row a cell
};

// "too_many": for programs.
[[nodiscard]] std::string stop_name(Stop stop);
// The same for programs, in SI units; nothing that depends on the machine or the time. What is not a number
// is null.
[[nodiscard]] nlohmann::ordered_json to_json(const Experiment& experiment, const ExperimentResult& result);
// One line a trial: the cell's settings, the seed, the measures; empty where there is no value.
[[nodiscard]] std::string to_csv(const Experiment& experiment, const ExperimentResult& result);

}  // namespace koboshi::tools
