#include "lab/catalogue/push_recovery.h"

#include <gtest/gtest.h>

namespace koboshi::lab {
namespace {

TEST(Bisection, FindsTheLargestSurvivedValue) {
  int asked = 0;
  const auto up_to = [&](double largest) {
    return [&asked, largest](double impulse) {
      ++asked;
      return impulse <= largest;
    };
  };
  EXPECT_DOUBLE_EQ(largest_survived(0.8, 4, up_to(0.33)), 0.3);
  EXPECT_EQ(asked, 4);
  EXPECT_EQ(largest_survived(0.8, 4, up_to(-1.0)), 0.0);
  EXPECT_DOUBLE_EQ(largest_survived(0.8, 4, up_to(2.0)), 0.75);
}

// Plays nothing: the trials are given, the cells follow from the options.
Conclusions conclude(const PushRecoveryOptions& options, const std::vector<std::vector<PushTrial>>& cells) {
  ExperimentResult result;
  for (const std::vector<PushTrial>& trials : cells) {
    CellResult& cell = result.cells.emplace_back();
    for (const PushTrial& trial : trials) cell.played.push_back({.record = push_fields().record(trial)});
  }
  return push_recovery_conclusions(survived_pushes(options, result));
}

PushRecoveryOptions one_cell(const std::string& state) {
  PushRecoveryOptions options;
  options.states = {state};
  options.directions = 1;
  return options;
}

// Five seeds do not show what 95 of 100 do.
TEST(PushRecovery, ReportsTheWeakestOfFewSeeds) {
  const std::vector<PushTrial> trials(5, {.impulse_N_s_per_kg = 0.36, .phase = 0.5});
  const Conclusions conclusions = conclude(one_cell("standing"), {trials});
  EXPECT_EQ(conclusions.lines,
            "standing: the weakest of 5 survives 0.360 N s/kg, the least towards 0.0 degrees\n");
  EXPECT_EQ(conclusions.figure.value().title.find("95 of 100"), std::string::npos);
}

// Standing survives 0.3 from all sides, walking 0.2, but for one phase of one direction.
TEST(PushRecovery, ReportsTheWorstPhaseOfTheWorstDirection) {
  PushRecoveryOptions options;
  options.directions = 2;
  options.phase_bins = 2;
  std::vector<std::vector<PushTrial>> cells;
  for (const bool walks : {false, true}) {
    for (const bool backward : {false, true}) {
      std::vector<PushTrial>& trials = cells.emplace_back();
      for (int seed = 0; seed < 40; ++seed) {
        const bool late = seed >= 20;
        double impulse = walks ? 0.2 : 0.3;
        if (walks && late && backward) impulse = 0.1;
        if (seed == 0) impulse = 0.01;  // one of twenty, or of forty, may do worse
        trials.push_back({.impulse_N_s_per_kg = impulse, .phase = late ? 0.9 : 0.1});
      }
    }
  }
  const Conclusions conclusions = conclude(options, cells);
  EXPECT_EQ(conclusions.values.at("standing_min_Ns_per_kg"), 0.3);
  EXPECT_EQ(conclusions.values.at("walking_min_Ns_per_kg"), 0.1);
  EXPECT_NE(conclusions.table(TableStyle::kTerminal).find("180.0"), std::string::npos);

  EXPECT_NE(conclusions.lines.find("standing: 95 of 100 survive, by 40 seeds, 0.300"), std::string::npos);

  const std::vector<tools::Point>& walking = conclusions.figure.value().curves.back().points;
  EXPECT_NEAR(walking.at(0).y, 0.2, 1e-12) << "pushed forward is up";
  EXPECT_NEAR(walking.at(1).y, -0.1, 1e-12);
  EXPECT_EQ(walking.front(), walking.back()) << "closed";
}

TEST(PushRecovery, CountsTheOutcomesOfFailedPushes) {
  const auto lost = [](Outcome outcome) {
    return PushTrial{.impulse_N_s_per_kg = 0.2, .phase = 0.5, .lost_by = outcome};
  };
  const Conclusions conclusions =
      conclude(one_cell("walking"), {{lost(Outcome::kFell),
                                      lost(Outcome::kGaveUp),
                                      lost(Outcome::kGaveUp),
                                      {.impulse_N_s_per_kg = 0.3, .phase = 0.5}}});
  EXPECT_NE(conclusions.table(TableStyle::kMarkdown).find("| walking | 1 | 2 | 0 | 0 | 0 |"),
            std::string::npos)
      << conclusions.table(TableStyle::kMarkdown);
}

TEST(PushRecovery, ReportsNoResultForSkippedTrials) {
  const Conclusions conclusions = conclude(one_cell("standing"), {{}});
  EXPECT_FALSE(conclusions.values.contains("standing_min_Ns_per_kg"));
  EXPECT_EQ(conclusions.lines, "standing: some directions were not played\n");
}

TEST(Feedbacks, AreParametersOfTheController) {
  for (const Feedback& feedback : feedbacks()) {
    PushRecoveryOptions options;
    options.scenario = KOBOSHI_SOURCE_DIR "/scenarios/go.yaml";
    options.ablate = {feedback.name};
    const Experiment experiment = make_push_recovery(options);
    EXPECT_EQ(experiment.cells.size(), 64u);
    options.states = {"standing"};
    EXPECT_EQ(make_push_recovery(options).cells.size(), 32u);
  }
}

}  // namespace
}  // namespace koboshi::lab
