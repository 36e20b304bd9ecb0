#include "studio/parameters/study_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "base/file/output_folder.h"
#include "base/text/error.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::studio {
namespace {

using testing::ElementsAre;

constexpr const char* kState = R"({
  "version": 1, "study": "studies/walk.yaml", "search": "cma-es", "evaluations": 40, "population": 8,
  "spread": 0.15, "first_seed": 9000, "seeds": 2, "set": {"physics.stepper": "lumped"},
  "numbers": ["parameters.step_time_ms", "duration_s"], "trials": ["forward", "turn"],
  "state": "running", "done": 3, "best": 0.7
})";
constexpr const char* kRows =
    "evaluation,parameters.step_time_ms,duration_s,forward,turn,score,violated_limit\n"
    "1,220,12,0.5,0.7,0.6,\n"
    "2,900,12,,,,\"the range, of step_time_ms\"\n"
    "3,240,11.5,0.9,0.5,0.7,\n"
    "4,250,1";  // being written

class StudyRuns : public testing::Test {
 protected:
  void write(const char* state, const char* rows) const {
    test::write_file(folder_.path / "search.json", state);
    test::write_file(folder_.path / "evaluations.csv", rows);
  }
  const test::TemporaryFolder folder_;
};

TEST_F(StudyRuns, AreReadUpToTheLastWholeRow) {
  write(kState, kRows);
  const auto run = read_study_run(folder_.path);
  ASSERT_TRUE(run);
  EXPECT_FALSE(run->is_finished);
  EXPECT_FALSE(run->is_running);
  EXPECT_EQ(run->settings.evaluations, 40U);
  EXPECT_EQ(run->settings.stepper, "lumped");
  ASSERT_EQ(run->evaluations.size(), 3U);
  EXPECT_EQ(run->evaluations[1].violated, "the range, of step_time_ms");
  EXPECT_FALSE(run->evaluations[1].score);
  EXPECT_THAT(run->evaluations[2].values, ElementsAre(240.0, 11.5));
  EXPECT_THAT(run->evaluations[2].trial_scores, ElementsAre(0.9, 0.5));
  ASSERT_NE(run->best(), nullptr);
  EXPECT_EQ(run->best()->number, 3U);
  EXPECT_EQ(run->best(5).size(), 2U);
}

TEST_F(StudyRuns, AreRunningWhileAProgramHoldsTheFolder) {
  write(kState, kRows);
  const FolderLock lock(folder_.path);
  EXPECT_TRUE(read_study_run(folder_.path)->is_running);
}

TEST_F(StudyRuns, AreResumedWithTheSameArguments) {
  write(kState, kRows);
  const auto run = read_study_run(folder_.path);
  EXPECT_THAT(tune_arguments(run->settings),
              ElementsAre("tune", "studies/walk.yaml", "--out", folder_.path.string(), "--evaluations", "40",
                          "--population", "8", "--seeds", "2", "--first-seed", "9000", "--spread", "0.15",
                          "--search", "cma-es", "--stepper", "lumped"));
}

TEST_F(StudyRuns, ThatAreDamagedAreErrors) {
  EXPECT_FALSE(read_study_run(folder_.path));
  write("{", kRows);
  EXPECT_THROW(static_cast<void>(read_study_run(folder_.path)), InputError);
  write("{\"version\": 1}", kRows);
  EXPECT_THROW(static_cast<void>(read_study_run(folder_.path)), InputError);
  write(kState, "evaluation,score\n1,2\n");
  EXPECT_THROW(static_cast<void>(read_study_run(folder_.path)), InputError);
}

TEST_F(StudyRuns, GiveTheParametersOfTheRobotToADocument) {
  write(kState, kRows);
  const auto run = read_study_run(folder_.path);
  const Adoption adopted = adoption(*run, *run->best(), controller_table());
  ASSERT_EQ(adopted.values.size(), 1U);
  EXPECT_EQ(controller_table()[adopted.values[0].index].key, "step_time_ms");
  EXPECT_EQ(adopted.values[0].value, 240.0);
  EXPECT_THAT(adopted.left_out, ElementsAre("duration_s"));
}

TEST(Studies, AreFoundByTheirContents) {
  const auto studies = find_studies(KOBOSHI_SOURCE_DIR "/studies");
  ASSERT_EQ(studies.size(), 9U);
  EXPECT_EQ(studies.back().filename(), "walk.yaml");
  EXPECT_TRUE(find_studies(KOBOSHI_SOURCE_DIR "/scenarios").empty());
  EXPECT_TRUE(find_studies("/nonexistent").empty());
}

}  // namespace
}  // namespace koboshi::studio
