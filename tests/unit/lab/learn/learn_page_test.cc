// docs/reference/learn.md against the reader of studies: keys, defaults, and its example.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <numbers>
#include <regex>
#include <set>
#include <string>

#include "base/text/text.h"
#include "lab/learn/learning_study.h"
#include "tests/unit/simulation/scenario/temporary_tree.h"

namespace koboshi::lab {
namespace {

class LearnPage : public testing::Test {
 protected:
  LearnPage() {
    std::ifstream file(KOBOSHI_SOURCE_DIR "/docs/reference/learn.md");
    text_.assign(std::istreambuf_iterator<char>(file), {});
  }
  // The column "default" by key; a row may name several keys.
  std::map<std::string, std::string> defaults() const {
    static const std::regex kRow(R"(\n\| (`[^|]*) \| ([^|]*) \| ([^|]*) \| [^|]* \|)");
    static const std::regex kName("`([^`]*)`");
    std::map<std::string, std::string> rows;
    for (std::sregex_iterator row(text_.begin(), text_.end(), kRow), end; row != end; ++row) {
      const std::string names = (*row)[1];
      std::string parent;
      for (std::sregex_iterator name(names.begin(), names.end(), kName); name != end; ++name) {
        std::string key = (*name)[1];
        if (key.find('.') == std::string::npos && !parent.empty()) key = parent + key;
        parent = key.substr(0, key.rfind('.') + 1);
        rows[key] = (*row)[3];
      }
    }
    return rows;
  }
  std::string example() const {
    const std::string begin = "```yaml\n";
    const std::size_t at = text_.find(begin) + begin.size();
    return text_.substr(at, text_.find("```", at) - at);
  }

  std::string text_;
  simulation::TemporaryTree tree_;
};

TEST_F(LearnPage, HasTheDefaultsOfTheCode) {
  const LearningStudy study;
  const LearningStage stage;
  const LearnedInput input;
  const RewardWeights& reward = study.reward;
  const auto range = [](const simulation::Range& ends) {
    return number_text(ends.low) + " to " + number_text(ends.high);
  };
  const auto number = [](auto value) { return fmt::format("{}", value); };
  const std::map<std::string, std::string> kExpected{
      {"version", "required"},
      {"scenario", "required"},
      {"target", "required"},
      {"stepper", "`" + study.stepper + "`"},
      {"seed", number(study.seed)},
      {"network.hidden", "required"},
      {"network.mirror", study.mirror ? "true" : "false"},
      {"network.patience_ms", number(10 * study.patience_ticks)},
      {"inputs[].signal", "required"},
      {"inputs[].typical", number(input.typical)},
      {"inputs[].range", "10 times `typical`, on both sides"},
      {"outputs[].joint", "required"},
      {"outputs[].bound_deg", "required"},
      {"outputs[].rate_deg_per_s", "required"},
      {"search.algorithm", "`es`"},
      {"search.deviation", number(study.ppo.deviation)},
      {"search.hold_ms", number(10 * study.held_cycles)},
      {"search.discount", number(study.ppo.discount)},
      {"search.trace", number(study.ppo.trace)},
      {"search.clip", number(study.ppo.clip)},
      {"search.epochs", number(study.ppo.epochs)},
      {"search.minibatch", number(study.ppo.minibatch)},
      {"search.critic", fmt::format("[{}]", fmt::join(study.ppo.critic, ", "))},
      {"search.population", number(study.population)},
      {"search.generations", number(study.generations)},
      {"search.noise", number(study.noise)},
      {"search.learning_rate",
       fmt::format("`es`: {}, `ppo`: {}", study.learning_rate, study.ppo.learning_rate)},
      {"search.weight_decay", number(study.weight_decay)},
      {"episodes.count", number(study.episodes)},
      {"episodes.walk_s", number(study.walk_s)},
      {"episodes.first_seed", number(study.first_seed)},
      {"validation.count", number(study.validation_episodes)},
      {"validation.every", number(study.validate_every)},
      {"validation.first_seed", number(study.validation_first_seed)},
      {"stages[].name", "required"},
      {"stages[].world", "`" + stage.world + "`"},
      {"stages[].forward_m_per_s", range(stage.forward_m_per_s)},
      {"stages[].left_m_per_s", range(stage.left_m_per_s)},
      {"stages[].turn_rad_per_s", range(stage.turn_rad_per_s)},
      {"stages[].impulse_N_s_per_kg", range(stage.impulse_N_s_per_kg)},
      {"stages[].interval_s", range(stage.interval_s)},
      {"stages[].advance_at", "required but in the last stage"},
      {"reward.survival", number(reward.survival)},
      {"reward.drift", number(reward.drift)},
      {"reward.turn", number(reward.turn)},
      {"reward.power", number(reward.power)},
      {"reward.lean", number(reward.lean)},
      {"reward.offset", number(reward.offset)}};
  EXPECT_EQ(defaults(), kExpected);
}

TEST_F(LearnPage, ShowsAStudyThatIsRead) {
  tree_.write("scenarios/go.yaml", "");
  const LearningStudy study = read_learning_study(tree_.write("studies/learn/page.yaml", example()));
  EXPECT_EQ(study.stages.size(), 2u);
  EXPECT_EQ(study.reward.lean, 3.0);
}

}  // namespace
}  // namespace koboshi::lab
