#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/lab/experiment/report.h"
#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// What the experiments found, in every form in which it is read.

struct ValidationResult {
  Validation validation;
  Findings findings;

  bool passed() const;
};

// Plays it. A world that blows up is a check that failed.
[[nodiscard]] ValidationResult play(const Validation& validation, const ValidationSetup& setup);

// A row a check.
[[nodiscard]] std::string check_table(const std::vector<Check>& checks, TableStyle style);
// A row an experiment: how many checks passed, and which came nearest to its tolerance.
[[nodiscard]] std::string overview_table(const std::vector<ValidationResult>& results, TableStyle style);

// Nothing that depends on the machine or the time. What is not a number is null.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<ValidationResult>& results,
                                             const ValidationSetup& setup);
[[nodiscard]] std::string to_csv(const std::vector<ValidationResult>& results);

// Writes NAME.csv of each plot into the folder, and draws NAME.png and NAME.svg. Throws PlotError,
// std::system_error.
void draw_plots(const ValidationResult& result, const std::filesystem::path& folder);

// The page's generated part: how it was made, the overview, then of each experiment its theory, table and
// figures, which lie in the folder `figures` beside the page.
[[nodiscard]] std::string page_text(const std::vector<ValidationResult>& results,
                                    const std::string& command_line, const std::string& date,
                                    const std::string& figures);

}  // namespace koboshi::tools
