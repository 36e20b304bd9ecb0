#include "lab/validate/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "sim_board/world/options.h"
#include "sim_board/world/world.h"

namespace koboshi::lab {
namespace {

using testing::HasSubstr;

ValidationResult result_of(const std::vector<Check>& checks) {
  Validation validation{.name = "fall", .title = "Fall", .theory = "z = -g t^2/2", .tolerances = "g h t/2"};
  validation.run = [checks](const ValidationSetup&) { return Findings{.checks = checks}; };
  return play(validation, {});
}

TEST(Check, PassesUpToItsTolerance) {
  const Check good{.theory = 1.0, .simulated = 1.125, .tolerance = 0.125};
  EXPECT_TRUE(good.passed());
  EXPECT_FALSE((Check{.theory = 1.0, .simulated = 1.25, .tolerance = 0.125}.passed()));
  EXPECT_FALSE((Check{.theory = 1.0, .simulated = 0.75, .tolerance = 0.125}.passed()));
}

TEST(Check, FailsOnNaN) {
  EXPECT_FALSE((Check{.simulated = std::nan(""), .tolerance = 1.0}.passed()));
  EXPECT_FALSE((Check{.tolerance = std::nan("")}.passed()));
}

TEST(ValidationResult, PassesWithAllOfItsChecks) {
  const Check good{.tolerance = 1.0}, bad{.simulated = 2.0, .tolerance = 1.0};
  EXPECT_TRUE(result_of({good, good}).passed());
  EXPECT_FALSE(result_of({good, bad}).passed());
}

TEST(Play, CountsAnUnstableWorldAsAFailure) {
  Validation validation{.name = "boom"};
  validation.run = [](const ValidationSetup&) -> Findings { throw sim_board::WorldBlewUp("it blew up"); };
  const ValidationResult result = play(validation, {});
  EXPECT_FALSE(result.passed());
  EXPECT_THAT(check_table(result.findings.checks, TableStyle::kTerminal), HasSubstr("it blew up"));
}

TEST(Report, HasTheSameContentInEveryFormat) {
  const std::vector<ValidationResult> results{
      result_of({{"height", "m", 2.0, 2.5, 1.0}, {"way, aside", "m", 0.0, std::nan(""), 1.0}})};
  EXPECT_THAT(check_table(results[0].findings.checks, TableStyle::kMarkdown),
              HasSubstr("| height [m] | 2 | 2.5 | 5.0e-01 | 1.0e+00 | yes |"));
  EXPECT_THAT(check_table(results[0].findings.checks, TableStyle::kMarkdown), HasSubstr("| NO |"));
  EXPECT_THAT(overview_table(results, TableStyle::kMarkdown),
              HasSubstr("| Fall | 1 of 2 | inf | way, aside |"));
  EXPECT_THAT(to_csv(results), HasSubstr("\nfall,height,m,2,2.5,0.5,1,1\n"));
  const auto json = to_json(results, {});
  EXPECT_EQ(json["stepper"], "world");
  EXPECT_FALSE(json["passed"].get<bool>());
  EXPECT_EQ(json["experiments"][0]["checks"][0]["error"], 0.5);
  const std::string page = page_text(results, "koboshi validate", "2026-01-02", "figures");
  for (const char* part :
       {"koboshi validate", "2026-01-02", "## Fall", "z = -g t^2/2", "g h t/2", "height"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
}

TEST(Catalogue, NamesItsEntriesAndListsThemOnAnUnknownName) {
  std::set<std::string> names;
  for (const Validation& validation : all_validations()) {
    EXPECT_TRUE(names.insert(validation.name).second) << validation.name;
    EXPECT_FALSE(validation.title.empty() || validation.theory.empty() || validation.tolerances.empty());
  }
}

TEST(StepperName, RoundTrips) {
  for (const std::string_view name : sim_board::stepper_names()) {
    EXPECT_EQ(sim_board::name_of(sim_board::stepper_named(name).value()), name);
  }
  EXPECT_FALSE(sim_board::stepper_named("perfect").has_value());
}

}  // namespace
}  // namespace koboshi::lab
