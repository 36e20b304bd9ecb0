// A training of a tiny network on the real robot, in walks of a second.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "base/text/error.h"
#include "lab/learn/training.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/policy/policy_file.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

namespace koboshi::tools {
namespace {

using ::testing::HasSubstr;

class Learn : public testing::Test {
 protected:
  Learn() {
    study_.file = tree_.write("tiny.yaml", "");  // the inputs of a training depend on it
    study_.scenario = KOBOSHI_SOURCE_DIR "/scenarios/go.yaml";
    study_.hidden = {2};
    study_.inputs = {{.signal = "roll", .typical = 0.1, .range = {-1.0, 1.0}},
                     {.signal = "pitch_rate", .typical = 1.0, .range = {-20.0, 20.0}}};
    study_.outputs = {{.joint = "left_ankle_roll", .bound_rad = 0.1, .rate_rad_per_s = 3.0}};
    study_.population = 2;
    study_.generations = 2;
    study_.noise = 0.3;
    study_.episodes = 1;
    study_.walk_s = 1.0;
    study_.validation_episodes = 1;
    study_.validate_every = 1;
    study_.stages = {{.name = "first", .world = "mild", .advance_at = 0.0},
                     {.name = "last", .world = "rough", .forward_m_per_s = {0.05, 0.1}}};
    study_.reward.lean = 1.0;
  }
  lab::TrainingOptions options(const char* folder, std::size_t jobs = 1) const {
    return {.out = tree_.root() / folder, .jobs = jobs};
  }
  std::string contents(const char* folder, const char* file) const {
    std::ifstream stream(tree_.root() / folder / file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void expect_same_results(const char* one, const char* other) const {
    for (const char* file : {"log.jsonl", "state.json", "policy.kpol", "policy.yaml", "report.md"}) {
      EXPECT_FALSE(contents(one, file).empty()) << file;
      EXPECT_EQ(contents(one, file), contents(other, file)) << file;
    }
  }

  simulation::TemporaryTree tree_;
  lab::LearningStudy study_;
};

struct Killed {};

TEST_F(Learn, GivesTheSameBytesWithTwoThreadsAndAfterAnInterruption) {
  const lab::TrainingOptions undisturbed = options("one");
  const lab::TrainingResult result = lab::train(study_, undisturbed);
  EXPECT_EQ(result.generations, 2u);
  EXPECT_EQ(result.engine.generation, 0u);
  EXPECT_EQ(result.engine.offset, 0.0) << "the first network adds nothing";
  EXPECT_GE(result.best.reward, result.engine.reward);
  const std::string log = contents("one", "log.jsonl");
  EXPECT_EQ(std::ranges::count(log, '\n'), 2);
  EXPECT_THAT(log, HasSubstr("{\"generation\":1,\"stage\":\"first\""));
  EXPECT_TRUE(std::filesystem::exists(undisturbed.out / "best.mcap"));
  const auto model =
      simulation::load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"))
          .model;
  EXPECT_FALSE(simulation::read_policy_image(undisturbed.out / "policy.kpol", model).empty());

  static_cast<void>(lab::train(study_, options("two", 2)));
  expect_same_results("one", "two");

  // Interrupted after the first generation, while the second one has written half a line.
  const lab::TrainingOptions resumed = options("three");
  EXPECT_THROW(
      static_cast<void>(lab::train(study_, resumed, [](const lab::TrainingProgress&) { throw Killed(); })),
      Killed);
  std::ofstream(resumed.out / "log.jsonl", std::ios::app) << "{\"generation\":2,\"sta";
  static_cast<void>(lab::train(study_, resumed));
  expect_same_results("one", "three");

  // A finished training has nothing left to do.
  static_cast<void>(lab::train(study_, resumed));
  expect_same_results("one", "three");
}

TEST_F(Learn, ByGradientsGivesTheSameBytesWithTwoThreadsAndAfterAnInterruption) {
  study_.algorithm = lab::LearningAlgorithm::kPpo;
  study_.learning_rate = 0.01;
  study_.episodes = 2;
  study_.stages.front().forward_m_per_s = {0.05, 0.1};
  const lab::TrainingResult result = lab::train(study_, options("one"));
  EXPECT_EQ(result.generations, 2u);
  EXPECT_EQ(result.engine.offset, 0.0) << "the first network adds nothing, and a validation does not explore";
  const std::string log = contents("one", "log.jsonl");
  EXPECT_THAT(log, HasSubstr("\"survived\":1.0,\"steps\":"));
  EXPECT_THAT(log, HasSubstr("\"divergence\":0."));
  EXPECT_THAT(contents("one", "report.md"), HasSubstr("2 generations of 2 episodes each"));

  lab::TrainingOptions resumed = options("two", 2);
  resumed.until = 1;
  static_cast<void>(lab::train(study_, resumed));
  resumed.until = 0;
  static_cast<void>(lab::train(study_, resumed));
  expect_same_results("one", "two");
}

// So short an episode ends before the robot has taken a step of the search.
TEST_F(Learn, ByGradientsPassesOverAGenerationWithoutAStep) {
  study_.algorithm = lab::LearningAlgorithm::kPpo;
  study_.generations = 1;
  study_.walk_s = 0.02;
  EXPECT_EQ(lab::train(study_, options("out")).generations, 1u);
  EXPECT_THAT(contents("out", "log.jsonl"), HasSubstr("\"steps\":0"));
}

TEST_F(Learn, ByGradientsIsRefusedInShards) {
  study_.algorithm = lab::LearningAlgorithm::kPpo;
  study_.algorithm_line = 7;
  const auto refusal = [](const auto& action) -> std::string {
    try {
      static_cast<void>(action());
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  const lab::TrainingOptions shards = options("shards");
  const auto expected = HasSubstr("tiny.yaml:7: found algorithm ppo in shards, expected es, or one program");
  EXPECT_THAT(refusal([&] { return lab::play_training_shard(study_, shards, {1, 2}); }), expected);
  EXPECT_THAT(refusal([&] { return lab::merge_training(study_, shards, 2); }), expected);
  EXPECT_THAT(refusal([&] { return lab::training_progress(study_, shards, 2); }), expected);
  EXPECT_FALSE(std::filesystem::exists(shards.out));
}

TEST_F(Learn, InShardsGivesTheBytesOfOneProgram) {
  study_.generations = 1;
  static_cast<void>(lab::train(study_, options("alone")));
  const lab::TrainingOptions shards = options("shards");
  std::filesystem::create_directories(shards.out);
  // Shard 2 dies in the first validation, with half a line in its file; shard 1 plays the whole training
  // alone.
  std::ofstream(shards.out / "shard-2-of-2.jsonl") << "{\"experiment\":\"learn\",\"cell\":\"validation aft";
  try {
    static_cast<void>(lab::merge_training(study_, shards, 2));
    FAIL() << "nothing has been played";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("1 of 1 trials are missing after 0 of 1 generations"));
  }
  EXPECT_EQ(contents("shards", "state.json"), "");
  EXPECT_FALSE(lab::training_progress(study_, shards, 2).front().is_complete());
  EXPECT_EQ(lab::play_training_shard(study_, shards, {1, 2}).generations, 1u);
  EXPECT_TRUE(lab::training_progress(study_, shards, 2).back().is_complete());
  EXPECT_EQ(contents("shards", "state.json"), "") << "only the merge leaves results";
  static_cast<void>(lab::merge_training(study_, shards, 2));
  expect_same_results("alone", "shards");
  const std::string trials = contents("shards", "shard-1-of-2.jsonl");
  EXPECT_EQ(std::ranges::count(trials, '\n'), 4) << "two validations and two candidates";
  // The other shard has nothing left to play, but for the line that it had begun.
  EXPECT_EQ(lab::play_training_shard(study_, shards, {2, 2}).generations, 1u);
  EXPECT_EQ(contents("shards", "shard-2-of-2.jsonl"), "");
}

TEST_F(Learn, ResumesAfterItsLastGeneration) {
  lab::TrainingOptions first = options("out");
  first.until = 1;
  EXPECT_EQ(lab::train(study_, first).generations, 1u);
  EXPECT_FALSE(std::filesystem::exists(first.out / "report.md"));
  // Another study may not go on in this folder.
  tree_.write("tiny.yaml", "# changed\n");
  try {
    static_cast<void>(lab::train(study_, first));
    FAIL() << "it is not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("state.json: found a training with another study"));
  }
}

}  // namespace
}  // namespace koboshi::tools
