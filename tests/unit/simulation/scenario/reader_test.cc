#include "simulation/scenario/reader.h"
#include "base/text/user_units.h"
#include "sim_board/engine/make_world.h"
#include "simulation/scenario/events_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <numbers>
#include <vector>

#include "tests/unit/simulation/scenario/scenario_text.h"

namespace koboshi::simulation {
namespace {

using scenario_text::kFull;
using scenario_text::kShort;
using scenario_text::read;
using scenario_text::refusal;
using ::testing::HasSubstr;

TEST(ScenarioReader, FillsInDefaults) {
  const TemporaryTree tree;
  const Scenario scenario = read(tree, kShort);
  EXPECT_EQ(scenario.robot, tree.root() / "robots/box/robot.sdf");
  EXPECT_TRUE(scenario.motions.empty());
  EXPECT_EQ(scenario.duration_us, 20'000'000u);
  EXPECT_EQ(scenario.seed, 1u);
  EXPECT_EQ(scenario.noise_scale, 1.0);
  EXPECT_EQ(scenario.computing_time_us, 500u);
  EXPECT_EQ(scenario.tick_jitter_us, 0u);
  EXPECT_FALSE(scenario.world);
  EXPECT_FALSE(scenario.teleop);
  EXPECT_EQ(scenario.physics.step_us, 1000u);
  EXPECT_EQ(scenario.physics.stepper, sim_board::Stepper::kLumped);
  EXPECT_FALSE(scenario.ground.friction.has_value());
  EXPECT_FALSE(scenario.initial.base_height_m.has_value());
  EXPECT_FALSE(scenario.initial.fixed_base);
  EXPECT_TRUE(scenario.commands.empty() && scenario.pushes.empty() && scenario.faults.empty());
}

TEST(ScenarioReader, ReadsEverySetting) {
  const TemporaryTree tree;
  const Scenario scenario = read(tree, kFull);
  ASSERT_EQ(scenario.motions.size(), 2u);
  EXPECT_EQ(scenario.motions[1].file, tree.root() / "robots/box/motions/squat.yaml");
  EXPECT_EQ(scenario.duration_us, 12'500'000u);
  EXPECT_EQ(scenario.seed, 7u);
  EXPECT_EQ(scenario.noise_scale, 0.5);
  EXPECT_TRUE(scenario.teleop);
  EXPECT_EQ(scenario.computing_time_us, 800u);
  EXPECT_EQ(scenario.tick_jitter_us, 300u);
  ASSERT_TRUE(scenario.world);
  EXPECT_EQ(scenario.world->ranges, world_named("rough"));
  EXPECT_EQ(scenario.world->seed, 11u);
  EXPECT_EQ(scenario.physics.step_us, 250u);
  EXPECT_EQ(scenario.physics.stepper, sim_board::Stepper::kWorld);
  EXPECT_EQ(scenario.physics.friction, sim_board::FrictionMethod::kRows);
  EXPECT_EQ(scenario.ground.friction, 0.6);
  ASSERT_TRUE(scenario.ground.softness);
  EXPECT_EQ(scenario.ground.softness->stiffness_N_per_m, 3000.0);
  EXPECT_EQ(scenario.ground.softness->damping_N_s_per_m, 20.0);
  EXPECT_DOUBLE_EQ(scenario.ground.roll_rad, 1.0 * kRadPerDegree);
  EXPECT_DOUBLE_EQ(scenario.ground.pitch_rad, -2.0 * kRadPerDegree);
  EXPECT_EQ(scenario.initial.drop_m, 0.01);
  EXPECT_TRUE(scenario.initial.fixed_base);
  ASSERT_EQ(scenario.initial.joints.size(), 2u);
  EXPECT_EQ(scenario.initial.joints[1].joint.text, "right_knee");
  EXPECT_EQ(scenario.initial.joints[1].joint.line, 11);
  EXPECT_DOUBLE_EQ(scenario.initial.joints[1].position_rad, -20.0 * kRadPerDegree);
}

// The robot lacks an ability, and works. A motion by another name is a mistake, as is a path.
TEST(ScenarioReader, LeavesOutMotionsWithAPurposeThatTheRobotDoesNotHave) {
  const TemporaryTree tree;
  tree.write("robots/box/motions/bow.yaml", "version: 1\n");
  const std::string text(kShort);
  const Scenario scenario = read(tree, text + "motions: [stand, bow, rise_prone]\n");
  ASSERT_EQ(scenario.motions.size(), 1u);
  EXPECT_EQ(scenario.motions[0].name(), "bow");
  EXPECT_EQ(scenario.missing_motions, (std::vector<std::string>{"stand", "rise_prone"}));
  EXPECT_THROW(read(tree, text + "motions: [bow, dance]\n"), InputError);
  EXPECT_THROW(read(tree, text + "motions: [motions/rise_prone.yaml]\n"), InputError);
}

TEST(ScenarioReader, ReplacesNumbersOfItsMotions) {
  const TemporaryTree tree;
  tree.write("robots/box/motions/bow.yaml",
             "poses:\n  down: {hip: -40}\nsteps:\n  - {pose: down, time_s: 1}\n");
  const std::string text = std::string(kShort) + "motions: [robots/box/motions/bow.yaml]\n";
  EXPECT_TRUE(read(tree, text).motions[0].overrides.empty());
  const std::vector<Override> overrides =
      read(tree, text, {"motion_set.bow.poses.down.hip=-50", "motion_set.bow.steps.0.time_s=0.5"})
          .motions[0]
          .overrides;
  ASSERT_EQ(overrides.size(), 2u);
  EXPECT_EQ(overrides[0].path, "poses.down.hip");
  EXPECT_EQ(overrides[0].value, "-50");
  EXPECT_EQ(overrides[1].path, "steps.0.time_s");
  // An override adds nothing that the file does not have; the message names line 5 of the scenario.
  const auto refused = [&](const std::string& set) {
    try {
      static_cast<void>(read(tree, text + "motion_set: {" + set + "}\n"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused("bow: {poses: {up: {hip: 1}}}"),
              HasSubstr("test.yaml:5: found poses.up, expected a number of bow.yaml"));
  EXPECT_THAT(refused("bow: {poses: {down: {knee: 1}}}"), HasSubstr("poses.down.knee"));
  EXPECT_THAT(refused("bow: {poses: {down: 1}}"), HasSubstr("found poses.down,"));
  EXPECT_THAT(refused("bow: {steps: {1: {time_s: 1}}}"), HasSubstr("found steps.1,"));
  EXPECT_THAT(refused("bow: {poses: {down: {hip: far}}}"), HasSubstr("far"));
  EXPECT_THAT(refused("squat: {}"), HasSubstr("found the motion squat, expected one of the scenario's"));
}

TEST(ScenarioReader, RotatesTheBaseAboutTheAxesOfTheWorld) {
  const TemporaryTree tree;
  EXPECT_EQ(read(tree, kShort).initial.R_WB, Eigen::Matrix3d::Identity());
  const auto turned = [&](const std::string& attitude) {
    return read(tree, kShort + ("initial: {attitude_deg: " + attitude + "}\n")).initial.R_WB;
  };
  using Eigen::Vector3d;
  // On its face, on its right side, and on its face with the head to the left.
  EXPECT_TRUE((turned("{pitch: 90}") * Vector3d::UnitX()).isApprox(-Vector3d::UnitZ()));
  EXPECT_TRUE((turned("{roll: 90}") * Vector3d::UnitY()).isApprox(Vector3d::UnitZ()));
  EXPECT_TRUE((turned("{pitch: 90, yaw: 90}") * Vector3d::UnitZ()).isApprox(Vector3d::UnitY()));
  EXPECT_TRUE((turned("{roll: 90, pitch: 90}") * Vector3d::UnitY()).isApprox(Vector3d::UnitX()));
}

TEST(ScenarioReader, ReadsNoiseAsSwitchOrFactor) {
  const TemporaryTree tree;
  EXPECT_EQ(read(tree, kShort, {"noise=true"}).noise_scale, 1.0);
  EXPECT_EQ(read(tree, kShort, {"noise=false"}).noise_scale, 0.0);
  EXPECT_EQ(read(tree, kShort, {"noise=2.5"}).noise_scale, 2.5);
  EXPECT_THAT(refusal(kShort, {"noise=loud"}), HasSubstr("loud"));
  EXPECT_THAT(refusal(kShort, {"noise=-1"}), HasSubstr("-1"));
}

TEST(ScenarioReader, KeepsTheDefaultStepperBesideOtherPhysics) {
  const TemporaryTree tree;
  EXPECT_EQ(read(tree, kShort).physics.stepper, Physics{}.stepper);
  EXPECT_EQ(read(tree, kShort, {"physics.step_ms=0.5"}).physics.stepper, Physics{}.stepper);
}

TEST(ScenarioReader, AcceptsTheSecondEngineOnlyIfAvailable) {
  const TemporaryTree tree;
  if (sim_board::has_mujoco()) {
    EXPECT_EQ(read(tree, kShort, {"physics.stepper=mujoco"}).physics.stepper, sim_board::Stepper::kMujoco);
  } else {
    EXPECT_THAT(refusal(kShort, {"physics.stepper=mujoco"}), HasSubstr("libmujoco-dev"));
  }
}

TEST(PlayedScenario, IsSelfContainedInAnyFolder) {
  const TemporaryTree tree;
  Scenario played = read(tree, kFull, {"teleop=true", "seed=9"});
  played.duration_us = 3'210'000;
  played.commands = {{.at_us = 1'000'600, .kind = Command::Kind::kStop}};
  played.pushes.clear();
  tree.write("out/deep/played.yaml", played_text(played, tree.root() / "out/deep"));
  const Scenario again = read_scenario(tree.root() / "out/deep/played.yaml");
  const auto same_file = [](const auto& a, const auto& b) { return std::filesystem::equivalent(a, b); };
  EXPECT_FALSE(again.teleop);
  EXPECT_EQ(again.seed, 9u);
  EXPECT_EQ(again.duration_us, 3'210'000u);
  EXPECT_TRUE(again.pushes.empty());
  ASSERT_EQ(again.commands.size(), 1u);
  EXPECT_EQ(again.commands[0].at_us, 1'000'600u);
  EXPECT_TRUE(same_file(again.robot, played.robot));
  ASSERT_EQ(again.motions.size(), played.motions.size());
  for (std::size_t i = 0; i < again.motions.size(); ++i)
    EXPECT_TRUE(same_file(again.motions[i].file, played.motions[i].file));
  ASSERT_EQ(again.faults.size(), played.faults.size());
  EXPECT_EQ(again.initial.joints.size(), played.initial.joints.size());
  EXPECT_EQ(again.physics.step_us, played.physics.step_us);
}

TEST(ScenarioReader, LetsTheCommandLineReplaceAndAdd) {
  const TemporaryTree tree;
  const Scenario scenario = read(
      tree, kFull, {"seed=9", "physics.stepper=world", "pushes.1.force_N=[0, -5, 0]", "ground.friction=0.3"});
  EXPECT_EQ(scenario.seed, 9u);
  EXPECT_EQ(scenario.physics.stepper, sim_board::Stepper::kWorld);
  EXPECT_EQ(scenario.pushes[1].force_W_N.y(), -5.0);
  EXPECT_EQ(scenario.ground.friction, 0.3);
}

// Each line alone makes a good file bad; the message names its line (the fourth) and what it found.
TEST(ScenarioReader, RejectsValuesOutOfRangeAndUnknownKeys) {
  const std::vector<std::pair<std::string, std::string>> bad{
      {"colour: red", "unknown key colour"},
      {"seed: -1", "seed = -1"},
      {"seed: 1.5", "seed = 1.5"},
      {"teleop: 2", "teleop = 2"},
      {"motions: [robots/box/motions/jump.yaml]", "no file robots/box/motions/jump.yaml"},
      {"motions: [robots/box/motions/bow.yaml, robots/box/motions/bow.yaml]", "a second motion named bow"},
      {"controller: {computing_time_us: 9001}", "9001"},
      {"controller: {tick_jitter_us: 9001}", "9001"},
      {"controller: {computing_time_us: 5000, tick_jitter_us: 4001}", "9001 us of computing time and jitter"},
      {"world: bumpy", "world = bumpy"},
      {"world: {name: rough, seed: -1}", "seed = -1"},
      {"world: {seed: 3}", "name"},
      {"physics: {step_ms: 2}", "step_ms = 2"},
      {"physics: {step_ms: 0.3}", "step_ms = 0.3"},
      {"physics: {step_ms: 0.0125}", "step_ms = 0.0125"},
      {"physics: {stepper: fast}", "fast"},
      {"physics: {friction: little}", "friction = little"},
      {"ground: {friction: -0.1}", "-0.1"},
      {"ground: {stiffness_N_per_m: 3000}", "damping_N_s_per_m"},
      {"ground: {damping_N_s_per_m: 20}", "damping_N_s_per_m"},
      {"ground: {tilt_deg: [50, 0]}", "50"},
      {"ground: {tilt_deg: 5}", "tilt_deg"},
      {"initial: {height_m: 0.3, drop_m: 0.1}", "drop_m beside height_m"},
      {"initial: {joints_deg: {left_knee: 400}}", "left_knee = 400"},
      {"initial: {attitude_deg: {pitch: 361}}", "pitch = 361"},
      {"initial: {attitude_deg: {lean: 10}}", "unknown key initial.attitude_deg.lean"},
      {"commands: [{at_s: -1, enable: true}]", "at_s = -1"},
      {"commands: [{at_s: 1, enable: false}]", "enable = false"},
      {"commands: [{at_s: 1, walk: {forward_m_per_s: 2.1}}]", "forward_m_per_s = 2.1"},
      {"commands: [{at_s: 1, walk: {turn_rad_per_s: -7}}]", "turn_rad_per_s = -7"},
      {"commands: [{at_s: 1, walk: {speed: 1}}]", "speed"},
      {"commands: [{at_s: 1, walk: true}]", "walk"},
      {"commands: [{at_s: 1, walk: {}, stop: true}]", "walk and stop in one command"},
      {"commands: [{at_s: 1}]", "a time without a command, expected enable, play,"},
      {"commands: [{at_s: 1, stop: true, reset: true}]", "stop and reset in one command"},
      {"commands: [{at_s: 1, play: squat}]", "the scenario has none"},
      {"commands: [{at_s: 1, jump: true}]", "found the unknown command jump, expected enable, play,"},
      {"commands: [{at_s: 1, wlak: {}}]", "found the unknown command wlak"},
      {"commands: [{at_s: 1, wlak: {}}]", "; the nearest is walk"},
      {"commands: [{enable: true}]", "no key commands[0].at_s"},
      {"pushes: [{at_s: 1, duration_s: 0, link: a, force_N: [1, 0, 0]}]", "duration_s = 0"},
      {"pushes: [{at_s: 1, duration_s: 1, link: a, force_N: [1, 0]}]", "force_N"},
      {"pushes: [{at_s: 1, duration_s: 1, link: a, force_N: [1, 0, .nan]}]", "nan"},
      {"pushes: [{at_s: 1, duration_s: 1, link: a, force_N: [1, 0, 0], shape: round}]", "round"},
      {"pushes: [{at_s: 1, duration_s: 1, link: a, force_N: [1, 0, 0], strength: 1}]", "strength"},
      {"faults: [{at_s: 1, kind: fire}]", "fire"},
      {"faults: [{at_s: 1, kind: drive_silent}]", "no key faults[0].target"},
      {"faults: [{at_s: 1, kind: ankle_stop, target: both}]", "both"},
      {"faults: [{at_s: 1, kind: imu_stop, target: left}]", "unknown key faults[0].target"},
      {"faults: [{at_s: 1, kind: imu_stop, duration_s: 0}]", "duration_s = 0"},
      {"faults: [{at_s: 1, kind: imu_stop, share: 1}]", "unknown key faults[0].share"},
      {"faults: [{at_s: 1, kind: encoder_break, target: a, duration_s: 1}]",
       "unknown key faults[0].duration_s"},
      {"faults: [{at_s: 1, kind: supply_drop}]", "no key faults[0].supply_V"},
      {"faults: [{at_s: 1, kind: battery_discharge}]", "no key faults[0].open_circuit_V"},
      {"faults: [{at_s: 1, kind: battery_discharge, open_circuit_V: 6, over_s: -1}]", "over_s = -1"},
      {"faults: [{at_s: 1, kind: battery_discharge, open_circuit_V: 6, duration_s: 1}]",
       "unknown key faults[0].duration_s"},
      {"faults: [{at_s: 1, kind: frames_lost, identifier: 0x800}]", "identifier = 0x800"},
      {"faults: [{at_s: 1, kind: frames_lost, identifier: 0xg}]", "identifier = 0xg"},
      {"faults: [{at_s: 1, kind: frames_lost, identifier: [1, 2, 3]}]", "faults[0].identifier"},
      {"faults: [{at_s: 1, kind: frames_lost, identifier: [2, 1]}]", "identifier[1] = 1"},
      {"faults: [{at_s: 1, kind: frames_lost, share: 1.5}]", "share = 1.5"},
      {"faults: [{at_s: 1, kind: frames_lost, count: 0}]", "count = 0"},
      {"faults: [{at_s: 1, kind: frames_lost, delay_ms: 1}]", "unknown key faults[0].delay_ms"},
      {"faults: [{at_s: 1, kind: frames_delayed}]", "no key faults[0].delay_ms"},
      {"faults: [{at_s: 1, kind: babbling_node}]", "no key faults[0].identifier"},
      {"faults: [{at_s: 1, kind: babbling_node, identifier: 0, rate_per_s: 0}]", "rate_per_s = 0"},
      {"faults: [{at_s: 1, kind: babbling_node, identifier: 0, size: 9}]", "size = 9"},
      {"faults: [{at_s: 1, kind: babbling_node, identifier: 0, data: [256]}]", "data[0] = 256"},
      {"faults: [{at_s: 1, kind: babbling_node, identifier: 0, data: [1, 2, 3, 4, 5, 6, 7, 8, 9]}]",
       "more than 8 bytes"},
      {"faults: [{at_s: 1, kind: babbling_node, identifier: 0, data: [1], size: 1}]",
       "unknown key faults[0].size"},
      {"faults: none", "none"}};
  for (const auto& [line, found] : bad) {
    const std::string message = refusal(kShort + line + "\n");
    EXPECT_THAT(message, HasSubstr("scenarios/test.yaml:4: found ")) << line;
    EXPECT_THAT(message, HasSubstr(found)) << line;
    EXPECT_THAT(message, HasSubstr(", expected ")) << line;
  }
}

TEST(ScenarioReader, RejectsAFileWithoutRequiredKeys) {
  EXPECT_THAT(refusal("robot: robots/box/robot.sdf\nduration_s: 1\n"), HasSubstr("version"));
  EXPECT_THAT(refusal("version: 2\nrobot: robots/box/robot.sdf\nduration_s: 1\n"),
              HasSubstr(":1: found version = 2"));
  EXPECT_THAT(refusal("version: 1\nduration_s: 1\n"), HasSubstr("robot"));
  EXPECT_THAT(refusal("version: 1\nrobot: robots/ball.sdf\nduration_s: 1\n"), HasSubstr(":2: found no file"));
  EXPECT_THAT(refusal("version: 1\nrobot: robots/box/robot.sdf\n"), HasSubstr("duration_s"));
  EXPECT_THROW(read_scenario("/no/such/scenario.yaml"), InputError);
}

TEST(ScenarioReader, RejectsAMotionThatIsNotListed) {
  const std::string text = kShort + std::string("motions: [robots/box/motions/bow.yaml]\n");
  EXPECT_THAT(refusal(text + "commands: [{at_s: 1, play: squat}]\n"),
              HasSubstr("play = squat, expected bow"));
}

TEST(ScenarioReader, ReadsTheScenariosOfTheRepository) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(KOBOSHI_SOURCE_DIR "/scenarios")) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_NO_THROW(read_scenario(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace koboshi::simulation
