#include "lab/experiment/report.h"

#include <gtest/gtest.h>

#include "tests/unit/lab/experiment/stand_in.h"

namespace koboshi::lab {
namespace {

using test::StandIn;

// Three trials in one cell, one in the other, which the budget ended.
ExperimentResult few_trials() {
  const auto trial = [](std::size_t cell, std::uint64_t seed, const test::StandInTrial& played) {
    return Trial{cell, seed, test::stand_in_fields().record(played)};
  };
  ExperimentResult result;
  result.cells.push_back({Stop::kAllSeeds,
                          {trial(0, 1, {.speed_m_per_s = 0.1}), trial(0, 2, {.speed_m_per_s = 0.3}),
                           trial(0, 3, {.fell = true})}});
  result.cells.push_back({Stop::kBudget, {trial(1, 1, {.fell = true})}});
  return result;
}

TEST(Report, AlignsATableForATerminal) {
  StandIn stand_in;
  EXPECT_EQ(result_table(stand_in.experiment, few_trials(), TableStyle::kTerminal),
            "ground  trials                 falls             speed [mm/s]\n"
            "even         3    1 of 3 (6 .. 79 %)  200.0 +- 1270.6 (n = 2)\n"
            "rough        1  1 of 1 (21 .. 100 %)                        -\n");
}

TEST(Report, WritesAMarkdownTable) {
  StandIn stand_in;
  EXPECT_EQ(result_table(stand_in.experiment, few_trials(), TableStyle::kMarkdown),
            "| ground | trials | falls | speed [mm/s] |\n"
            "| --- | ---: | ---: | ---: |\n"
            "| even | 3 | 1 of 3 (6 .. 79 %) | 200.0 +- 1270.6 (n = 2) |\n"
            "| rough | 1 | 1 of 1 (21 .. 100 %) | - |\n");
}

TEST(Report, ReportsWhichCellsStoppedEarly) {
  StandIn stand_in;
  EXPECT_EQ(notes(stand_in.experiment, few_trials()),
            "shaky: stopped after 1 of 25 seeds, the time was over\n");
}

TEST(Report, ReportsEventsWithoutAColumn) {
  StandIn stand_in;
  stand_in.experiment.metrics.push_back({.name = "failed", .is_event = true});
  ExperimentResult result = few_trials();
  result.cells[1].stop = Stop::kTightEnough;
  for (CellResult& cell : result.cells) {
    for (Trial& trial : cell.played) trial.record.values.push_back(std::nullopt);
  }
  result.cells[0].played[2].record.values.back() = 1.0;
  result.cells[0].played[2].record.error = "the world blew up";
  EXPECT_EQ(notes(stand_in.experiment, result),
            "calm: 1 of 1 failed\n"
            "calm: seed 3: the world blew up\n"
            "shaky: stopped after 1 of 25 seeds, the intervals are tight enough\n");
}

TEST(Report, OmitsCellsThatWereNotReached) {
  StandIn stand_in;
  ExperimentResult result = few_trials();
  result.cells[1] = {.stop = Stop::kNotReached};
  EXPECT_EQ(to_json(stand_in.experiment, result)["cells"].size(), 1u);
  EXPECT_EQ(to_csv(stand_in.experiment, result).find("rough"), std::string::npos);
  EXPECT_EQ(result_table(stand_in.experiment, result, TableStyle::kTerminal).find("rough"),
            std::string::npos);
  EXPECT_EQ(notes(stand_in.experiment, result), "");
}

TEST(Report, WritesOneLinePerTrial) {
  StandIn stand_in;
  EXPECT_EQ(to_csv(stand_in.experiment, few_trials()),
            "ground,seed,fell,speed_m_per_s\n"
            "even,1,0,0.1\n"
            "even,2,0,0.3\n"
            "even,3,1,\n"
            "rough,1,1,\n");
}

TEST(Report, WritesJsonInSiUnitsWithNullForNaN) {
  StandIn stand_in;
  stand_in.experiment.conditions = {{"duration_s", "30"}, {"disturbed", "no"}};
  const auto json = nlohmann::ordered_json::parse(to_json(stand_in.experiment, few_trials()).dump());
  EXPECT_EQ(json["experiment"], "stand-in");
  EXPECT_EQ(json["first_seed"], 100);
  EXPECT_EQ(json["duration_s"], 30);
  EXPECT_EQ(json["disturbed"], "no");
  const auto& cell = json["cells"][0];
  EXPECT_EQ(cell["cell"], "calm");
  EXPECT_EQ(cell["ground"], "even");
  EXPECT_EQ(cell["trials"], 3);
  EXPECT_EQ(cell["stop"], "all_seeds");
  EXPECT_EQ(cell["fell"]["events"], 1);
  EXPECT_DOUBLE_EQ(cell["speed_m_per_s"]["mean"], 0.2);
  EXPECT_EQ(cell["speed_m_per_s"]["count"], 2);
  EXPECT_EQ(json["cells"][1]["stop"], "budget");
  EXPECT_TRUE(json["cells"][1]["speed_m_per_s"]["mean"].is_null());
}

}  // namespace
}  // namespace koboshi::lab
