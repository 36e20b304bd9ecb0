#include "lab/experiment/ladder.h"

#include <gtest/gtest.h>

#include <atomic>

#include "lab/experiment/field_table.h"

namespace koboshi::lab {
namespace {

struct LevelTrial {
  std::string error{};
  bool failed = false;
};

const FieldTable<LevelTrial>& level_fields() {
  static const FieldTable<LevelTrial> kFields{
      Fields<LevelTrial>{{{.name = "failed", .max_share = kMaxFailureShare}, &LevelTrial::failed}}};
  return kFields;
}

// Two ladders of four levels. On each level the seeds up to `failing` fail.
struct Ladders {
  Experiment experiment{
      .name = "ladders",
      .ladders = {{.name = "a", .unit = "m", .cells = {}}, {.name = "b", .unit = "m", .cells = {}}},
      .first_seed = 1,
      .seeds = 40};
  std::vector<std::uint64_t> failing = std::vector<std::uint64_t>(8, 0);  // by cell
  std::atomic<int> played = 0;

  Ladders() {
    for (Ladder& ladder : experiment.ladders) {
      for (const char* level : {"1", "2", "3", "4"}) {
        ladder.cells.push_back(experiment.cells.size());
        experiment.cells.push_back({ladder.name + level, {{"ladder", ladder.name}, {"level", level}}});
      }
    }
    set_trials(experiment, level_fields(), [this](std::size_t cell, std::uint64_t seed) {
      ++played;
      return LevelTrial{.failed = seed <= failing[cell]};
    });
  }
  Ladders(const Ladders&) = delete;
  Ladders& operator=(const Ladders&) = delete;

  Climb climb(std::size_t ladder, const ExperimentResult& result) const {
    return climb_of(experiment.ladders[ladder], result);
  }
  std::string line(std::size_t ladder, const ExperimentResult& result) const {
    return climb_line(experiment, experiment.ladders[ladder], climb(ladder, result));
  }
};

TEST(Ladder, IsClimbedUntilMoreThanFiveOfAHundredFail) {
  Ladders test;
  test.failing = {0, 2, 3, 0, 0, 0, 0, 2};  // of 40, two may fail
  const ExperimentResult result = play_experiment(test.experiment, {});
  EXPECT_EQ(test.climb(0, result).highest, 1u);
  EXPECT_EQ(test.climb(0, result).stop, Stop::kTooMany);
  EXPECT_EQ(result.cells[3].stop, Stop::kNotReached) << "the level beyond the one that failed is left out";
  EXPECT_EQ(test.climb(1, result).highest, 7u);
  EXPECT_EQ(test.climb(1, result).stop, Stop::kAllSeeds);
  EXPECT_EQ(test.line(0, result), "a: up to 2; the next is too much\n");
  EXPECT_EQ(test.line(1, result), "b: up to 4; nothing beyond was tried\n");
}

TEST(Ladder, StopsALevelOnceItsFailureIsCertain) {
  Ladders test;
  test.failing[0] = test.failing[4] = 40;
  const ExperimentResult result = play_experiment(test.experiment, {.batch = 10});
  EXPECT_EQ(test.played, 20);
  EXPECT_FALSE(test.climb(0, result).highest);
  EXPECT_EQ(test.line(0, result), "a: at no level; the next is too much\n");
}

TEST(Ladder, ReportsThatTheTimeLimitWasReached) {
  Ladders test;
  const ExperimentResult result =
      play_experiment(test.experiment, {.budget = std::chrono::duration<double>(0.0)});
  EXPECT_EQ(test.played, 0);
  EXPECT_EQ(test.climb(1, result).stop, Stop::kBudget);
  EXPECT_FALSE(test.climb(1, result).highest);
}

TEST(Ladder, ShowsLevelsAsFractionsOfTheHardest) {
  Ladders test;
  test.failing[1] = 10;
  const ExperimentResult result = play_experiment(test.experiment, {});
  const tools::PlaneFigure figure = ladder_figure("ladders", test.experiment, result);
  ASSERT_EQ(figure.curves.size(), 3u);
  EXPECT_EQ(figure.curves[1].points, (std::vector<tools::Point>{{0.25, 0.0}, {0.5, 1.0}}));
  EXPECT_EQ(figure.curves[2].points.back(), (tools::Point{1.0, 0.0}));
}

}  // namespace
}  // namespace koboshi::lab
