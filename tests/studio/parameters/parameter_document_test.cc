#include "studio/parameters/parameter_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "base/text/text.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/reader.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const fs::path kRobots = KOBOSHI_SOURCE_DIR "/robots/koboshi";

// Copies of the robot's files.
class Parameters : public testing::Test {
 protected:
  Parameters() {
    for (const char* name : {"parameters.yaml", "gaits/8-on.yaml", "gaits/8-off.yaml"})
      fs::copy_file(kRobots / name, folder_.path / fs::path(name).filename());
  }
  fs::path file(const std::string& name) const { return folder_.path / name; }
  std::string read(const std::string& name) const { return read_text_file(file(name), "a file"); }
  static std::size_t at(const ParameterDocument& document, const char* key) {
    return index_of(document.table(), key).value();
  }

  const test::TemporaryFolder folder_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  EXPECT_NE(begin, std::string::npos) << from;
  EXPECT_EQ(text.find(from, begin + 1), std::string::npos) << from;
  return text.replace(begin, from.size(), to);
}

TEST(ParameterTable, HasEveryParameterOfTheControllerButTheNetworks) {
  const ParameterTable table = controller_table();
  EXPECT_EQ(table.size() + 1, simulation::controller_parameters().size());
  const ParameterInfo& lead = table[index_of(table, "fall_lead_ms").value()];
  EXPECT_EQ(lead.group, "Fall detection");
  EXPECT_EQ(lead.unit, "ms");
  EXPECT_EQ(lead.low, 0.0);
  EXPECT_EQ(lead.high, 500.0);
  EXPECT_EQ(lead.fallback, 0.0);
  EXPECT_EQ(lead.effect, "at once");
  EXPECT_EQ(lead.meaning, "How far ahead the lean is predicted.");
  EXPECT_EQ(table[index_of(table, "step_time_ms").value()].effect, "within two steps");
  EXPECT_FALSE(table[index_of(table, "step_time_ms").value()].fallback);
  EXPECT_EQ(table[index_of(table, "mounting_roll_deg").value()].effect, "at once, refused unless limp");
  for (const ParameterInfo& info : table) EXPECT_LT(info.low, info.high) << info.key;
}

TEST(ParameterTable, OfAGaitKnowsWhichNumbersAreObjects) {
  const ParameterTable table = gait_table();
  const ParameterInfo& knee = table[index_of(table, "feedback.knee_s").value()];
  ASSERT_NE(knee.object, nullptr);
  EXPECT_EQ(knee.object->key, "knee_gain_s");
  EXPECT_EQ(knee.effect, "at once");
  EXPECT_EQ(table[index_of(table, "period_s").value()].object, nullptr);
  EXPECT_EQ(table[index_of(table, "period_s").value()].effect, "after Start again");
}

TEST(ParameterTable, IsSearchedByWords) {
  const ParameterTable table = controller_table();
  const ParameterInfo& height = table[index_of(table, "com_height_mm").value()];
  EXPECT_TRUE(height.matches(""));
  EXPECT_TRUE(height.matches("PENDULUM"));
  EXPECT_TRUE(height.matches("posture mm"));
  EXPECT_FALSE(height.matches("posture deg"));
}

TEST(ParameterInfo, WritesTheShortestNumberOfAStep) {
  const ParameterTable table = controller_table();
  const ParameterInfo& pitch = table[index_of(table, "trunk_pitch_deg").value()];
  EXPECT_EQ(pitch.text(3.54), "3.54");
  EXPECT_EQ(pitch.text(pitch.value(pitch.steps(3.54))), "3.54");
  EXPECT_EQ(pitch.text(0.0), "0");
  EXPECT_EQ(pitch.text(-22.5), "-22.5");
  const ParameterInfo& rate = table[index_of(table, "ramp_rate_deg_per_s").value()];
  EXPECT_GE(std::stod(rate.text(rate.low)), rate.low);
  for (const ParameterInfo& info : table)
    for (const double value : {info.low, info.high, 0.3 * info.low + 0.7 * info.high})
      EXPECT_EQ(info.steps(std::stod(info.text(value))), info.steps(value)) << info.key << ' ' << value;
}

