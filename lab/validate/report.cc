#include "lab/validate/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "sim_board/world/options.h"
#include "sim_board/world/world.h"
#include "tools/plot/figure.h"

namespace koboshi::lab {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value) { return fmt::format("{:.6g}", value); }
std::string rough(double value) { return value == 0.0 ? "0" : fmt::format("{:.1e}", value); }

std::string quantity(const Check& check) {
  return check.unit == "1" ? check.quantity : fmt::format("{} [{}]", check.quantity, check.unit);
}

// The share of its tolerance that a check uses; infinite for NaN.
double use(const Check& check) {
  if (std::isnan(check.error())) return std::numeric_limits<double>::infinity();
  if (check.error() == 0.0) return 0.0;
  return std::abs(check.error()) / check.tolerance;
}

}  // namespace

std::vector<Validation> all_validations() {
  return {
      free_fall(),         bounce(),         slope(),         pendulum_swing(), tennis_racket(), momentum(),
      inverted_pendulum(), servo_response(), friction_loop(), zmp_comparison(), convergence()};
}

bool ValidationResult::passed() const { return std::ranges::all_of(findings.checks, &Check::passed); }

ValidationResult play(const Validation& validation, const ValidationSetup& setup) {
  try {
    return {validation, validation.run(setup)};
  } catch (const sim_board::WorldBlewUp& error) {
    const double nan = std::nan("");
    return {validation, {.checks = {{error.what(), "1", nan, nan, 0.0}}}};
  }
}

std::string check_table(const std::vector<Check>& checks, TableStyle style) {
  std::vector<Row> rows;
  for (const Check& check : checks) {
    rows.push_back({quantity(check), number(check.theory), number(check.simulated), rough(check.error()),
                    rough(check.tolerance), check.passed() ? "yes" : "NO"});
  }
  return table_text({"quantity", "theory", "simulated", "error", "tolerance", "within"}, rows, style);
}

std::string overview_table(const std::vector<ValidationResult>& results, TableStyle style) {
  std::vector<Row> rows;
  for (const ValidationResult& result : results) {
    const std::vector<Check>& checks = result.findings.checks;
    const auto nearest = std::ranges::max_element(checks, {}, use);
    rows.push_back({result.validation.title,
                    fmt::format("{} of {}", std::ranges::count_if(checks, &Check::passed), checks.size()),
                    fmt::format("{:.2f}", use(*nearest)), nearest->quantity});
  }
  return table_text({"experiment", "within tolerance", "largest error / tolerance", "of"}, rows, style);
}

Json to_json(const std::vector<ValidationResult>& results, const ValidationSetup& setup) {
  Json experiments = Json::array();
  for (const ValidationResult& result : results) {
    Json checks = Json::array();
    for (const Check& check : result.findings.checks) {
      checks.push_back({{"quantity", check.quantity},
                        {"unit", check.unit},
                        {"theory", check.theory},
                        {"simulated", check.simulated},
                        {"error", check.error()},
                        {"tolerance", check.tolerance},
                        {"passed", check.passed()}});
    }
    experiments.push_back(
        {{"experiment", result.validation.name}, {"passed", result.passed()}, {"checks", checks}});
  }
  return {{"stepper", sim_board::name_of(setup.world.stepper)},
          {"step_s", setup.world.step_s},
          {"short", setup.short_form},
          {"passed", std::ranges::all_of(results, &ValidationResult::passed)},
          {"experiments", experiments}};
}

std::string to_csv(const std::vector<ValidationResult>& results) {
  std::vector<Row> rows;
  for (const ValidationResult& result : results) {
    for (const Check& check : result.findings.checks) {
      rows.push_back({result.validation.name, check.quantity, check.unit, csv_cell(check.theory),
                      csv_cell(check.simulated), csv_cell(check.error()), csv_cell(check.tolerance),
                      check.passed() ? "1" : "0"});
    }
  }
  return table_text({"experiment", "quantity", "unit", "theory", "simulated", "error", "tolerance", "passed"},
                    rows, TableStyle::kCsv);
}

void draw_plots(const ValidationResult& result, const std::filesystem::path& folder) {
  for (const Plot& plot : result.findings.plots)
    tools::draw_with_csv(plot.figure, plot.columns, folder / plot.name);
}

std::string page_text(const std::vector<ValidationResult>& results, const std::string& command_line,
                      const std::string& date, const std::string& figures) {
  std::string text = fmt::format("\nMade on {} by\n\n```console not-run\n$ {}\n```\n\n{}", date, command_line,
                                 overview_table(results, TableStyle::kMarkdown));
  for (const ValidationResult& result : results) {
    const Validation& validation = result.validation;
    text += fmt::format("\n## {}\n\n{}\n\n*Tolerances.* {}\n\n{}", validation.title, validation.theory,
                        validation.tolerances, check_table(result.findings.checks, TableStyle::kMarkdown));
    for (const Plot& plot : result.findings.plots) {
      text += fmt::format("\n![{}]({}/{}.png)\n\n{}\n", plot.figure.title, figures, plot.name, plot.caption);
    }
  }
  return text + "\n";
}

}  // namespace koboshi::lab
