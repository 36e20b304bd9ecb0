#include "lab/learn/learning_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/load.h"
#include "sim_board/random/random_stream.h"
#include "tests/support/seed.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

namespace koboshi::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const char* const kLearningStudy = R"(version: 1
scenario: ../scenarios/go.yaml
target: residual
stepper: mujoco
seed: 9
network: {hidden: [8, 4], mirror: true, patience_ms: 120}
inputs:
  - {signal: roll, typical: 0.1, range: [-1, 1]}
  - {signal: left_load, typical: 15, range: [-50, 200]}
outputs:
  - {joint: left_hip_roll, bound_deg: 6, rate_deg_per_s: 200}
  - {joint: left_ankle_pitch, bound_deg: 8, rate_deg_per_s: 100}
search: {algorithm: es, population: 12, generations: 30, noise: 0.1, learning_rate: 0.03, weight_decay: 0.001}
episodes: {count: 3, walk_s: 7, first_seed: 1000}
validation: {count: 20, every: 4, first_seed: 2000}
stages:
  - name: weak
    world: rough
    forward_m_per_s: [0, 0.1]
    left_m_per_s: [-0.05, 0.05]
    turn_rad_per_s: [-0.2, 0.2]
    impulse_N_s_per_kg: [0.1, 0.2]
    interval_s: [1, 2]
    advance_at: 0.9
  - {name: strong, world: harsh}
reward: {survival: 2, drift: 0.5, turn: 0.25, power: 0.01, lean: 3, offset: 0.125}
)";