TEST_F(Parameters, AnEditChangesItsNumberAndNothingElse) {
  ParameterDocument document(file("parameters.yaml"));
  const std::string before = document.text();
  document.set(at(document, "step_time_ms"), 240.0);
  EXPECT_EQ(document.text(), replaced(before, "step_time_ms: 170", "step_time_ms: 240"));
  EXPECT_EQ(document.value(at(document, "step_time_ms")), 240.0);
  EXPECT_EQ(document.file_value(at(document, "step_time_ms")), 170.0);
  EXPECT_THAT(document.changed(), ElementsAre(at(document, "step_time_ms")));
  document.save();
  EXPECT_EQ(read("parameters.yaml"), replaced(before, "step_time_ms: 170", "step_time_ms: 240"));
  EXPECT_FALSE(document.is_modified());
  EXPECT_TRUE(document.changed().empty());
}

TEST_F(Parameters, AValueThatTheFileLacksComesLast) {
  ParameterDocument document(file("parameters.yaml"));
  const std::string before = document.text();
  const std::size_t gain = at(document, "ankle_pitch_gain_s");
  EXPECT_FALSE(document.is_given(gain));
  EXPECT_EQ(document.value(gain), 0.0);
  document.set(gain, 0.02);
  EXPECT_EQ(document.text(), before + "  ankle_pitch_gain_s: 0.02\n");
  document.reset_to_default(gain);
  EXPECT_EQ(document.text(), before);
  document.set(gain, 0.02);
  document.reset_to_file(gain);
  EXPECT_EQ(document.text(), before);
}

TEST_F(Parameters, ADragIsOneStepOfTheHistory) {
  ParameterDocument document(file("parameters.yaml"));
  const std::string before = document.text();
  const std::size_t width = at(document, "step_width_mm");
  for (int i = 1; i <= 20; ++i) document.set(width, 84 + 0.1 * i, "slider");
  document.end_drag();
  EXPECT_EQ(document.history().undo_count(), 1U);
  EXPECT_EQ(document.history().undo_label(), "Change step_width_mm");
  EXPECT_TRUE(document.undo());
  EXPECT_EQ(document.text(), before);
  EXPECT_TRUE(document.redo());
  EXPECT_EQ(document.value(width), 86.0);
}

TEST_F(Parameters, SeveralValuesAreOneStepOfTheHistory) {
  ParameterDocument document(file("parameters.yaml"));
  const std::string before = document.text();
  const std::vector<ParameterValue> values{{at(document, "step_time_ms"), 260.0},
                                           {at(document, "ankle_pitch_gain_s"), 0.5},
                                           {at(document, "knee_gain_s"), 0.25}};
  document.set_all(values, "Adopt");
  EXPECT_EQ(document.text(), replaced(before, "step_time_ms: 170", "step_time_ms: 260") +
                                 "  ankle_pitch_gain_s: 0.5\n  knee_gain_s: 0.25\n");
  EXPECT_TRUE(document.undo());
  EXPECT_EQ(document.text(), before);
  EXPECT_FALSE(document.history().can_undo());
}

TEST_F(Parameters, RefusesAValueBeyondItsRangeAndChangesNothing) {
  ParameterDocument document(file("parameters.yaml"));
  const std::string before = document.text();
  const std::vector<ParameterValue> values{{at(document, "step_time_ms"), 260.0},
                                           {at(document, "step_width_mm"), 601.0}};
  EXPECT_THROW(document.set_all(values, "Adopt"), InputError);
  EXPECT_EQ(document.text(), before);
  EXPECT_FALSE(document.is_modified());
}

TEST_F(Parameters, RandomEditsAndUndosEndInTheFirstText) {
  const std::uint32_t seed = 20261124;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const char* name : {"parameters.yaml", "8-on.yaml"}) {
    ParameterDocument document(file(name));
    const std::string before = document.text();
    for (int edit = 0; edit < 300; ++edit) {
      const std::size_t index = random() % document.table().size();
      const ParameterInfo& info = document.table()[index];
      switch (random() % 5) {
        case 0:
          document.undo();
          break;
        case 1:
          document.redo();
          break;
        case 2:
          document.reset_to_file(index);
          break;
        default: {
          const double share = static_cast<double>(random() % 1000) / 999.0;
          document.set(index, info.low + share * (info.high - info.low), random() % 2 == 0 ? "drag" : "");
        }
      }
    }
    while (document.undo()) {
    }
    EXPECT_EQ(document.text(), before) << name;
    while (document.redo()) {
    }
    document.reset_all_to_file();
    EXPECT_EQ(document.text(), before) << name;
  }
}

