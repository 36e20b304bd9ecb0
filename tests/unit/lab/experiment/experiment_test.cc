#include "lab/experiment/experiment.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "base/text/error.h"
#include "lab/experiment/report.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/lab/experiment/stand_in.h"

namespace koboshi::lab {
namespace {

using koboshi::test::read_file;
using koboshi::test::TemporaryFolder;
using koboshi::test::write_file;
using test::StandIn;

std::string results(const Experiment& experiment, const ExperimentOptions& options) {
  const ExperimentResult result = play_experiment(experiment, options);
  return to_csv(experiment, result) + to_json(experiment, result).dump();
}

TEST(Experiment, RunsEverySeedInEveryCell) {
  StandIn stand_in;
  const ExperimentResult result = play_experiment(stand_in.experiment, {});
  EXPECT_EQ(stand_in.played, 50);
  for (const CellResult& cell : result.cells) {
    EXPECT_EQ(cell.stop, Stop::kAllSeeds);
    ASSERT_EQ(cell.played.size(), 25u);
    for (std::size_t i = 0; i < 25; ++i) EXPECT_EQ(cell.played[i].seed, 100 + i);
  }
}

TEST(Experiment, IsIndependentOfTheNumberOfThreads) {
  StandIn stand_in;
  stand_in.experiment.metrics[1].tight_at = 0.006;  // so that cells stop early, too
  const std::string alone = results(stand_in.experiment, {.jobs = 1});
  for (const std::size_t jobs : {2u, 5u, 64u}) EXPECT_EQ(results(stand_in.experiment, {.jobs = jobs}), alone);
}

TEST(Experiment, StopsACellOnceItsIntervalsAreNarrow) {
  StandIn stand_in;
  stand_in.experiment.seeds = 1000;
  stand_in.experiment.metrics[0].tight_at = 0.1;  // 20 trials without a fall: +- 0.08
  stand_in.experiment.metrics[1].tight_at = 0.006;
  const ExperimentResult result = play_experiment(stand_in.experiment, {.batch = 10});
  EXPECT_EQ(result.cells[0].stop, Stop::kTightEnough);
  EXPECT_EQ(result.cells[0].played.size(), 20u);
  EXPECT_EQ(result.cells[1].stop, Stop::kTightEnough);
  EXPECT_GT(result.cells[1].played.size(), 60u);  // a third falls: +- 0.1 takes about 85 trials
  EXPECT_LT(result.cells[1].played.size(), 120u);
}

TEST(Experiment, ResumesAfterAnInterruption) {
  const TemporaryFolder folder;
  const ExperimentOptions options{.log = folder.path / "trials.jsonl", .jobs = 2};
  StandIn whole;
  const std::string expected = results(whole.experiment, {});

  StandIn interrupted;
  interrupted.set([&](std::size_t cell, std::uint64_t seed) {
    if (seed == 111) throw std::runtime_error("the power failed");
    return interrupted.play(cell, seed);
  });
  EXPECT_THROW(static_cast<void>(play_experiment(interrupted.experiment, options)), std::runtime_error);
  const int before = interrupted.played;
  EXPECT_GE(before, 22);

  StandIn resumed;
  EXPECT_EQ(results(resumed.experiment, options), expected);
  EXPECT_EQ(before + resumed.played, 50);
  StandIn again;
  EXPECT_EQ(results(again.experiment, options), expected);
  EXPECT_EQ(again.played, 0);
}

TEST(Experiment, RepeatsATrialWhoseLineWasCutOff) {
  const TemporaryFolder folder;
  const ExperimentOptions options{.log = folder.path / "trials.jsonl"};
  StandIn first;
  const std::string expected = results(first.experiment, options);
  const std::string whole = read_file(options.log);
  write_file(options.log, whole.substr(0, whole.size() - 20));
  StandIn second;
  EXPECT_EQ(results(second.experiment, options), expected);
  EXPECT_EQ(second.played, 1);
  EXPECT_EQ(read_file(options.log), whole);
}

TEST(Experiment, RepeatsTrialsWhenItsInputsChange) {
  const TemporaryFolder folder;
  const ExperimentOptions options{.log = folder.path / "trials.jsonl"};
  StandIn stand_in;
  results(stand_in.experiment, options);
  stand_in.experiment.inputs = "10";
  results(stand_in.experiment, options);
  EXPECT_EQ(stand_in.played, 100);
}

TEST(Experiment, RecordsWhyATrialFailed) {
  const TemporaryFolder folder;
  const ExperimentOptions options{.log = folder.path / "trials.jsonl"};
  StandIn stand_in;
  stand_in.set([&](std::size_t cell, std::uint64_t seed) {
    test::StandInTrial trial = stand_in.play(cell, seed);
    if (seed == 103) trial.error = "the world \"blew\" up";
    return trial;
  });
  for (int session = 0; session < 2; ++session) {
    const ExperimentResult result = play_experiment(stand_in.experiment, options);
    EXPECT_EQ(result.cells[0].played[3].record.error, "the world \"blew\" up");
    EXPECT_EQ(result.cells[0].played[4].record.error, "");
  }
  EXPECT_EQ(stand_in.played, 50);
}

TEST(Experiment, RejectsAFileThatIsNoLog) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder.path / "letter.txt";
  write_file(log, "{\"dear\": \"reader\"}\n");
  StandIn stand_in;
  EXPECT_THROW(static_cast<void>(play_experiment(stand_in.experiment, {.log = log})), InputError);
  EXPECT_EQ(read_file(log), "{\"dear\": \"reader\"}\n");
}

TEST(Experiment, StartsNoTrialAfterItsTimeLimit) {
  StandIn stand_in;
  const ExperimentResult result =
      play_experiment(stand_in.experiment, {.budget = std::chrono::duration<double>::zero()});
  EXPECT_EQ(stand_in.played, 0);
  for (const CellResult& cell : result.cells) {
    EXPECT_EQ(cell.stop, Stop::kBudget);
    EXPECT_TRUE(cell.played.empty());
  }
}

TEST(Experiment, ReportsItsProgress) {
  StandIn stand_in;
  std::vector<std::size_t> done;
  ExperimentOptions options{.jobs = 3};
  options.progress = [&](const ExperimentProgress& progress) {
    done.push_back(progress.done);
    EXPECT_EQ(progress.total, 50u);
  };
  static_cast<void>(play_experiment(stand_in.experiment, options));
  ASSERT_EQ(done.size(), 50u);
  for (std::size_t i = 0; i < done.size(); ++i) EXPECT_EQ(done[i], i + 1);
}

TEST(Experiment, OmitsNaN) {
  StandIn stand_in;
  stand_in.set([](std::size_t, std::uint64_t) {
    return test::StandInTrial{.speed_m_per_s = std::numeric_limits<double>::quiet_NaN()};
  });
  const ExperimentResult result = play_experiment(stand_in.experiment, {});
  EXPECT_EQ(values_of(result.cells[0], 0).size(), 25u);
  EXPECT_TRUE(values_of(result.cells[0], 1).empty());
}

}  // namespace
}  // namespace koboshi::lab