class LearningStudyReader : public testing::Test {
 protected:
  LearningStudyReader() { tree_.write("scenarios/go.yaml", ""); }
  LearningStudy read(const std::string& text) const {
    return read_learning_study(tree_.write("learn/study.yaml", text));
  }
  template <typename Action>
  static std::string refusal_of(const Action& action) {
    try {
      static_cast<void>(action());
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  }
  std::string refusal(const std::string& text) const {
    return refusal_of([&] { return read(text); });
  }
  // The study with a piece of its text replaced.
  static std::string with(const std::string& piece, const std::string& by) {
    std::string text = kLearningStudy;
    return text.replace(text.find(piece), piece.size(), by);
  }

  simulation::TemporaryTree tree_;
};

TEST_F(LearningStudyReader, ReadsEverySetting) {
  const LearningStudy study = read(kLearningStudy);
  EXPECT_EQ(study.scenario, tree_.root() / "scenarios/go.yaml");
  EXPECT_EQ(study.stepper, "mujoco");
  EXPECT_EQ(study.seed, 9u);
  EXPECT_THAT(study.hidden, ElementsAre(8, 4));
  EXPECT_TRUE(study.mirror);
  EXPECT_EQ(study.patience_ticks, 12);
  ASSERT_EQ(study.inputs.size(), 2u);
  EXPECT_EQ(study.inputs[1].signal, "left_load");
  EXPECT_EQ(study.inputs[1].typical, 15.0);
  EXPECT_EQ(study.inputs[1].range, (simulation::Range{-50.0, 200.0}));
  ASSERT_EQ(study.outputs.size(), 2u);
  EXPECT_NEAR(study.outputs[0].bound_rad, 0.10472, 1e-5);
  EXPECT_EQ(study.population, 12u);
  EXPECT_EQ(study.generations, 30u);
  EXPECT_EQ(study.noise, 0.1);
  EXPECT_EQ(study.learning_rate, 0.03);
  EXPECT_EQ(study.weight_decay, 0.001);
  EXPECT_EQ(study.episodes, 3u);
  EXPECT_EQ(study.walk_s, 7.0);
  EXPECT_EQ(study.first_seed, 1000u);
  EXPECT_EQ(study.validation_episodes, 20u);
  EXPECT_EQ(study.validate_every, 4u);
  EXPECT_EQ(study.validation_first_seed, 2000u);
  ASSERT_EQ(study.stages.size(), 2u);
  EXPECT_EQ(study.stages[0].left_m_per_s, (simulation::Range{-0.05, 0.05}));
  EXPECT_EQ(study.stages[0].interval_s, (simulation::Range{1.0, 2.0}));
  EXPECT_EQ(study.stages[0].advance_at, 0.9);
  EXPECT_EQ(study.stages[1].world, "harsh");
  EXPECT_FALSE(study.stages[1].advance_at);
  EXPECT_EQ(study.reward.turn, 0.25);
  EXPECT_EQ(study.reward.offset, 0.125);
}

TEST_F(LearningStudyReader, ReadsEverySettingOfPpo) {
  const std::string es =
      "{algorithm: es, population: 12, generations: 30, noise: 0.1, learning_rate: 0.03, weight_decay: "
      "0.001}";
  EXPECT_EQ(read(with(es, "{algorithm: ppo}")).learning_rate, PpoOptions().learning_rate);
  const LearningStudy study = read(with(
      es,
      "{algorithm: ppo, generations: 7, learning_rate: 0.001, deviation: 0.3, hold_ms: 30, discount: 0.98, "
      "trace: 0.9, clip: 0.1, epochs: 3, minibatch: 512, critic: [16]}"));
  EXPECT_EQ(study.algorithm, LearningAlgorithm::kPpo);
  EXPECT_EQ(study.generations, 7u);
  EXPECT_EQ(study.learning_rate, 0.001);
  EXPECT_EQ(study.ppo.deviation, 0.3);
  EXPECT_EQ(study.held_cycles, 3u);
  EXPECT_EQ(study.ppo.discount, 0.98);
  EXPECT_EQ(study.ppo.trace, 0.9);
  EXPECT_EQ(study.ppo.clip, 0.1);
  EXPECT_EQ(study.ppo.epochs, 3u);
  EXPECT_EQ(study.ppo.minibatch, 512u);
  EXPECT_THAT(study.ppo.critic, ElementsAre(16));
}

TEST_F(LearningStudyReader, ReadsTheStudiesOfTheRepository) {
  std::size_t read = 0;
  for (const auto& each : std::filesystem::directory_iterator(KOBOSHI_SOURCE_DIR "/studies/learn")) {
    EXPECT_FALSE(read_learning_study(each.path()).stages.empty());
    ++read;
  }
  EXPECT_GT(read, 0u);
}

TEST_F(LearningStudyReader, ReportsLineAndValueOfAnError) {
  EXPECT_THAT(refusal(with("hidden: [8, 4]", "hidden: [8, 3]")),
              HasSubstr("study.yaml:6: found an odd number of neurons"));
  EXPECT_THAT(refusal(with("hidden: [8, 4]", "hidden: [8, 4, 4, 4]")),
              HasSubstr("study.yaml:6: found 4 hidden layers, expected at most 3"));
  EXPECT_THAT(refusal(with("[-1, 1]", "[1, -1]")), HasSubstr("study.yaml:8: found a range that ends"));
  EXPECT_THAT(refusal(with("population: 12", "population: 13")),
              HasSubstr("study.yaml:13: found 13 candidates"));
  EXPECT_THAT(refusal(with("algorithm: es", "algorithm: sac")),
              HasSubstr("study.yaml:13: found search.algorithm = sac, expected es or ppo"));
  EXPECT_THAT(refusal(with("algorithm: es", "algorithm: ppo")), HasSubstr("study.yaml:13: found"))
      << "with the settings of an evolution";
  EXPECT_THAT(
      refusal(with("first_seed: 2000", "first_seed: 1089")),
      HasSubstr("study.yaml:15: found seeds 1089 to 1108, expected other seeds than those of training"));
  EXPECT_THAT(refusal(with("world: rough", "world: bumpy")), HasSubstr("study.yaml:18: found"));
  EXPECT_THAT(refusal(with("    advance_at: 0.9\n", "")), HasSubstr("advance_at"));
  EXPECT_THAT(refusal(with("world: harsh}", "world: harsh, advance_at: 1}")),
              HasSubstr("found advance_at in the last stage"));
  EXPECT_THAT(refusal(with("lean: 3", "leen: 3")), HasSubstr("study.yaml:26: found"));
  EXPECT_THAT(refusal(with("target: residual", "target: rise")), HasSubstr("study.yaml:3: found"));
}

class LearnedMap : public LearningStudyReader {
 protected:
  tools::PolicyMap map(const std::string& text) const { return learned_map(read(text), robot_); }
  std::string map_refusal(const std::string& text) const {
    return refusal_of([&] { return map(text); });
  }

