#include "simulation/scenario/events_text.h"
#include "simulation/scenario/reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "tests/unit/simulation/scenario/scenario_text.h"

namespace koboshi::simulation {
namespace {

using scenario_text::kFull;
using scenario_text::kShort;
using scenario_text::read;

TEST(ScenarioReader, SortsCommandsByTimeAndOrderOfTheFile) {
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

TEST(ScenarioReader, ReadsTheVelocityOfAWalk) {
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

TEST(ScenarioReader, ReadsTheJointsOfAStream) {
  const TemporaryTree tree;
  const std::vector<Command> commands = read(tree, std::string(kShort) + R"(commands:
  - {at_s: 4, stream: {}}
  - {at_s: 6, stream: {joints_deg: {head_pan: 90, left_knee: -180}}}
)")
                                            .commands;
  ASSERT_EQ(commands.size(), 2u);
  EXPECT_EQ(commands[0].kind, Command::Kind::kStream);
  EXPECT_TRUE(commands[0].stream.empty());
  ASSERT_EQ(commands[1].stream.size(), 2u);
  EXPECT_EQ(commands[1].stream[0].joint.text, "head_pan");
  EXPECT_NEAR(commands[1].stream[0].target_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(commands[1].stream[1].target_rad, -std::numbers::pi, 1e-12);
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

TEST(ScenarioReader, ReadsEveryKindOfFault) {
  const TemporaryTree tree;
  const std::vector<std::pair<std::string, Fault::Kind>> kinds{
      {"drive_silent, target: a", Fault::Kind::kDriveSilent},
      {"drive_power_loss, target: a", Fault::Kind::kDrivePowerLoss},
      {"encoder_break, target: a", Fault::Kind::kEncoderBreak},
      {"drive_overheat, target: a", Fault::Kind::kDriveOverheat},
      {"supply_drop, supply_V: 3", Fault::Kind::kSupplyDrop},
      {"battery_discharge, open_circuit_V: 5.5", Fault::Kind::kBatteryDischarge},
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

TEST(ScenarioReader, ReadsTheDischargeOfABattery) {
  const TemporaryTree tree;
  const Scenario scenario = read(
      tree, kShort + std::string("faults:\n"
                                 "  - {at_s: 1, kind: battery_discharge, open_circuit_V: 5.5, over_s: 4}\n"
                                 "  - {at_s: 6, kind: battery_discharge, open_circuit_V: 3}\n"));
  EXPECT_EQ(scenario.faults.at(0).open_circuit_V, 5.5);
  EXPECT_EQ(scenario.faults.at(0).over_us, 4'000'000u);
  EXPECT_FALSE(scenario.faults.at(0).duration_us);
  EXPECT_EQ(scenario.faults.at(1).over_us, 0u);
}

TEST(ScenarioReader, ReadsTheFramesOfAFault) {
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
  EXPECT_EQ(every.frames.effect, sim_board::FrameFault::Effect::kLost);
  EXPECT_EQ(every.frames.first_identifier, 0);
  EXPECT_EQ(every.frames.last_identifier, 0x7FF);
  EXPECT_EQ(every.frames.share, 1.0);
  EXPECT_EQ(every.frames.count, sim_board::FrameFault::kUnlimited);
  const Fault& some = scenario.faults.at(1);
  EXPECT_EQ(some.target.text, "controller");
  EXPECT_EQ(some.end_us(), 2'500'000u);
  EXPECT_EQ(some.frames.effect, sim_board::FrameFault::Effect::kDelayed);
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

TEST(ScenarioReader, ReadsTheFramesOfABabblingNode) {
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

TEST(ScenarioEvents, RoundTrip) {
  const TemporaryTree tree;
  Scenario written = read(tree, kFull, {"commands.2.at_s=9.123456"});
  written.commands.push_back(
      {.at_us = 11'000'000, .kind = Command::Kind::kWalk, .velocity = {0.1, -0.02, 1e-3}});
  written.commands.push_back(
      {.at_us = 12'000'000,
       .kind = Command::Kind::kStream,
       .stream = {{{"hip", "scenario.yaml", 1}, 0.1}, {{"neck", "scenario.yaml", 1}, -1.0 / 3.0}}});
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
    ASSERT_EQ(again.commands[i].stream.size(), written.commands[i].stream.size());
    for (std::size_t joint = 0; joint < written.commands[i].stream.size(); ++joint) {
      EXPECT_EQ(again.commands[i].stream[joint].joint.text, written.commands[i].stream[joint].joint.text);
      EXPECT_NEAR(again.commands[i].stream[joint].target_rad, written.commands[i].stream[joint].target_rad,
                  1e-12);
    }
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

}  // namespace
}  // namespace koboshi::simulation
