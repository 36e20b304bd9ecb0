#include "tools/lab/experiment/ladder.h"

#include <gtest/gtest.h>

#include <atomic>

namespace koboshi::tools {
namespace {

// Three ladders of four levels. On each level the seeds up to `failing` fail; none, on all others.
struct Ladders {
  Experiment experiment{
      .name = "ladders",
      .measures = {{.name = "failed", .kind = Measure::Kind::kEvent, .most_share = kMostFailures}},
      .first_seed = 1,
      .seeds = 40};
  std::vector<Ladder> ladders{{.name = "a", .unit = "m", .cells = {}},
                              {.name = "b", .unit = "m", .cells = {}}};
  std::vector<std::uint64_t> failing = std::vector<std::uint64_t>(8, 0);  // by cell
  std::atomic<int> played = 0;

  Ladders() {
    for (Ladder& ladder : ladders) {
      for (const char* level : {"1", "2", "3", "4"}) {
        ladder.cells.push_back(experiment.cells.size());
        experiment.cells.push_back({ladder.name + level, {{"ladder", ladder.name}, {"level", level}}});
      }
    }
    experiment.play = [this](std::size_t cell, std::uint64_t seed) {
      ++played;
      return Values{{"failed", seed <= failing[cell] ? 1.0 : 0.0}};
    };
  }
};

TEST(Ladder, IsClimbedUntilMoreThanFiveOfAHundredFail) {
  Ladders test;
  test.failing = {0, 2, 3, 0, 0, 0, 0, 2};  // of 40, two may fail
  const ClimbResult result = climb(test.experiment, test.ladders, {});
  ASSERT_EQ(result.climbs.size(), 2u);
  EXPECT_EQ(result.climbs[0].highest, 1u);
  EXPECT_EQ(result.climbs[0].levels, 3u) << "the level beyond the one that failed is left out";
  EXPECT_EQ(result.climbs[0].stop, Stop::kTooMany);
  ASSERT_EQ(result.experiment.cells.size(), 7u);
  EXPECT_EQ(result.experiment.cells[*result.climbs[1].highest].name, "b4");
  EXPECT_EQ(result.climbs[1].stop, Stop::kAllSeeds);
  EXPECT_EQ(climb_line(test.ladders[0], result.climbs[0], result), "a: up to 2; the next is too much\n");
  EXPECT_EQ(climb_line(test.ladders[1], result.climbs[1], result), "b: up to 4; nothing beyond was tried\n");
}

TEST(Ladder, PlaysNoMoreOfALevelThanFailureNeeds) {
  Ladders test;
  test.failing[0] = test.failing[4] = 40;
  const ClimbResult result = climb(test.experiment, test.ladders, {.batch = 10});
  EXPECT_EQ(test.played, 20);
  EXPECT_FALSE(result.climbs[0].highest);
  EXPECT_EQ(climb_line(test.ladders[0], result.climbs[0], result), "a: at no level; the next is too much\n");
}

TEST(Ladder, SaysThatTheTimeWasOver) {
  Ladders test;
  const ClimbResult result =
      climb(test.experiment, test.ladders, {.budget = std::chrono::duration<double>(0.0)});
  EXPECT_EQ(test.played, 0);
  EXPECT_EQ(result.climbs[1].stop, Stop::kBudget);
  EXPECT_FALSE(result.climbs[1].highest);
}

TEST(Ladder, ShowsLevelsAsSharesOfTheHardest) {
  Ladders test;
  test.failing[1] = 10;
  const ClimbResult result = climb(test.experiment, test.ladders, {});
  const PlaneFigure figure = ladder_figure("ladders", test.experiment, test.ladders, result);
  ASSERT_EQ(figure.curves.size(), 3u);
  EXPECT_EQ(figure.curves[1].points, (std::vector<Point>{{0.25, 0.0}, {0.5, 1.0}}));
  EXPECT_EQ(figure.curves[2].points.back(), (Point{1.0, 0.0}));
}

}  // namespace
}  // namespace koboshi::tools
