#include "lab/experiment/field_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lab/trial/outcome.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::lab {
namespace {

enum class Pose { kNone, kProne, kSupine };

struct Figures {
  double speed_m_per_s = std::numeric_limits<double>::quiet_NaN();
};

struct FieldTrial {
  std::string error{};
  Outcome outcome = Outcome::kSurvived;
  std::optional<Outcome> lost_by{};
  bool down = false;
  std::optional<bool> missed{};
  int attempts = 0;
  Pose pose = Pose::kNone;
  std::optional<double> time_s{};
  Figures figures{};
};

FieldTable<FieldTrial> fields() {
  using T = FieldTrial;
  return {Fields<T>{{{.name = "down"}, &T::down},
                    {{.name = "missed"}, &T::missed},
                    {{.name = "attempts"}, &T::attempts},
                    {{.name = "pose"}, &T::pose},
                    {{.name = "time_s"}, &T::time_s},
                    {{.name = "speed_m_per_s"}, &T::figures, &Figures::speed_m_per_s}},
          outcome_fields<T>(&T::outcome)};
}

TEST(FieldTable, DistinguishesEventsFromQuantities) {
  const std::vector<Metric> metrics = fields().metrics();
  ASSERT_EQ(metrics.size(), 11u);
  for (std::size_t i = 0; i < metrics.size(); ++i) EXPECT_EQ(metrics[i].is_event, i < 2 || i > 5) << i;
}

TEST(FieldTable, RejectsDuplicateFieldNames) {
  using T = FieldTrial;
  const Fields<T> down{{{.name = "down"}, &T::down}};
  EXPECT_THROW((FieldTable<T>{down, down}), std::logic_error);
  EXPECT_THROW((FieldTable<T>{Fields<T>{{{.name = "seed"}, &T::attempts}}}), std::logic_error)
      << "a column of trials.csv";
}

// An experiment of this one trial, played with a log.
FieldTrial through_log(const FieldTrial& trial, int* played) {
  const koboshi::test::TemporaryFolder folder;
  Experiment experiment{.name = "one", .cells = {{"cell", {}}}};
  set_trials(experiment, fields(), [&](std::size_t, std::uint64_t) {
    ++*played;
    return trial;
  });
  FieldTrial read;
  for (int session = 0; session < 2; ++session) {
    const ExperimentResult result = play_experiment(experiment, {.log = folder.path / "trials.jsonl"});
    read = fields().trials(result.cells.front()).at(0);
  }
  return read;
}

TEST(FieldTable, RoundTripsATrialThroughTheLog) {
  int played = 0;
  const FieldTrial trial = through_log({.error = "it \"failed\"",
                                        .outcome = Outcome::kFailed,
                                        .down = true,
                                        .missed = false,
                                        .attempts = 3,
                                        .pose = Pose::kSupine,
                                        .time_s = 0.1,
                                        .figures = {.speed_m_per_s = -0.25}},
                                       &played);
  EXPECT_EQ(played, 1);
  EXPECT_EQ(trial.error, "it \"failed\"");
  EXPECT_EQ(trial.outcome, Outcome::kFailed);
  EXPECT_TRUE(trial.down);
  EXPECT_EQ(trial.missed, false);
  EXPECT_EQ(trial.attempts, 3);
  EXPECT_EQ(trial.pose, Pose::kSupine);
  EXPECT_EQ(trial.time_s, 0.1);
  EXPECT_EQ(trial.figures.speed_m_per_s, -0.25);
}

TEST(FieldTable, ReadsMissingValuesBackAsMissing) {
  int played = 0;
  const FieldTrial trial = through_log({.time_s = std::numeric_limits<double>::infinity()}, &played);
  EXPECT_EQ(trial.error, "");
  EXPECT_EQ(trial.outcome, Outcome::kSurvived);
  EXPECT_EQ(trial.missed, std::nullopt);
  EXPECT_EQ(trial.time_s, std::nullopt);
  EXPECT_TRUE(std::isnan(trial.figures.speed_m_per_s));
}

TEST(FieldTable, DistinguishesNoOutcomeFromSurvival) {
  using T = FieldTrial;
  const FieldTable<T> table{outcome_fields<T>(&T::lost_by)};
  for (const std::optional<Outcome> outcome :
       {std::optional<Outcome>(), std::optional(Outcome::kSurvived), std::optional(Outcome::kGaveUp)}) {
    EXPECT_EQ(table.trial(table.record({.lost_by = outcome})).lost_by, outcome);
  }
  EXPECT_EQ(table.record({}).values.front(), std::nullopt);
}

TEST(FieldTable, TakesStatisticsOfMembers) {
  const std::vector<FieldTrial> trials{
      {.down = true, .attempts = 1, .time_s = 2.0}, {.attempts = 2, .time_s = 4.0}, {.attempts = 3}};
  EXPECT_EQ(share_of(trials, &FieldTrial::down).events, 1u);
  EXPECT_EQ(mean_of(trials, &FieldTrial::attempts).mean, 2.0);
  EXPECT_EQ(mean_of(trials, &FieldTrial::time_s).count, 2u);
  EXPECT_EQ(share_of(trials, &FieldTrial::missed).count, 0u);
}

}  // namespace
}  // namespace koboshi::lab