TEST_F(Parameters, OfAGaitGetTheFeedbackThatTheFileLacks) {
  ParameterDocument document(file("8-off.yaml"));
  ASSERT_TRUE(document.is_gait());
  const std::size_t knee = at(document, "feedback.knee_s");
  const std::size_t roll = at(document, "feedback.hip_roll_s");
  document.set(knee, 0.02);
  document.set(roll, 0.01);
  EXPECT_EQ(document.value(knee), 0.02);
  EXPECT_EQ(document.value(roll), 0.01);
  EXPECT_THROW(document.reset_to_default(at(document, "period_s")), InputError);
}

TEST_F(Parameters, TellWhatTheCompilerRefuses) {
  const sim_board::RobotDescription robot = sim_board::load_robot(kRobots / "robot.sdf");
  const simulation::NamedModel model = simulation::load_named_model(robot);
  ParameterDocument document(file("parameters.yaml"));
  EXPECT_EQ(document.problem(robot, model), "");
  document.set(at(document, "com_height_mm"), 300.0);
  EXPECT_THAT(document.problem(robot, model), AllOf(HasSubstr("parameters.yaml:"), HasSubstr("expected")));
  document.undo();
  EXPECT_EQ(document.problem(robot, model), "");
  ParameterDocument gait(file("8-on.yaml"));
  EXPECT_EQ(gait.problem(robot, model), "");
  gait.set(at(gait, "step_length_m"), 0.4);
  EXPECT_THAT(gait.problem(robot, model), HasSubstr("8-on.yaml"));
}

TEST_F(Parameters, NoticeAnotherProgramAndReload) {
  ParameterDocument document(file("parameters.yaml"));
  const std::string other = replaced(document.text(), "step_height_mm: 27.7", "step_height_mm: 24");
  test::write_file(file("parameters.yaml"), other);
  EXPECT_EQ(document.changed_on_disk(), DiskChange::kChanged);
  document.reload();
  EXPECT_EQ(document.file_value(at(document, "step_height_mm")), 24.0);
  EXPECT_FALSE(document.is_modified());
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.is_modified());
  const std::string mine = document.text();
  test::write_file(file("parameters.yaml"), "parameters: {step_height_mm: [");
  EXPECT_THROW(document.reload(), InputError);
  EXPECT_EQ(document.text(), mine);
  EXPECT_EQ(document.file_value(at(document, "step_height_mm")), 24.0);
}

TEST_F(Parameters, TakeTheirPlaceInAScenario) {
  fs::create_directories(folder_.path / "scenarios");
  simulation::Scenario scenario = simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml");
  ParameterDocument document(kRobots / "parameters.yaml");
  document.set(at(document, "step_time_ms"), 240.0);
  document.apply_to(scenario);
  const auto step_time = std::ranges::find(scenario.robot_parameters.settings, "step_time_ms",
                                           [](const auto& setting) { return setting.name.text; });
  ASSERT_NE(step_time, scenario.robot_parameters.settings.end());
  EXPECT_EQ(step_time->value, 240.0);

  ParameterDocument gait(kRobots / "gaits/8-on.yaml");
  const std::size_t before = scenario.gait->overrides.size();
  gait.set(at(gait, "step_height_m"), 0.02);
  gait.apply_to(scenario);
  ASSERT_EQ(scenario.gait->overrides.size(), before + 1);
  EXPECT_EQ(scenario.gait->overrides.front().path, "step_height_m");
  EXPECT_EQ(scenario.gait->overrides.front().value, "0.02");
  // Another file than the scenario's changes nothing.
  ParameterDocument copy(file("8-on.yaml"));
  copy.set(at(copy, "step_height_m"), 0.03);
  copy.apply_to(scenario);
  EXPECT_EQ(scenario.gait->overrides.size(), before + 1);
}

TEST(ParameterFile, ThatIsNeitherIsRefused) {
  const test::TemporaryFolder folder;
  test::write_file(folder.path / "other.yaml", "version: 1\nsteps: []\n");
  EXPECT_THROW(ParameterDocument(folder.path / "other.yaml"), InputError);
  EXPECT_THROW(ParameterDocument(folder.path / "none.yaml"), InputError);
}

}  // namespace
}  // namespace koboshi::studio
