#include "lab/tune/study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text/error.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

namespace koboshi::lab {
namespace {

using ::testing::HasSubstr;

const char* const kStudy = R"(version: 1
scenario: ../scenarios/go.yaml
world: rough
numbers:
  parameters.step_time_ms: {range: [200, 360], grid: 10, start: 220}
  parameters.step_width_mm: {range: [58, 85], grid: 0.1, start: 77.2}
trials:
  - name: forward
    set: {commands.2.walk: "{forward_m_per_s: 0.3}", duration_s: 12}
    reward: forward
    wanted: 0.32
    weight: 3
  - name: pushed
)";

class StudyReader : public testing::Test {
 protected:
  StudyReader() { tree_.write("scenarios/go.yaml", ""); }
  Study read(const std::string& text) const { return read_study(tree_.write("studies/walk.yaml", text)); }
  std::string refusal(const std::string& text) const {
    try {
      static_cast<void>(read(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  }
  // The study with a piece of its text replaced.
  static std::string with(const std::string& piece, const std::string& by) {
    std::string text = kStudy;
    return text.replace(text.find(piece), piece.size(), by);
  }

  simulation::TemporaryTree tree_;
};

TEST_F(StudyReader, ReadsEverySetting) {
  const Study study = read(kStudy);
  EXPECT_EQ(study.scenario, tree_.root() / "scenarios/go.yaml");
  EXPECT_EQ(study.world, "rough");
  ASSERT_EQ(study.numbers.size(), 2u);
  EXPECT_EQ(study.numbers[0].path, "parameters.step_time_ms");  // in the file's order
  EXPECT_EQ(study.numbers[1].low, 58.0);
  EXPECT_EQ(study.numbers[1].high, 85.0);
  EXPECT_EQ(study.numbers[1].grid, 0.1);
  EXPECT_EQ(study.numbers[1].start, 77.2);
  ASSERT_EQ(study.trials.size(), 2u);
  const StudiedTrial& forward = study.trials[0];
  EXPECT_EQ(forward.name, "forward");
  ASSERT_EQ(forward.set.size(), 2u);
  EXPECT_EQ(forward.set[0].path, "commands.2.walk");
  EXPECT_EQ(forward.set[0].value, "{forward_m_per_s: 0.3}");
  EXPECT_EQ(forward.reward, StudiedTrial::Reward::kForward);
  EXPECT_EQ(forward.wanted, 0.32);
  EXPECT_EQ(forward.weight, 3.0);
}

TEST_F(StudyReader, FillsInDefaultsOfATrial) {
  EXPECT_EQ(read(with("world: rough\n", "")).world, "mild");
  const StudiedTrial trial = read(kStudy).trials[1];
  EXPECT_TRUE(trial.set.empty());
  EXPECT_EQ(trial.reward, StudiedTrial::Reward::kSurvival);
  EXPECT_EQ(trial.wanted, 1.0);
  EXPECT_EQ(trial.weight, 1.0);
}

TEST_F(StudyReader, ReadsTheStudiesOfTheRepository) {
  for (const char* name :
       {"walk", "stand", "steps", "rise_prone", "rise_supine", "roll", "kick", "one_leg", "push_up"}) {
    const std::string file = KOBOSHI_SOURCE_DIR "/studies/" + std::string(name) + ".yaml";
    EXPECT_FALSE(read_study(file).numbers.empty()) << name;
  }
}

TEST_F(StudyReader, ReportsLineAndValueOfAnError) {
  EXPECT_THAT(refusal(with("[58, 85]", "[85, 58]")),
              HasSubstr("walk.yaml:6: found a range that ends before it begins"));
  EXPECT_THAT(refusal(with("start: 77.2", "start: 90")), HasSubstr("walk.yaml:6: found"));
  EXPECT_THAT(refusal(with("grid: 10,", "grid: 0,")), HasSubstr("walk.yaml:5: found"));
  EXPECT_THAT(refusal(with("reward: forward", "reward: fame")), HasSubstr("walk.yaml:10: found"));
  EXPECT_THAT(refusal(with("weight: 3", "weight: 0")), HasSubstr("walk.yaml:12: found"));
  EXPECT_THAT(refusal(with("rough", "bumpy")), HasSubstr("walk.yaml:3: found world = bumpy"));
  EXPECT_THAT(refusal(with("rough", "{mass: 0.1}")), HasSubstr("walk.yaml:3: found"));
  EXPECT_THAT(refusal(with("go.yaml", "gone.yaml")), HasSubstr("walk.yaml:2: found"));
  EXPECT_THAT(refusal(with("version: 1", "version: 2")), HasSubstr("walk.yaml:1: found"));
}

TEST_F(StudyReader, RequiresAParameterAndATrial) {
  const std::string head = "version: 1\nscenario: ../scenarios/go.yaml\n";
  EXPECT_THAT(refusal(head + "numbers: {}\ntrials: [{name: a}]\n"), HasSubstr("no number"));
  EXPECT_THAT(refusal(head + "numbers: {a: {range: [0, 1], grid: 0.1, start: 0}}\ntrials: []\n"),
              HasSubstr("no trial"));
}

constexpr double kStudyDuration_s = 10.0;

// Ten seconds on its feet.
StudyTrial came(double forward_m, double left_m, double turn_rad) {
  StudyTrial trial;
  trial.duration_s = kStudyDuration_s;
  trial.walk.distance_m = forward_m;
  trial.walk.speed_m_per_s = forward_m / kStudyDuration_s;
  trial.walk.lateral_drift_m = left_m;
  trial.walk.heading_drift_rad = turn_rad;
  return trial;
}

StudiedTrial trial(StudiedTrial::Reward reward, double wanted) {
  return {.name = "trial", .reward = reward, .wanted = wanted};
}

TEST(Score, IsTheFractionOfTheGoal) {
  using enum StudiedTrial::Reward;
  EXPECT_NEAR(score(trial(kForward, 0.2), came(1.0, 0.0, 0.0), kStudyDuration_s), 0.5, 1e-12);
  EXPECT_NEAR(score(trial(kBackward, 0.2), came(-1.0, 0.0, 0.0), kStudyDuration_s), 0.5, 1e-12);
  EXPECT_NEAR(score(trial(kLeft, 0.2), came(0.0, 1.0, 0.0), kStudyDuration_s), 0.5, 1e-12);
  EXPECT_NEAR(score(trial(kTurn, 1.0), came(0.0, 0.0, 5.0), kStudyDuration_s), 0.5, 1e-12);
  EXPECT_EQ(score(trial(kSurvival, 1.0), came(0.0, 0.0, 0.0), kStudyDuration_s), 1.0);
}

TEST(Score, IsAtMostOneAndLowerInTheWrongDirection) {
  using enum StudiedTrial::Reward;
  EXPECT_EQ(score(trial(kForward, 0.2), came(9.0, 0.0, 0.0), kStudyDuration_s), 1.0);
  EXPECT_LT(score(trial(kForward, 0.2), came(-1.0, 0.0, 0.0), kStudyDuration_s), 0.0);
}

TEST(Score, SubtractsTheDeviation) {
  using enum StudiedTrial::Reward;
  const double straight = score(trial(kForward, 0.2), came(1.0, 0.0, 0.0), kStudyDuration_s);
  EXPECT_NEAR(score(trial(kForward, 0.2), came(1.0, -1.0, 0.0), kStudyDuration_s), straight - 0.125, 1e-12);
  EXPECT_LT(score(trial(kTurn, 1.0), came(1.0, 0.0, 5.0), kStudyDuration_s),
            score(trial(kTurn, 1.0), came(0.0, 0.0, 5.0), kStudyDuration_s));
}

TEST(Score, OfStandingUpDependsOnTimeOrProgress) {
  const StudiedTrial rise = trial(StudiedTrial::Reward::kStandUp, 2.0);
  const auto stood = [&](double after_s) {
    return score(rise, {{{.outcome = Outcome::kFell}, after_s, 1.0}}, kStudyDuration_s);
  };
  EXPECT_EQ(stood(1.0), 1.0);
  EXPECT_NEAR(stood(4.0), 0.5, 1e-12);
  const auto came_to = [&](double uprightness) {
    return score(rise, {{{.outcome = Outcome::kFell}, std::nullopt, uprightness}}, kStudyDuration_s);
  };
  EXPECT_EQ(came_to(0.0), -1.0);
  EXPECT_NEAR(came_to(0.7), -0.3, 1e-12);
  EXPECT_LE(came_to(1.0), 0.0);  // upright, and yet not still
}

TEST(Score, OfAMotionIsTheShareOfWhatItAchieves) {
  using enum StudiedTrial::Reward;
  const auto achieved = [](StudiedTrial::Reward reward, double wanted, double value, Outcome outcome) {
    StudyTrial played;
    played.outcome = outcome;
    played.duration_s = 4.0;
    played.achieved = value;
    return score(trial(reward, wanted), played, kStudyDuration_s);
  };
  EXPECT_NEAR(achieved(kOneLeg, 5.0, 2.0, Outcome::kSurvived), 0.4, 1e-12);
  EXPECT_EQ(achieved(kOneLeg, 5.0, 9.0, Outcome::kSurvived), 1.0);
  EXPECT_NEAR(achieved(kBallSpeed, 1.2, 0.6, Outcome::kSurvived), 0.5, 1e-12);
  EXPECT_EQ(achieved(kBallSpeed, 1.2, 0.0, Outcome::kSurvived), 0.0);
  EXPECT_NEAR(achieved(kBallSpeed, 1.2, 1.2, Outcome::kFell), -0.6, 1e-12);
  EXPECT_NEAR(achieved(kOneLeg, 5.0, 5.0, Outcome::kGaveUp), -0.6, 1e-12);
  EXPECT_NEAR(achieved(kPushUps, 3.0, 2.0, Outcome::kFell), 2.0 / 3.0, 1e-12);  // it lies
}

TEST(Score, RanksFallsBelowSurvivalAndLateFallsAboveEarlyOnes) {
  using enum StudiedTrial::Reward;
  const auto fell = [](double after_s) {
    StudyTrial fallen = came(5.0, 0.0, 0.0);
    fallen.outcome = Outcome::kFell;
    fallen.duration_s = after_s;
    return score(trial(kForward, 0.2), fallen, kStudyDuration_s);
  };
  EXPECT_NEAR(fell(9.0), -0.1, 1e-12);
  EXPECT_NEAR(fell(2.0), -0.8, 1e-12);
  EXPECT_EQ(score(trial(kForward, 0.2), {}, kStudyDuration_s), -1.0);  // it never walked
}

}  // namespace
}  // namespace koboshi::lab
