// Runs one firmware on two robots that differ only in their storage.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "tests/closed_loop/run.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::test {
namespace {

using behaviour::State;

const std::filesystem::path kKoboshi = KOBOSHI_SOURCE_DIR "/robots/koboshi";

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  ASSERT_NE(text.find(from), std::string::npos) << from;
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

// Koboshi with legs a fifth longer (thigh and shank of 78 mm instead of 65 mm) and a trunk a quarter heavier.
void write_tall_robot(const std::filesystem::path& folder) {
  std::string robot = read_file(kKoboshi / "robot.sdf");
  replace_all(robot, "<model name=\"koboshi\">", "<model name=\"tall\">");
  replace_all(robot, "<uri>meshes/", "<uri>" + (kKoboshi / "meshes/").string());
  replace_all(robot, "<pose>0 0 0.17 0 0 0</pose>", "<pose>0 0 0.196 0 0 0</pose>");
  for (const std::string side : {"left", "right"}) {
    replace_all(robot, "<pose relative_to=\"" + side + "_thigh\">0 0 -0.065",
                "<pose relative_to=\"" + side + "_thigh\">0 0 -0.078");
    replace_all(robot, "<pose relative_to=\"" + side + "_shank\">0 0 -0.065",
                "<pose relative_to=\"" + side + "_shank\">0 0 -0.078");
  }
  replace_all(robot, "<pose>0 0 -0.037 0 0 0</pose>", "<pose>0 0 -0.0444 0 0 0</pose>");  // thighs
  replace_all(robot, "<pose>0 0 -0.033 0 0 0</pose>", "<pose>0 0 -0.0396 0 0 0</pose>");  // shanks
  replace_all(robot, "<mass>0.36</mass>", "<mass>0.45</mass>");
  write_file(folder / "robot.sdf", robot);
  std::string stand = read_file(kKoboshi / "motions/stand.yaml");
  replace_all(stand, "robot: koboshi", "robot: tall");
  write_file(folder / "stand.yaml", stand);
}

// Scales Koboshi's gait to the same Froude number: lengths by k, times and rate gains by sqrt(k). Compliance
// scales with the weight; angles and ratios stay.
void write_tall_parameters(const std::filesystem::path& folder) {
  std::string text = read_file(kKoboshi / "parameters.yaml");
  replace_all(text, "robot: koboshi", "robot: tall");
  const auto set = [&](const std::string& key, const std::string& value) {
    const std::size_t at = text.find("  " + key + ": ");
    ASSERT_NE(at, std::string::npos) << key;
    text.replace(at, text.find('\n', at) - at, "  " + key + ": " + value);
  };
  set("step_time_ms", "210");
  set("com_height_mm", "188");
  set("step_height_mm", "36");
  set("pitch_compliance_rad_per_m", "1.38");
  set("roll_compliance_rad_per_m", "0.428");
  set("longest_step_mm", "150");
  set("fall_lead_ms", "145");
  set("walking_gain_ankle_roll_s", "0.066");
  write_file(folder / "parameters.yaml", text);
}

simulation::Scenario walk_of(const std::filesystem::path& robot, const std::filesystem::path& stand,
                             const std::filesystem::path& folder) {
  // The robot rests for one second before it is enabled, which the estimate of the gyro bias needs.
  write_file(folder / "walk.yaml",
             "version: 1\n"
             "robot: " +
                 robot.string() +
                 "\n"
                 "motions: [" +
                 stand.string() +
                 "]\n"
                 "duration_s: 6\n"
                 "physics: {stepper: lumped}\n"
                 "initial:\n"
                 "  held_until_s: 2.2\n"
                 "  joints_deg: {hip_roll: 4, hip_pitch: -16, knee: 44, ankle_pitch: -28, ankle_roll: -4}\n"
                 "commands:\n"
                 "  - {at_s: 1.3, enable: true}\n"
                 "  - {at_s: 2.7, walk: {forward_m_per_s: 0.15}}\n");
  return simulation::read_scenario(folder / "walk.yaml");
}

// Makes the robot stand, then walk for 2.5 s without a fall. Returns the distance walked along the ground.
double walked_m(RobotRun& run) {
  EXPECT_TRUE(run.run_until(State::kStanding, 2'700'000));
  EXPECT_TRUE(run.run_until(State::kWalking, 2'900'000));
  run.run_until_us(3'500'000);
  const auto place = [&] {
    return Eigen::Vector2d(run.board().world().body(0).X_WL.translation().head<2>());
  };
  const Eigen::Vector2d from = place();
  run.run_until_us(6'000'000);
  EXPECT_EQ(run.behaviour().state, State::kWalking);
  EXPECT_EQ(run.behaviour().faults, 0);
  EXPECT_GT(run.board().world().body(0).X_WL.linear()(2, 2), std::cos(12.0 * std::numbers::pi / 180.0));
  return (place() - from).norm();
}

TEST(TwoRobots, WalkWithTheSameFirmware) {
  const TemporaryFolder folder;
  RobotRun koboshi(walk_of(kKoboshi / "robot.sdf", kKoboshi / "motions/stand.yaml", folder.path));
  write_tall_robot(folder.path);
  write_tall_parameters(folder.path);
  RobotRun tall(walk_of(folder.path / "robot.sdf", folder.path / "stand.yaml", folder.path));
  EXPECT_GT(walked_m(koboshi), 0.2);
  EXPECT_GT(walked_m(tall), 0.2);
}

// Gait parameters belong to a robot: the firmware does not walk without them.
TEST(TwoRobots, OneWithoutParametersStandsButDoesNotWalk) {
  const TemporaryFolder folder;
  write_tall_robot(folder.path);
  RobotRun run(walk_of(folder.path / "robot.sdf", folder.path / "stand.yaml", folder.path));
  ASSERT_TRUE(run.run_until(State::kStanding, 2'700'000));
  run.run_until_us(2'900'000);
  EXPECT_EQ(run.behaviour().state, State::kStanding);
  EXPECT_EQ(run.behaviour().refusal, behaviour::Reason::kNoGait);
}

}  // namespace
}  // namespace koboshi::test