  simulation::NamedModel robot_ =
      simulation::load_named_model(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf"));
};

TEST_F(LearnedMap, AddsTheRightSide) {
  const tools::PolicyMap map = this->map(kLearningStudy);
  std::vector<std::string> inputs;
  for (const tools::MappedInput& input : map.inputs) inputs.push_back(input.name);
  EXPECT_THAT(inputs, ElementsAre("roll", "left_load", "right_load"));
  std::vector<std::string> outputs;
  for (const tools::MappedOutput& output : map.outputs) outputs.push_back(output.joint);
  EXPECT_THAT(outputs,
              ElementsAre("left_hip_roll", "right_hip_roll", "left_ankle_pitch", "right_ankle_pitch"));
  EXPECT_EQ(map.inputs[0].scale, 10.0);
  EXPECT_EQ(map.patience_ticks, 12);
  EXPECT_LT(map.outputs[0].scale_rad, map.outputs[0].bound_rad) << "no output may leave its bound";
}

TEST_F(LearnedMap, HasTheNamedSideOnlyWithoutMirror) {
  const tools::PolicyMap map = this->map(with("mirror: true", "mirror: false"));
  EXPECT_EQ(map.inputs.size(), 2u);
  EXPECT_EQ(map.outputs.size(), 2u);
}

TEST_F(LearnedMap, IsWrittenAsTheImportReadsIt) {
  const tools::PolicyMap map = this->map(kLearningStudy);
  const tools::PolicyMap read = tools::read_policy_map(tree_.write("map.yaml", map_text(map)), robot_);
  ASSERT_EQ(read.inputs.size(), map.inputs.size());
  ASSERT_EQ(read.outputs.size(), map.outputs.size());
  EXPECT_EQ(read.patience_ticks, map.patience_ticks);
  for (std::size_t i = 0; i < map.inputs.size(); ++i) {
    EXPECT_EQ(read.inputs[i].signal, map.inputs[i].signal);
    EXPECT_EQ(read.inputs[i].scale, map.inputs[i].scale);
    EXPECT_EQ(read.inputs[i].range, map.inputs[i].range);
  }
  for (std::size_t i = 0; i < map.outputs.size(); ++i) {
    EXPECT_EQ(read.outputs[i].scale_rad, map.outputs[i].scale_rad);
    EXPECT_NEAR(read.outputs[i].bound_rad, map.outputs[i].bound_rad, 1e-8);
    EXPECT_NEAR(read.outputs[i].rate_rad_per_s, map.outputs[i].rate_rad_per_s, 1e-7);
  }
}

TEST_F(LearnedMap, RefusesNamesThatTheRobotDoesNotHave) {
  EXPECT_THAT(map_refusal(with("signal: roll", "signal: rool")),
              HasSubstr("study.yaml:8: found rool, expected"));
  EXPECT_THAT(map_refusal(with("signal: left_load", "signal: right_load")),
              HasSubstr("study.yaml:9: found right_load, expected names of the left side"));
  EXPECT_THAT(map_refusal(with("joint: left_hip_roll", "joint: left_knee")),
              HasSubstr("study.yaml:11: found left_knee, expected a hip or ankle"));
  EXPECT_THAT(map_refusal(with("joint: left_ankle_pitch", "joint: left_hip_roll")),
              HasSubstr("study.yaml:12: found a second output for left_hip_roll"));
  EXPECT_THAT(map_refusal(with("signal: left_load", "signal: roll")), HasSubstr("found a second input roll"));
}

// Each byte of the study changed at random: the reader takes it or refuses it with one line of this file.
TEST_F(LearningStudyReader, RefusesDamagedFilesWithOneLine) {
  sim_board::RandomStream random(test::kSeed, "damaged studies");
  for (int i = 0; i < 300; ++i) {
    std::string text = kLearningStudy;
    for (int changes = 0; changes < 3; ++changes) {
      const auto at = static_cast<std::size_t>(random.uniform() * static_cast<double>(text.size()));
      const auto what = static_cast<char>(random.bits() % 128);
      if (random.uniform() < 0.5) {
        text[at] = what;
      } else {
        text.erase(at, static_cast<std::size_t>(random.uniform() * 8.0));
      }
    }
    const std::string said = refusal(text);
    EXPECT_EQ(std::ranges::count(said, '\n'), 0) << said;
  }
}

}  // namespace
}  // namespace koboshi::lab
