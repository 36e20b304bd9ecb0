// Every key and value of a scenario, a motion and a gait, each changed in many ways: the file is accepted, or
// an InputError with a text of UTF-8 says why not. Nothing else may happen.

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "base/yaml/yaml_reader.h"
#include "sim_board/description/load.h"
#include "simulation/assembly/parameters.h"
#include "simulation/gait/gait.h"
#include "simulation/model/robot_model.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/scenario/reader.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

namespace fs = std::filesystem;

const fs::path kRobotFolder = fs::path(KOBOSHI_SOURCE_DIR) / "robots/koboshi";

const std::string kScenario = R"(version: 1
robot: robots/koboshi/robot.sdf
motions: [robots/koboshi/motions/squat.yaml, robots/koboshi/motions/bow.yaml]
motion_set: {squat: {steps.0.time_s: 2}}
gait: {file: robots/koboshi/gait.yaml, set: {period_s: 0.6}}
duration_s: 1
physics: {stepper: lumped, friction: rows}
ground:
  material: ice
  shapes:
    - box: {position_m: [1, 0], size_m: [0.4, 1, 0.01], material: steel}
materials:
  - {between: [rubber, ice], friction: [0.1, 0.05]}
initial: {joints_deg: {knee: 20, left_elbow: -10}}
parameter_file: robots/koboshi/standing.yaml
parameters: {step_time_ms: 240}
commands:
  - {at_s: 0.1, enable: true}
  - {at_s: 0.2, play: squat}
  - {at_s: 0.3, walk: {forward_m_per_s: 0.1}}
pushes:
  - {at_s: 0.1, duration_s: 0.1, link: trunk, force_N: [1, 0, 0], shape: half-sine}
faults:
  - {at_s: 0.1, kind: drive_silent, target: left_knee}
  - {at_s: 0.1, kind: ankle_stop, target: left}
  - {at_s: 0.1, kind: frames_lost, target: controller, identifier: [0x190, 0x1A3]}
)";

std::vector<std::string> changes_of(const std::string& text) {
  return {text + " ",
          " " + text,
          text + "x",
          text + "\n",
          text + "\t",
          text + "\u00A0",
          text + "\x01",
          text + "\xFF",
          "",
          "-" + text,
          "%s%n",
          "../" + text,
          "1e400",
          "\U0001F916",
          std::string(3000, 'n'),
          "~",
          "[" + text + "]",
          "{a: " + text + "}",
          "\xF0\x9F\xA4",
          text + ": " + text};
}

void visit(YamlNode& node, const std::function<void(YamlNode&)>& act) {
  act(node);
  for (YamlNode& item : node.items) visit(item, act);
}

// Calls `read` with each changed text; it may throw nothing but InputError.
void change_all(const std::string& text, const std::function<void(const std::string&)>& read) {
  YamlNode root = parse_yaml(text, "original");
  std::size_t texts = 0;
  const auto try_once = [&](const std::string& what) {
    const std::string changed = yaml_text(root);
    ++texts;
    try {
      read(changed);
    } catch (const InputError& error) {
      EXPECT_STRNE(error.what(), "") << what;
      EXPECT_EQ(find_invalid_utf8(error.what()), std::string::npos) << what;
      EXPECT_NE(std::string(error.what()).find(": found "), std::string::npos) << what;
    } catch (const std::exception& error) {
      ADD_FAILURE() << what << ": " << error.what() << "\n" << changed;
    }
  };
  visit(root, [&](YamlNode& node) {
    const YamlNode before = node;
    for (const std::string& change : changes_of(before.scalar)) {
      if (before.kind != YamlNode::Kind::kScalar) break;
      for (const bool quoted : {false, true}) {
        node.scalar = change;
        node.quoted = quoted;
        try_once(before.path + " changed to " + change);
      }
    }
    node = before;
    for (const std::string& change : changes_of(before.key)) {
      if (before.key.empty()) break;
      node.key = change;
      try_once("key " + before.path + " changed to " + change);
    }
    node = before;
  });
  EXPECT_GT(texts, 100u);
}

TEST(ChangedTexts, OfAScenarioAreAcceptedOrRefused) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path / "scenario.yaml";
  fs::create_directory_symlink(fs::path(KOBOSHI_SOURCE_DIR) / "robots", folder.path / "robots");
  const sim_board::RobotDescription robot = sim_board::load_robot(kRobotFolder / "robot.sdf");
  change_all(kScenario, [&](const std::string& text) {
    test::write_file(file, text);
    const Scenario scenario = read_scenario(file);
    simulation::check(scenario, robot);
    static_cast<void>(resolve_parameters(scenario.parameters));
  });
}

TEST(ChangedTexts, OfAMotionAreAcceptedOrRefused) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path / "motion.yaml";
  const NamedModel model = load_named_model(sim_board::load_robot(kRobotFolder / "robot.sdf"));
  for (const char* motion : {"motions/bow.yaml", "motions/roll_left.yaml"})
    change_all(test::read_file(kRobotFolder / motion), [&](const std::string& text) {
      test::write_file(file, text);
      static_cast<void>(compile_motion(file, model, {}));
    });
}

TEST(ChangedTexts, OfAGaitAreAcceptedOrRefused) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path / "gait.yaml";
  change_all(test::read_file(kRobotFolder / "gait.yaml"), [&](const std::string& text) {
    test::write_file(file, text);
    static_cast<void>(read_gait(file));
  });
}

}  // namespace
}  // namespace koboshi::simulation
