#include "sim_board/scenario/reader.h"
#include "sim_board/engine/make_world.h"
#include "sim_board/input/user_units.h"
#include "sim_board/scenario/events_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <numbers>
#include <vector>

#include "tests/unit/sim_board/scenario/temporary_tree.h"

namespace koboshi::sim {
namespace {

using ::testing::HasSubstr;

const char* const kShort =
    "version: 1\n"
    "robot: robots/box/robot.sdf\n"
    "duration_s: 20\n";

const char* const kFull = R"(version: 1
robot: robots/box/robot.sdf
motions: [robots/box/motions/bow.yaml, ../robots/box/motions/squat.yaml]
duration_s: 12.5
seed: 7
noise: 0.5
controller: {computing_time_us: 800}
teleop: true
physics: {step_ms: 0.25, stepper: quick, iterations: 80}
ground: {friction: 0.6, stiffness_N_per_m: 3000, damping_N_s_per_m: 20, tilt_deg: [1, -2]}
initial: {drop_m: 0.01, fixed_base: true, joints_deg: {left_knee: 40, right_knee: -20}}
commands:
  - {at_s: 4, play: squat}
  - {at_s: 1.5, enable: true}
  - {at_s: 9, stop: true}
  - {at_s: 9, emergency_stop: true}
  - {at_s: 10, reset: true}
pushes:
  - {at_s: 6, duration_s: 0.1, link: trunk, force_N: [3, -1, 0.5], at_m: [0, 0, 0.05], shape: half-sine}
  - {at_s: 7, duration_s: 0.2, link: trunk, force_N: [0, 2, 0]}
faults:
  - {at_s: 8, kind: drive_silent, target: left_knee}
  - {at_s: 8.5, kind: ankle_stop, target: right}
  - {at_s: 8.6, kind: bus_unacknowledged}
)";

Scenario read(const TemporaryTree& tree, const std::string& text,
              const std::vector<std::string>& settings = {}) {
  std::vector<Override> overrides;
  for (const std::string& setting : settings) overrides.push_back(parse_override(setting));
  return read_scenario(tree.write("scenarios/test.yaml", text), overrides);
}

// The message with which a text is refused; empty if it is not.
std::string refusal(const std::string& text, const std::vector<std::string>& settings = {}) {
  const TemporaryTree tree;
  try {
    read(tree, text, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ScenarioReader, FillsInWhatAFileLeavesOut) {
  const TemporaryTree tree;
  const Scenario scenario = read(tree, kShort);
  EXPECT_EQ(scenario.robot, tree.root() / "robots/box/robot.sdf");
  EXPECT_TRUE(scenario.motions.empty());
  EXPECT_EQ(scenario.duration_us, 20'000'000u);
  EXPECT_EQ(scenario.seed, 1u);
  EXPECT_EQ(scenario.noise_scale, 1.0);
  EXPECT_EQ(scenario.computing_time_us, 500u);
  EXPECT_FALSE(scenario.teleop);
  EXPECT_EQ(scenario.physics.step_us, 1000u);
  EXPECT_EQ(scenario.physics.stepper, Stepper::kWorld);
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
  EXPECT_EQ(scenario.physics.step_us, 250u);
  EXPECT_EQ(scenario.physics.stepper, Stepper::kQuick);
  EXPECT_EQ(scenario.physics.quick_iterations, 80);
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
  // What the file does not have is not added, line 5 of the scenario tells.
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

TEST(ScenarioReader, TurnsTheBaseAboutTheAxesOfTheWorld) {
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

TEST(ScenarioReader, PutsCommandsInTheOrderOfTimeAndOfTheFile) {
  const TemporaryTree tree;
  const std::vector<Command> commands = read(tree, kFull).commands;
  using Kind = Command::Kind;
  const std::vector<Kind> expected{Kind::kEnable, Kind::kPlay, Kind::kStop, Kind::kEmergencyStop,
                                   Kind::kReset};
  ASSERT_EQ(commands.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(commands[i].kind, expected[i]) << i;
  EXPECT_EQ(commands[0].at_us, 1'500'000u);
  EXPECT_EQ(commands[1].motion, 1u);
}

TEST(ScenarioReader, ReadsTheVelocityToWalkWith) {
  const TemporaryTree tree;
  const std::vector<Command> commands = read(tree, std::string(kShort) + R"(commands:
  - {at_s: 4, walk: {}}
  - {at_s: 6, walk: {forward_m_per_s: 0.15, left_m_per_s: -0.05, turn_rad_per_s: 0.4}}
)")
                                            .commands;
  ASSERT_EQ(commands.size(), 2u);
  EXPECT_EQ(commands[0].kind, Command::Kind::kWalk);
  EXPECT_EQ(commands[0].velocity, Eigen::Vector3d::Zero());
  EXPECT_EQ(commands[1].velocity, Eigen::Vector3d(0.15, -0.05, 0.4));
}

TEST(ScenarioReader, ReadsPushes) {
  const TemporaryTree tree;
  const std::vector<Push> pushes = read(tree, kFull).pushes;
  ASSERT_EQ(pushes.size(), 2u);
  EXPECT_EQ(pushes[0].at_us, 6'000'000u);
  EXPECT_EQ(pushes[0].duration_us, 100'000u);
  EXPECT_EQ(pushes[0].link.text, "trunk");
  EXPECT_EQ(pushes[0].link.line, 19);
  EXPECT_EQ(pushes[0].force_W_N, Eigen::Vector3d(3, -1, 0.5));
  EXPECT_EQ(pushes[0].p_L_m, Eigen::Vector3d(0, 0, 0.05));
  EXPECT_EQ(pushes[0].shape, Push::Shape::kHalfSine);
  EXPECT_FALSE(pushes[1].p_L_m.has_value());
  EXPECT_EQ(pushes[1].shape, Push::Shape::kRectangle);
}

TEST(ScenarioReader, ReadsFaults) {
  const TemporaryTree tree;
  const std::vector<Fault> faults = read(tree, kFull).faults;
  ASSERT_EQ(faults.size(), 3u);
  EXPECT_EQ(faults[0].kind, Fault::Kind::kDriveSilent);
  EXPECT_EQ(faults[0].target.text, "left_knee");
  EXPECT_EQ(faults[1].kind, Fault::Kind::kAnkleStop);
  EXPECT_EQ(faults[1].side, hal::Side::kRight);
  EXPECT_EQ(faults[2].kind, Fault::Kind::kBusUnacknowledged);
  EXPECT_EQ(faults[2].at_us, 8'600'000u);
}

TEST(ScenarioReader, KnowsEveryKindOfFault) {
  const TemporaryTree tree;
  const std::vector<std::pair<std::string, Fault::Kind>> kinds{
      {"drive_silent, target: a", Fault::Kind::kDriveSilent},
      {"drive_power_loss, target: a", Fault::Kind::kDrivePowerLoss},
      {"encoder_break, target: a", Fault::Kind::kEncoderBreak},
      {"drive_overheat, target: a", Fault::Kind::kDriveOverheat},
      {"supply_drop, supply_V: 3", Fault::Kind::kSupplyDrop},
      {"imu_stop", Fault::Kind::kImuStop},
      {"ankle_stop, target: left", Fault::Kind::kAnkleStop},
      {"controller_stop", Fault::Kind::kControllerStop},
      {"bus_unacknowledged", Fault::Kind::kBusUnacknowledged},
      {"bus_dominant", Fault::Kind::kBusDominant},
      {"frames_lost", Fault::Kind::kFramesLost},
      {"frames_corrupted", Fault::Kind::kFramesCorrupted},
      {"frames_delayed, delay_ms: 1", Fault::Kind::kFramesDelayed},
      {"frames_doubled", Fault::Kind::kFramesDoubled},
      {"babbling_node, identifier: 0", Fault::Kind::kBabblingNode}};
  EXPECT_EQ(kinds.size(), Fault::kind_names().size());
  for (const auto& [text, kind] : kinds) {
    const Scenario scenario = read(tree, kShort + ("faults: [{at_s: 1, kind: " + text + "}]\n"));
    EXPECT_EQ(scenario.faults.at(0).kind, kind) << text;
  }
}

TEST(ScenarioReader, ReadsWhatAFaultOfFramesConcerns) {
  const TemporaryTree tree;
  const Scenario scenario =
      read(tree,
           kShort + std::string("faults:\n"
                                "  - {at_s: 1, kind: frames_lost}\n"
                                "  - {at_s: 2, duration_s: 0.5, kind: frames_delayed, target: controller, "
                                "identifier: [0x190, 0x1a3], share: 0.25, count: 7, delay_ms: 2.5}\n"
                                "  - {at_s: 3, kind: frames_doubled, target: left_knee, identifier: 128}\n"));
  const Fault& every = scenario.faults.at(0);
  EXPECT_EQ(every.target.text, "");
  EXPECT_FALSE(every.duration_us);
  EXPECT_EQ(every.frames.effect, FrameFault::Effect::kLost);
  EXPECT_EQ(every.frames.first_identifier, 0);
  EXPECT_EQ(every.frames.last_identifier, 0x7FF);
  EXPECT_EQ(every.frames.share, 1.0);
  EXPECT_EQ(every.frames.count, FrameFault::kUnlimited);
  const Fault& some = scenario.faults.at(1);
  EXPECT_EQ(some.target.text, "controller");
  EXPECT_EQ(some.end_us(), 2'500'000u);
  EXPECT_EQ(some.frames.effect, FrameFault::Effect::kDelayed);
  EXPECT_EQ(some.frames.first_identifier, 0x190);
  EXPECT_EQ(some.frames.last_identifier, 0x1A3);
  EXPECT_EQ(some.frames.share, 0.25);
  EXPECT_EQ(some.frames.count, 7u);
  EXPECT_EQ(some.frames.delay_us, 2500u);
  const Fault& one = scenario.faults.at(2);
  EXPECT_EQ(one.target.text, "left_knee");
  EXPECT_EQ(one.frames.first_identifier, 0x080);
  EXPECT_EQ(one.frames.last_identifier, 0x080);
}

TEST(ScenarioReader, ReadsWhatABabblingNodeSays) {
  const TemporaryTree tree;
  const Scenario scenario = read(
      tree, kShort + std::string("faults:\n"
                                 "  - {at_s: 1, kind: babbling_node, identifier: 0x010}\n"
                                 "  - {at_s: 2, kind: babbling_node, identifier: 0x7FF, size: 0, "
                                 "rate_per_s: 2000}\n"
                                 "  - {at_s: 3, kind: babbling_node, identifier: 0, data: [0x81, 1]}\n"));
  EXPECT_EQ(scenario.faults.at(0).babble.frame.identifier, 0x010);
  EXPECT_EQ(scenario.faults.at(0).babble.frame.size, 8);
  EXPECT_EQ(scenario.faults.at(0).babble.interval_us, 0u);
  EXPECT_EQ(scenario.faults.at(1).babble.frame.size, 0);
  EXPECT_EQ(scenario.faults.at(1).babble.interval_us, 500u);
  EXPECT_EQ(scenario.faults.at(2).babble.frame, (hal::CanFrame{.size = 2, .data = {0x81, 1}}));
}

TEST(ScenarioReader, TakesNoiseAsSwitchOrFactor) {
  const TemporaryTree tree;
  EXPECT_EQ(read(tree, kShort, {"noise=true"}).noise_scale, 1.0);
  EXPECT_EQ(read(tree, kShort, {"noise=false"}).noise_scale, 0.0);
  EXPECT_EQ(read(tree, kShort, {"noise=2.5"}).noise_scale, 2.5);
  EXPECT_THAT(refusal(kShort, {"noise=loud"}), HasSubstr("loud"));
  EXPECT_THAT(refusal(kShort, {"noise=-1"}), HasSubstr("-1"));
}

TEST(ScenarioReader, TakesTheSecondEngineOnlyWhereThereIsOne) {
  const TemporaryTree tree;
  if (has_mujoco()) {
    EXPECT_EQ(read(tree, kShort, {"physics.stepper=mujoco"}).physics.stepper, Stepper::kMujoco);
  } else {
    EXPECT_THAT(refusal(kShort, {"physics.stepper=mujoco"}), HasSubstr("libmujoco-dev"));
  }
}

TEST(PlayedScenario, RunsByItselfFromAnyFolder) {
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

TEST(ScenarioEvents, AreReadAgainAsTheyWereWritten) {
  const TemporaryTree tree;
  Scenario written = read(tree, kFull, {"commands.2.at_s=9.123456"});
  written.commands.push_back(
      {.at_us = 11'000'000, .kind = Command::Kind::kWalk, .velocity = {0.1, -0.02, 1e-3}});
  written.pushes[0].force_W_N = {1.0 / 3.0, -1e-17, 1e4};
  const std::string text = events_text(written);
  const Scenario again =
      read(tree,
           "version: 1\nrobot: robots/box/robot.sdf\nmotions: [robots/box/motions/bow.yaml, "
           "../robots/box/motions/squat.yaml]\n" +
               text);
  EXPECT_EQ(again.duration_us, written.duration_us);
  ASSERT_EQ(again.commands.size(), written.commands.size());
  for (std::size_t i = 0; i < written.commands.size(); ++i) {
    EXPECT_EQ(again.commands[i].at_us, written.commands[i].at_us);
    EXPECT_EQ(again.commands[i].kind, written.commands[i].kind);
    EXPECT_EQ(again.commands[i].motion, written.commands[i].motion);
    EXPECT_EQ(again.commands[i].velocity, written.commands[i].velocity);
  }
  ASSERT_EQ(again.pushes.size(), written.pushes.size());
  for (std::size_t i = 0; i < written.pushes.size(); ++i) {
    EXPECT_EQ(again.pushes[i].at_us, written.pushes[i].at_us);
    EXPECT_EQ(again.pushes[i].duration_us, written.pushes[i].duration_us);
    EXPECT_EQ(again.pushes[i].link.text, written.pushes[i].link.text);
    EXPECT_EQ(again.pushes[i].shape, written.pushes[i].shape);
    EXPECT_EQ(again.pushes[i].force_W_N, written.pushes[i].force_W_N);
    EXPECT_EQ(again.pushes[i].p_L_m, written.pushes[i].p_L_m);
  }
}

TEST(ScenarioReader, LetsTheCommandLineReplaceAndAdd) {
  const TemporaryTree tree;
  const Scenario scenario = read(
      tree, kFull, {"seed=9", "physics.stepper=world", "pushes.1.force_N=[0, -5, 0]", "ground.friction=0.3"});
  EXPECT_EQ(scenario.seed, 9u);
  EXPECT_EQ(scenario.physics.stepper, Stepper::kWorld);
  EXPECT_EQ(scenario.pushes[1].force_W_N.y(), -5.0);
  EXPECT_EQ(scenario.ground.friction, 0.3);
}

// Each line alone makes a good file bad; the message names its line (the fourth) and what it found.
TEST(ScenarioReader, RefusesWhatIsOutOfRangeOrUnknown) {
  const std::vector<std::pair<std::string, std::string>> bad{
      {"colour: red", "unknown key colour"},
      {"seed: -1", "seed = -1"},
      {"seed: 1.5", "seed = 1.5"},
      {"teleop: 2", "teleop = 2"},
      {"motions: [robots/box/motions/jump.yaml]", "no file robots/box/motions/jump.yaml"},
      {"motions: [robots/box/motions/bow.yaml, robots/box/motions/bow.yaml]", "a second motion named bow"},
      {"controller: {computing_time_us: 9001}", "9001"},
      {"physics: {step_ms: 2}", "step_ms = 2"},
      {"physics: {step_ms: 0.3}", "step_ms = 0.3"},
      {"physics: {step_ms: 0.0125}", "step_ms = 0.0125"},
      {"physics: {stepper: fast}", "fast"},
      {"physics: {iterations: 0}", "iterations = 0"},
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

TEST(ScenarioReader, RefusesAFileWithoutItsEssentials) {
  EXPECT_THAT(refusal("robot: robots/box/robot.sdf\nduration_s: 1\n"), HasSubstr("version"));
  EXPECT_THAT(refusal("version: 2\nrobot: robots/box/robot.sdf\nduration_s: 1\n"),
              HasSubstr(":1: found version = 2"));
  EXPECT_THAT(refusal("version: 1\nduration_s: 1\n"), HasSubstr("robot"));
  EXPECT_THAT(refusal("version: 1\nrobot: robots/ball.sdf\nduration_s: 1\n"), HasSubstr(":2: found no file"));
  EXPECT_THAT(refusal("version: 1\nrobot: robots/box/robot.sdf\n"), HasSubstr("duration_s"));
  EXPECT_THROW(read_scenario("/no/such/scenario.yaml"), InputError);
}

TEST(ScenarioReader, RefusesAMotionThatIsNotListed) {
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
}  // namespace koboshi::sim
