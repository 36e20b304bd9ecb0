// A search over runs of the real robot, each so short that it only boots.

#include "lab/tune/study_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>

#include "base/text/error.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::ptrdiff_t lines(const std::filesystem::path& file) { return std::ranges::count(contents(file), '\n'); }

class StudySearch : public testing::Test {
 protected:
  StudySearch() {
    study_.file = tree_.write("boot.yaml", "");  // what a search goes on from depends on it
    study_.scenario = KOBOSHI_SOURCE_DIR "/scenarios/go.yaml";
    study_.numbers = {
        {.path = "parameters.step_height_mm", .low = 14, .high = 35, .grid = 0.1, .start = 20},
        {.path = "parameters.step_width_mm", .low = 58, .high = 85, .grid = 0.1, .start = 77.2}};
    study_.trials = {{.name = "boots", .set = {{"duration_s", "0.2"}}},
                     {.name = "boots_on", .set = {{"duration_s", "0.3"}}, .weight = 2.0}};
    options_ = {{.overrides = {{"physics.stepper", "lumped"}},
                 .out = tree_.root() / "out",
                 .seeds = 1,
                 .evaluations = 16}};
  }
  lab::SearchResult search(lab::Method with) {
    options_.method = with;
    return lab::search_study(study_, options_,
                             [this](const lab::SearchProgress& progress) { progress_ = progress; });
  }

  simulation::TemporaryTree tree_;
  lab::Study study_;
  lab::StudyOptions options_;
  lab::SearchProgress progress_;
};

TEST_F(StudySearch, WritesItsLogAndItsResult) {
  const lab::SearchResult result = search(lab::Method::kCmaEs);
  EXPECT_EQ(result.score, 1.0);
  EXPECT_EQ(progress_.done.candidates, 16u);
  EXPECT_EQ(lines(options_.out / "evaluations.csv"), 17);
  const std::string evaluations = contents(options_.out / "evaluations.csv");
  EXPECT_THAT(evaluations, HasSubstr("\n1,20,77.2,1,1,1,\n"));
  EXPECT_EQ(contents(options_.out / "best.yaml"),
            "parameters.step_height_mm: 20\nparameters.step_width_mm: 77.2\n");
  const std::string report = contents(options_.out / "report.md");
  EXPECT_THAT(report, HasSubstr("parameters.step_width_mm"));
  EXPECT_THAT(report, HasSubstr("boots_on"));
  EXPECT_FALSE(std::filesystem::exists(options_.out / "front.csv"));
}

TEST_F(StudySearch, ResumesFromItsLogWithTheSameResult) {
  static_cast<void>(search(lab::Method::kCmaEs));
  const std::string first = contents(options_.out / "evaluations.csv");
  const auto played = lines(options_.out / "trials.jsonl");
  static_cast<void>(search(lab::Method::kCmaEs));
  EXPECT_EQ(contents(options_.out / "evaluations.csv"), first);
  EXPECT_EQ(lines(options_.out / "trials.jsonl"), played) << "nothing is played twice";
}

// Two sets of parameters are all that there are: every candidate rounds to one of them.
TEST_F(StudySearch, CountsCandidatesThatRepeatAnEarlierOne) {
  study_.numbers = {{.path = "parameters.step_height_mm", .low = 20, .high = 30, .grid = 10, .start = 20}};
  options_.spread = 0.5;
  const lab::SearchResult result = search(lab::Method::kCmaEs);
  EXPECT_EQ(result.counts.candidates, 16u);
  EXPECT_EQ(result.counts.evaluated, 2u);
  EXPECT_EQ(progress_.done.candidates, 16u);
  EXPECT_EQ(progress_.done.evaluated, 2u);
  EXPECT_EQ(lines(options_.out / "evaluations.csv"), 17);
  EXPECT_EQ(lines(options_.out / "trials.jsonl"), 4) << "two sets in two trials";
  EXPECT_THAT(contents(options_.out / "report.md"),
              HasSubstr("16 candidates, 2 evaluated and 14 repeated, in 1 world each, seeds"));
  EXPECT_THAT(contents(options_.out / "search.json"), HasSubstr("\"done\": 16,\n  \"evaluated\": 2,"));
  EXPECT_EQ(lab::counts_text({16, 16}), "16 candidates");
}

class InfeasibleStudySearch : public StudySearch {
 protected:
  InfeasibleStudySearch() {
    study_.scenario = KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml";
    // From 170 mm on the legs cannot make the step.
    study_.numbers = {
        {.path = "gait.set.com_height_m", .low = 0.15, .high = 0.25, .grid = 0.001, .start = 0.16}};
    // Wide enough for candidates beyond 180 mm, which no leg reaches; below, joints are too fast.
    options_.spread = 0.3;
  }
};

