#include "tools/lab/catalogue/push_recovery.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace koboshi::tools {
namespace {

TEST(Bisection, FindsTheLargestThatIsSurvived) {
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

// Nothing that five seeds did says what 95 of 100 do.
TEST(PushRecovery, SpeaksOfTheWeakestOfFewSeeds) {
  PushRecoveryOptions options;
  options.directions = 1;
  Experiment experiment;
  experiment.cells = {
      {"standing", {{"state", "standing"}, {"without", "nothing"}, {"direction_deg", "0.0"}}}};
  ExperimentResult result;
  result.cells.resize(1);
  for (std::uint64_t seed = 0; seed < 5; ++seed)
    result.cells[0].played.push_back({0, seed, {{"impulse_N_s_per_kg", 0.36}, {"phase", 0.5}}});
  const std::vector<SurvivedPush> pushes = survived_pushes(options, experiment, result);
  EXPECT_EQ(push_recovery_conclusions(pushes).lines,
            "standing: the weakest of 5 survives 0.360 N s/kg, the least towards 0.0 degrees\n");
  EXPECT_EQ(polar_figure(pushes).title.find("95 of 100"), std::string::npos);
}

// Standing survives 0.3 from all sides, walking 0.2, but for one phase of one direction.
TEST(PushRecovery, TellsTheWorstPhaseOfTheWorstDirection) {
  PushRecoveryOptions options;
  options.directions = 2;
  options.phase_bins = 2;
  Experiment experiment;
  ExperimentResult result;
  for (const char* state : {"standing", "walking"}) {
    for (const char* direction : {"0.0", "180.0"}) {
      experiment.cells.push_back({std::string(state) + direction,
                                  {{"state", state}, {"without", "nothing"}, {"direction_deg", direction}}});
      CellResult cell;
      for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const bool late = seed >= 20;
        const bool walks = state == std::string("walking");
        double impulse = walks ? 0.2 : 0.3;
        if (walks && late && direction == std::string("180.0")) impulse = 0.1;
        if (seed == 0) impulse = 0.01;  // one of twenty, or of forty, may do worse
        cell.played.push_back({0, seed, {{"impulse_N_s_per_kg", impulse}, {"phase", late ? 0.9 : 0.1}}});
      }
      result.cells.push_back(cell);
    }
  }
  const std::vector<SurvivedPush> pushes = survived_pushes(options, experiment, result);
  ASSERT_EQ(pushes.size(), 4u);
  EXPECT_DOUBLE_EQ(pushes[3].direction_rad, std::numbers::pi);
  const Conclusions conclusions = push_recovery_conclusions(pushes);
  EXPECT_EQ(conclusions.values.at("standing_min_Ns_per_kg"), 0.3);
  EXPECT_EQ(conclusions.values.at("walking_min_Ns_per_kg"), 0.1);
  EXPECT_NE(conclusions.table(TableStyle::kTerminal).find("180.0"), std::string::npos);

  EXPECT_NE(conclusions.lines.find("standing: 95 of 100 survive, by 40 seeds, 0.300"), std::string::npos);

  const PlaneFigure figure = polar_figure(pushes);
  const std::vector<Point>& walking = figure.curves.back().points;
  EXPECT_NEAR(walking.at(0).y, 0.2, 1e-12) << "pushed forward is up";
  EXPECT_NEAR(walking.at(1).y, -0.1, 1e-12);
  EXPECT_EQ(walking.front(), walking.back()) << "closed";
}

TEST(PushRecovery, CountsHowPushesWereLost) {
  PushRecoveryOptions options;
  options.directions = 1;
  Experiment experiment;
  experiment.cells = {{"walking", {{"state", "walking"}, {"without", "nothing"}, {"direction_deg", "0.0"}}}};
  ExperimentResult result;
  result.cells.resize(1);
  const auto lost = [](double fell, double gave_up) {
    return Values{{"impulse_N_s_per_kg", 0.2}, {"phase", 0.5}, {"fell", fell}, {"gave_up", gave_up}};
  };
  result.cells[0].played = {{0, 1, lost(1, 0)},
                            {0, 2, lost(0, 1)},
                            {0, 3, lost(0, 1)},
                            {0, 4, {{"impulse_N_s_per_kg", 0.3}, {"phase", 0.5}}}};
  const Conclusions conclusions = push_recovery_conclusions(survived_pushes(options, experiment, result));
  EXPECT_NE(conclusions.table(TableStyle::kMarkdown).find("| walking | 1 | 2 | 0 | 0 | 0 |"),
            std::string::npos)
      << conclusions.table(TableStyle::kMarkdown);
}

TEST(PushRecovery, TellsNoFigureOfWhatWasNotPlayed) {
  Experiment experiment;
  experiment.cells = {
      {"standing", {{"state", "standing"}, {"without", "nothing"}, {"direction_deg", "0.0"}}}};
  ExperimentResult result;
  result.cells.resize(1);
  PushRecoveryOptions options;
  options.directions = 1;
  const Conclusions conclusions = push_recovery_conclusions(survived_pushes(options, experiment, result));
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
}  // namespace koboshi::tools
