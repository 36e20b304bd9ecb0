#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lab/experiment/report.h"
#include "lab/validate/validation.h"

namespace koboshi::lab {

// The results of validations, in all formats.

struct ValidationResult {
  Validation validation;
  Findings findings;

  bool passed() const;
};

// Runs a validation. A simulation that diverges gives a check that fails.
[[nodiscard]] ValidationResult play(const Validation& validation, const ValidationSetup& setup);

// A table with a row per check.
[[nodiscard]] std::string check_table(const std::vector<Check>& checks, TableStyle style);
// A table with a row per validation: the number of passed checks, and the check nearest to its tolerance.
[[nodiscard]] std::string overview_table(const std::vector<ValidationResult>& results, TableStyle style);

// Independent of the machine and the time. NaN becomes null.
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

}  // namespace koboshi::lab
