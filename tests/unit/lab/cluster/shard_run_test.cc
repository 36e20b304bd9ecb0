#include "lab/cluster/shard_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>

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
using test::StandInTrial;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kNever = std::chrono::duration<double>::max();
constexpr auto kAlways = std::chrono::duration<double>::zero();

std::string shard_report(const Experiment& experiment, const ExperimentResult& result) {
  return to_csv(experiment, result) + to_json(experiment, result).dump() + notes(experiment, result);
}

// Makes the stand-in of a test; each program has its own.
using Make = std::function<void(StandIn&)>;

// The report and the log of one program with one thread.
struct Alone {
  explicit Alone(const Make& make) {
    const TemporaryFolder folder;
    StandIn stand_in;
    make(stand_in);
    const ExperimentResult result =
        play_experiment(stand_in.experiment, {.log = folder.path / "trials.jsonl"});
    report = shard_report(stand_in.experiment, result);
    log = read_file(folder.path / "trials.jsonl");
    played = stand_in.played;
  }
  std::string report{};
  std::string log{};
  int played = 0;
};

// Shards in a folder, each played by a program of its own.
class Shards {
 public:
  Shards(Make make, std::size_t count) : count_(count), make_(std::move(make)) {}

  ShardProgress play(std::size_t number, const ShardOptions& options = {}) {
    StandIn stand_in;
    make_(stand_in);
    const ShardProgress progress = play_shard(stand_in.experiment, folder_.path, {number, count_}, options);
    played_ += stand_in.played;
    return progress;
  }
  std::string merge() {
    StandIn stand_in;
    make_(stand_in);
    const ExperimentResult result = merge_shards(stand_in.experiment, folder_.path, count_, log());
    EXPECT_EQ(stand_in.played, 0);
    return shard_report(stand_in.experiment, result);
  }
  std::string merge_error() {
    try {
      static_cast<void>(merge());
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  std::filesystem::path log() const { return folder_.path / "trials.jsonl"; }
  std::filesystem::path file(std::size_t number) const { return shard_file(folder_.path, {number, count_}); }
  int played() const { return played_; }

 private:
  const TemporaryFolder folder_;
  const std::size_t count_;
  const Make make_;
  int played_ = 0;
};

void usual(StandIn&) {}

TEST(Shards, MergeIntoWhatOneProgramWrites) {
  const Alone alone(usual);
  for (const std::size_t count : {1u, 3u, 8u, 60u}) {
    Shards shards(usual, count);
    for (std::size_t number = count; number >= 1; --number)
      EXPECT_TRUE(shards.play(number, {.jobs = number % 3 + 1}).is_complete());
    EXPECT_EQ(shards.played(), 50) << count;
    for (int repeated = 0; repeated < 2; ++repeated) {
      EXPECT_EQ(shards.merge(), alone.report) << count;
      EXPECT_EQ(read_file(shards.log()), alone.log) << count;
    }
  }
}

TEST(Shards, NameTheMissingOnes) {
  Shards shards(usual, 5);
  for (const std::size_t number : {1u, 3u, 5u}) shards.play(number);
  EXPECT_THAT(shards.merge_error(), HasSubstr("incomplete shards: 2 (0 of 10 trials), 4 (0 of 10 trials)"));
  EXPECT_FALSE(std::filesystem::exists(shards.log()));
  shards.play(2);
  shards.play(4);
  EXPECT_EQ(shards.merge(), Alone(usual).report);
}

TEST(Shards, CountWholeLinesOnlyAndResume) {
  Shards shards(usual, 2);
  shards.play(1);
  shards.play(2);
  const std::string whole = read_file(shards.file(2));
  write_file(shards.file(2), whole.substr(0, whole.size() - 20));  // killed while it wrote
  EXPECT_THAT(shards.merge_error(), HasSubstr("incomplete shards: 2 (24 of 25 trials)"));
  EXPECT_EQ(shards.play(2).finished, 25u);
  EXPECT_EQ(shards.played(), 51);
  EXPECT_EQ(read_file(shards.file(2)), whole);
  EXPECT_EQ(shards.merge(), Alone(usual).report);
}

TEST(Shards, AreOfOneProgramAtATime) {
  Shards shards(usual, 2);
  const OutputFile other(shards.file(1), OutputFile::Mode::kAppend);
  EXPECT_THROW(shards.play(1), InputError);
}

TEST(Shards, EndWithTheirBudget) {
  Shards shards(usual, 2);
  const ShardProgress progress = shards.play(1, {.budget = std::chrono::duration<double>::zero()});
  EXPECT_EQ(progress.finished, 0u);
  EXPECT_EQ(progress.remaining, 25u);
}

TEST(Shards, SayThatAnotherProgramPlayedThem) {
  const TemporaryFolder folder;
  StandIn stand_in;
  static_cast<void>(play_shard(stand_in.experiment, folder.path, {1, 1}, {}));
  stand_in.experiment.inputs = "10";
  try {
    static_cast<void>(merge_shards(stand_in.experiment, folder.path, 1, folder.path / "trials.jsonl"));
    FAIL() << "another program's trials were taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("50 trials are of another program or files"));
  }
}

TEST(Shards, RefuseAMalformedLine) {
  Shards shards(usual, 1);
  shards.play(1);
  write_file(shards.file(1), "no trial\n" + read_file(shards.file(1)));
  EXPECT_THAT(shards.merge_error(), HasSubstr("shard-1-of-1.jsonl:1: found a malformed line"));
}

// A cell ends as soon as more than a tenth of its seeds have fallen, which is in its second batch.
void with_a_limit(StandIn& stand_in) { stand_in.experiment.metrics[0].max_share = 0.1; }

TEST(ShardsThatStopEarly, MergeIntoWhatOneProgramWrites) {
  const Alone alone(with_a_limit);
  ASSERT_LT(alone.played, 50);
  EXPECT_THAT(alone.report, HasSubstr("too many had failed"));
  for (const auto refresh_after : {kAlways, kNever}) {
    for (const std::size_t count : {1u, 4u, 9u}) {
      for (const bool backwards : {false, true}) {
        Shards shards(with_a_limit, count);
        for (std::size_t i = 1; i <= count; ++i) {
          const std::size_t number = backwards ? count + 1 - i : i;
          EXPECT_TRUE(shards.play(number, {.refresh_after = refresh_after}).is_complete());
        }
        EXPECT_EQ(shards.merge(), alone.report);
        EXPECT_EQ(read_file(shards.log()), alone.log);
        EXPECT_GE(shards.played(), alone.played);
      }
    }
  }
}

TEST(ShardsThatStopEarly, DoNotPlayWhatEarlierSeedsMakeSuperfluous) {
  const Alone alone(with_a_limit);
  Shards shards(with_a_limit, 4);
  for (std::size_t number = 1; number <= 4; ++number) shards.play(number);
  EXPECT_EQ(shards.played(), alone.played);
}

// A ladder of the cells `calm` and two that are shaky; the last is not reached.
void with_a_ladder(StandIn& stand_in) {
  with_a_limit(stand_in);
  stand_in.experiment.cells.push_back({"never", {{"ground", "worse"}}});
  stand_in.experiment.ladders = {{"ground", "", {0, 1, 2}}};
}

TEST(ShardsOfALadder, MergeIntoWhatOneProgramWrites) {
  const Alone alone(with_a_ladder);
  EXPECT_THAT(alone.report, Not(HasSubstr("never")));
  for (const auto refresh_after : {kAlways, kNever}) {
    for (const std::size_t count : {1u, 5u}) {
      Shards shards(with_a_ladder, count);
      for (std::size_t number = 1; number <= count; ++number) {
        shards.play(number, {.refresh_after = refresh_after});
      }
      EXPECT_EQ(shards.merge(), alone.report);
      EXPECT_EQ(read_file(shards.log()), alone.log);
      EXPECT_LT(shards.played(), 75);
    }
  }
}

// The intervals are tight after some batches: before that, falls do not show that a cell fails.
void with_intervals(StandIn& stand_in) {
  stand_in.experiment.seeds = 400;
  stand_in.experiment.metrics[0].tight_at = 0.1;
  stand_in.experiment.metrics[0].max_share = 0.2;
  stand_in.experiment.metrics[1].tight_at = 0.006;
  stand_in.experiment.ladders = {{"ground", "", {1, 0}}};
}

TEST(ShardsWithIntervals, MergeIntoWhatOneProgramWrites) {
  const Alone alone(with_intervals);
  EXPECT_THAT(alone.report, HasSubstr("tight_enough"));
  for (const std::size_t count : {1u, 7u}) {
    for (const bool backwards : {false, true}) {
      Shards shards(with_intervals, count);
      for (std::size_t i = 1; i <= count; ++i) {
        const std::size_t number = backwards ? count + 1 - i : i;
        shards.play(number, {.refresh_after = kAlways});
      }
      EXPECT_EQ(shards.merge(), alone.report);
      EXPECT_EQ(read_file(shards.log()), alone.log);
      if (!backwards && count > 1) {
        EXPECT_LT(shards.played(), 600);
      }
    }
  }
}

TEST(IncompleteText, NamesTenShards) {
  std::vector<ShardProgress> shards(12, {.finished = 1, .remaining = 2});
  shards[1].remaining = 0;
  const std::string text = incomplete_text(shards);
  EXPECT_THAT(text, HasSubstr("1 (1 of 3 trials), 3 (1 of 3 trials)"));
  EXPECT_THAT(text, HasSubstr("11 (1 of 3 trials) and 1 more"));
}

}  // namespace
}  // namespace koboshi::lab