TEST_F(InfeasibleStudySearch, CountsInfeasibleCandidatesByTheirLimitAndContinues) {
  const lab::SearchResult result = search(lab::Method::kCmaEs);
  EXPECT_EQ(progress_.done.candidates, 16u);
  EXPECT_EQ(result.counts.candidates, 16u);
  EXPECT_EQ(result.score, 1.0);
  std::size_t infeasible = 0;
  for (const auto& [limit, count] : result.infeasible) infeasible += count;
  EXPECT_GT(result.infeasible.at("the reach of the legs"), 0u);
  EXPECT_LT(infeasible, 16u);
  const std::string evaluations = contents(options_.out / "evaluations.csv");
  EXPECT_THAT(evaluations, HasSubstr(",,,,the reach of the legs\n"));
  EXPECT_THAT(contents(options_.out / "report.md"),
              HasSubstr(std::to_string(infeasible) + " of 16 candidates infeasible: "));
  // Resumed, it comes to the same end.
  EXPECT_EQ(search(lab::Method::kCmaEs).infeasible, result.infeasible);
  EXPECT_EQ(contents(options_.out / "evaluations.csv"), evaluations);
}

class ShardedStudySearch : public InfeasibleStudySearch {
 protected:
  ShardedStudySearch() {
    options_.evaluations = 24;
    options_.seeds = 2;
    shards_ = options_;
    shards_.out = tree_.root() / "shards";
    std::filesystem::create_directory(shards_.out);
  }
  void play(std::size_t number) {
    static_cast<void>(lab::play_study_shard(study_, shards_, {number, kShards}, {}));
  }
  lab::SearchResult merge() { return lab::merge_study(study_, shards_, kShards, {}); }
  std::string shard(std::size_t number) { return contents(lab::shard_file(shards_.out, {number, kShards})); }
  void cut(std::size_t number, std::size_t bytes) {
    std::ofstream(lab::shard_file(shards_.out, {number, kShards}), std::ios::binary)
        << shard(number).substr(0, bytes);
  }
  void expect_the_files_of_one_program() {
    for (const char* name : {"trials.jsonl", "evaluations.csv", "best.yaml", "report.md", "search.json"})
      EXPECT_EQ(contents(shards_.out / name), contents(options_.out / name)) << name;
    EXPECT_FALSE(std::filesystem::exists(shards_.out / "merging"));
  }

  static constexpr std::size_t kShards = 3;
  lab::StudyOptions shards_;
};

TEST_F(ShardedStudySearch, MergesIntoTheFilesOfOneProgram) {
  const lab::SearchResult alone = search(lab::Method::kCmaEs);
  {
    std::vector<std::jthread> threads;
    for (std::size_t number = 1; number <= kShards; ++number)
      threads.emplace_back([this, number] { play(number); });
  }
  for (std::size_t number = 1; number <= kShards; ++number) EXPECT_NE(shard(number), "") << number;
  for (int repeated = 0; repeated < 2; ++repeated) {
    EXPECT_EQ(merge().numbers, alone.numbers);
    expect_the_files_of_one_program();
  }
}

TEST_F(ShardedStudySearch, GoesOnWithoutShardsThatDiedAndAfterAKill) {
  static_cast<void>(search(lab::Method::kCmaEs));
  play(2);  // alone: it plays the parts of the others
  cut(2, shard(2).size() / 2);
  EXPECT_THROW(static_cast<void>(merge()), InputError);
  EXPECT_FALSE(std::filesystem::exists(shards_.out / "evaluations.csv"));
  for (const lab::ShardProgress& progress : lab::study_progress(study_, shards_, kShards))
    EXPECT_FALSE(progress.is_complete());
  play(3);
  for (const lab::ShardProgress& progress : lab::study_progress(study_, shards_, kShards))
    EXPECT_TRUE(progress.is_complete());
  static_cast<void>(merge());
  expect_the_files_of_one_program();
}

TEST_F(ShardedStudySearch, HasIslands) {
  options_.evaluations = shards_.evaluations = 48;
  options_.islands = shards_.islands = 2;
  options_.migrate = shards_.migrate = 1;
  static_cast<void>(search(lab::Method::kCmaEs));
  EXPECT_EQ(lines(options_.out / "evaluations.csv"), 49);
  play(1);
  static_cast<void>(merge());
  expect_the_files_of_one_program();
}

TEST_F(ShardedStudySearch, RefusesWhatHasNoShards) {
  shards_.method = lab::Method::kNsga2;
  EXPECT_THROW(play(1), InputError);
}

TEST_F(ShardedStudySearch, HasInputsThatNameTheStart) {
  const std::string inputs = lab::study_inputs(study_, options_);
  EXPECT_EQ(lab::study_inputs(study_, shards_), inputs);
  study_.numbers[0].start = 0.165;
  EXPECT_NE(lab::study_inputs(study_, options_), inputs);
}

TEST_F(InfeasibleStudySearch, RefusesAnInfeasibleStart) {
  study_.numbers[0].start = 0.25;
  EXPECT_THROW(static_cast<void>(search(lab::Method::kCmaEs)), InputError);
}

TEST_F(StudySearch, ReportsNonDominatedCandidates) {
  static_cast<void>(search(lab::Method::kNsga2));
  EXPECT_EQ(lines(options_.out / "evaluations.csv"), 17);
  EXPECT_EQ(lines(options_.out / "front.csv"), 17) << "all that stand are worth the same";
}

}  // namespace
}  // namespace koboshi::tools
