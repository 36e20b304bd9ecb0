// A motion releases or softens an arm, which sinks, and takes it back.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/closed_loop/run.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::test {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180;
constexpr std::uint64_t kPlayed_us = 4'000'000;

constexpr const char* kReleaseAnArm = R"(version: 2
robot: koboshi
name: release
poses:
  raised: {left_shoulder_pitch: -80, left_shoulder_roll: 10, left_elbow: -10}
steps:
  - {pose: raised, time_s: 1}
  - {wait_s: 0.3}
  - {torque_off: [left_arm]}
  - {wait_s: 1.5}
  - {stiffness: {left_arm: 100}}
  - {pose: raised, time_s: 1, interpolation: minimum_jerk}
)";

// A hanging robot that plays the motion of this name.
simulation::Scenario scenario(const std::filesystem::path& folder, const char* name, const char* motion) {
  const auto file = folder / (std::string(name) + ".yaml");
  write_file(file, motion);
  const std::vector<Override> overrides{
      {"physics.stepper", "lumped"},
      {"initial", "{fixed_base: true}"},
      {"motions", "[robots/koboshi/motions/stand.yaml, " + file.string() + "]"},
      {"commands", "[{at_s: 2, enable: true}, {at_s: 4, play: " + std::string(name) + "}]"}};
  return simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/squat.yaml", overrides);
}

// Gear friction stops the arm half-way down: it hangs by 30 degrees lower.
TEST(Stiffness, ReleasesAnArmAndTakesItBackWithoutAJerk) {
  const TemporaryFolder folder;
  RobotRun run(scenario(folder.path, "release", kReleaseAnArm));
  const std::size_t joint = run.joint("left_shoulder_pitch");
  const auto shaft_deg = [&] {
    return run.board().world().joint(static_cast<int>(joint)).position_rad / kRadPerDegree;
  };
  const auto limit = [&] { return run.board().electronics().drive(joint).values().max_torque_permille; };

  run.run_until_us(kPlayed_us + 1'250'000);
  EXPECT_EQ(limit(), 1'000);
  EXPECT_NEAR(shaft_deg(), -80, 1);
  run.run_until_us(kPlayed_us + 1'400'000);
  EXPECT_EQ(limit(), 0);
  EXPECT_EQ(run.board().electronics().drive(joint).torque_Nm(), 0.0);
  run.run_until_us(kPlayed_us + 2'750'000);
  EXPECT_GT(shaft_deg(), -60) << "it hangs";
  EXPECT_EQ(run.board().electronics().drive(joint).torque_Nm(), 0.0);

  // A minimum-jerk move over 31 degrees in a second has a peak speed of 58 deg/s. A drive that was to return
  // to its old target at once would turn at some 300 deg/s.
  double fastest_deg_per_s = 0;
  double before_deg = shaft_deg();
  while (run.now_us() < kPlayed_us + 3'900'000) {
    run.run_until_us(run.now_us() + 10'000);
    fastest_deg_per_s = std::max(fastest_deg_per_s, 100 * std::abs(shaft_deg() - before_deg));
    before_deg = shaft_deg();
  }
  EXPECT_GT(fastest_deg_per_s, 40);
  EXPECT_LT(fastest_deg_per_s, 75);
  EXPECT_NEAR(shaft_deg(), -80, 1);
  EXPECT_EQ(limit(), 1'000);
  EXPECT_EQ(run.behaviour().state, behaviour::State::kStanding);
  EXPECT_EQ(run.behaviour().faults, 0);
}

constexpr const char* kSoftArm = R"(version: 2
robot: koboshi
name: soften
poses:
  raised: {left_shoulder_pitch: -80, left_shoulder_roll: 10, left_elbow: -10}
steps:
  - {pose: raised, time_s: 1, gain: {left_arm: 20}, pause_s: 1}
  - {wait_s: 1}
)";

// The servos' friction holds a part of the load, which is the same for both gains.
TEST(Gain, LetsAnArmSinkUnderItsWeightAndTakesItBack) {
  const TemporaryFolder folder;
  RobotRun run(scenario(folder.path, "soften", kSoftArm));
  const std::size_t joint = run.joint("left_shoulder_pitch");
  const auto& drive = run.board().electronics().drive(joint);
  const auto shaft_deg = [&] {
    return run.board().world().joint(static_cast<int>(joint)).position_rad / kRadPerDegree;
  };
  run.run_until_us(kPlayed_us + 1'900'000);
  EXPECT_EQ(drive.values().position_gain_permille, 200);
  const double soft_deg = shaft_deg();
  run.run_until_us(kPlayed_us + 2'900'000);
  EXPECT_EQ(drive.values().position_gain_permille, 1'000);
  const double own_deg = shaft_deg();
  EXPECT_NEAR(own_deg, -80, 1);
  EXPECT_GT(soft_deg, own_deg + 1.0);
  EXPECT_LT(soft_deg, own_deg + 15.0) << "it still holds the arm";
  EXPECT_EQ(run.behaviour().faults, 0);
}

}  // namespace
}  // namespace koboshi::test
