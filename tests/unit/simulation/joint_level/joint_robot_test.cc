#include "simulation/joint_level/joint_robot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/text/error.h"
#include "sim_board/can/observer.h"
#include "simulation/joint_level/joint_robots.h"
#include "simulation/scenario/reader.h"
#include "tests/closed_loop/other_robots.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

Scenario scenario_of(const std::string& name, const std::vector<Override>& more = {}) {
  std::vector<Override> overrides{{"physics.stepper", "lumped"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return read_scenario(std::string(KOBOSHI_SOURCE_DIR) + "/scenarios/" + name + ".yaml", overrides);
}

std::shared_ptr<const JointScenario> joints_scenario(const std::vector<Override>& more = {}) {
  return prepare_joint_level(scenario_of("joints", more));
}

std::vector<double> observed(const JointRobot& robot) {
  std::vector<double> row(robot.observation_size());
  robot.observe(row);
  return row;
}

std::vector<double> part(const JointRobot& robot, const std::string& name) {
  const auto row = observed(robot);
  for (const ObservationField& field : robot.fields()) {
    const auto first = row.begin() + static_cast<std::ptrdiff_t>(field.first);
    if (field.name == name) return {first, first + static_cast<std::ptrdiff_t>(field.size)};
  }
  ADD_FAILURE() << "no observation named " << name;
  return {};
}

TEST(JointRobot, HasBootedAndHoldsItsPose) {
  JointRobot robot(joints_scenario(), 1);
  EXPECT_TRUE(robot.enabled());
  EXPECT_EQ(robot.fault(), "");
  EXPECT_EQ(robot.now_us() % 10'000, 0u);
  EXPECT_LT(robot.now_us(), 1'000'000u);  // before the stand releases it
  const auto before = part(robot, "joint_position_rad");
  robot.step(3'000);
  EXPECT_LT(robot.truth().tilt_rad, 0.1);
  EXPECT_NEAR(robot.truth().foot_load_N[0] + robot.truth().foot_load_N[1],
              9.81 * robot.robot().total_mass_kg(), 0.5);
  const auto after = part(robot, "joint_position_rad");
  for (std::size_t joint = 0; joint < before.size(); ++joint)
    EXPECT_NEAR(after[joint], before[joint], 0.05) << robot.robot().joints[joint].name;
}

TEST(JointRobot, MovesTheJointThatIsTold) {
  JointRobot robot(joints_scenario({{"initial.held_until_s", "100"}}), 1);
  auto targets = part(robot, "joint_position_rad");
  const auto joint = static_cast<std::size_t>(*robot.robot().find_joint("head_pan"));
  targets[joint] += 0.3;
  robot.set_targets(targets);
  robot.step(600);
  EXPECT_NEAR(part(robot, "joint_position_rad")[joint], targets[joint], 0.03);
  targets[joint] = 1e9;  // the joint's limit bounds it
  robot.set_targets(targets);
  robot.step(3'000);
  EXPECT_NEAR(part(robot, "joint_position_rad")[joint], robot.robot().joints[joint].upper_rad, 0.05);
}

// The frames to the first drive, by the times of their beginnings.
struct RpdoTimes final : sim_board::BusObserver {
  explicit RpdoTimes(std::uint8_t node_id) : identifier(static_cast<std::uint16_t>(0x200 + node_id)) {}
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t /*end_us*/) override {
    if (frame.identifier == identifier) starts_us.push_back(start_us);
  }
  std::uint16_t identifier;
  std::vector<std::uint64_t> starts_us;
};

TEST(JointRobot, SendsTargetsOnceInEachCycleAfterItsComputingTime) {
  JointRobot robot(joints_scenario(), 1);
  RpdoTimes times(robot.robot().joints[0].drive.node_id);
  robot.board().electronics().bus().set_observer(&times);
  robot.set_targets(part(robot, "joint_position_rad"));
  const std::uint64_t start_us = robot.now_us();
  for (int i = 0; i < 25; ++i) robot.step(2);  // steps need not be whole cycles
  ASSERT_EQ(times.starts_us.size(), 5u);
  for (std::size_t i = 0; i < times.starts_us.size(); ++i) {
    const std::uint64_t after_tick_us = times.starts_us[i] - start_us - 10'000 * i;
    EXPECT_GE(after_tick_us, robot.scenario().computing_time_us);
    EXPECT_LT(after_tick_us, robot.scenario().computing_time_us + 500);
  }
}

// The controller's heartbeats, after which each drive would stop without them (kControllerHeartbeatLost_ms).
class HeartbeatTimes final : public sim_board::BusObserver {
 public:
  void on_bus_frame(const hal::CanFrame& frame, std::uint64_t start_us, std::uint64_t) override {
    if (frame.identifier == 0x701) starts_us.push_back(start_us);
  }
  std::vector<std::uint64_t> starts_us;
};

TEST(JointRobot, SendsItsHeartbeatFiftyTimesASecond) {
  JointRobot robot(joints_scenario(), 1);
  HeartbeatTimes times;
  robot.board().electronics().bus().set_observer(&times);
  robot.step(1'000);
  EXPECT_EQ(times.starts_us.size(), 50u);
  for (std::size_t i = 1; i < times.starts_us.size(); ++i)
    EXPECT_NEAR(static_cast<double>(times.starts_us[i] - times.starts_us[i - 1]), 20'000.0, 1'000.0);
}

// The sag of the common supply while the joints with these names turn by 0.3 rad, in mV.
int sag_mV(const std::vector<std::string>& names) {
  JointRobot robot(joints_scenario({{"initial.held_until_s", "100"}, {"noise", "false"}}), 1);
  auto targets = part(robot, "joint_position_rad");
  for (const std::string& name : names)
    targets[static_cast<std::size_t>(*robot.robot().find_joint(name))] += 0.3;
  robot.set_targets(targets);
  int lowest_mV = 1'000'000;
  for (int i = 0; i < 100; ++i) {
    robot.step(1);
    lowest_mV =
        std::min(lowest_mV, static_cast<int>(robot.board().electronics().drive(0).values().supply_mV));
  }
  return static_cast<int>(1e3 * robot.robot().battery->open_circuit_V) - lowest_mV;
}

TEST(JointRobot, DrawsTheCurrentsOfAllDrivesFromItsBattery) {
  const int one_mV = sag_mV({"head_pan"});
  const int two_mV = sag_mV({"head_pan", "left_elbow"});
  const int three_mV = sag_mV({"head_pan", "left_elbow", "right_elbow"});
  EXPECT_GT(one_mV, 20);
  EXPECT_GT(two_mV, one_mV + 20);
  EXPECT_GT(three_mV, two_mV + 20);
}

TEST(JointRobot, HasEverySampleOfTheInertialUnit) {
  JointRobot robot(joints_scenario(), 1);
  robot.step(10);
  EXPECT_EQ(robot.imu_samples().size(), 10u);
  robot.step(2'000);
  EXPECT_EQ(robot.imu_samples().size(), 1'024u);
  const auto accelerometer = part(robot, "accelerometer_m_per_s2");
  EXPECT_NEAR(std::hypot(accelerometer[0], accelerometer[1], accelerometer[2]), 9.81, 0.5);
  robot.step(0);
  EXPECT_TRUE(robot.imu_samples().empty());
}

// The scenario of the joints with another robot.
class OtherJointRobot {
 public:
  explicit OtherJointRobot(const std::string& text) {
    test::write_robot(folder_.path, text, true, false);
    robot.emplace(joints_scenario({{"robot", (folder_.path / "robot.sdf").string()}}), 1);
    robot->step(2'000);
  }
  std::optional<JointRobot> robot;
  double weight_N() const { return 9.81 * robot->robot().total_mass_kg(); }

 private:
  test::TemporaryFolder folder_;
};

TEST(JointRobot, ObservesForcesOfItsFeetByTheKindOfSensor) {
  const OtherJointRobot axes(test::default_robot());
  EXPECT_NEAR(part(*axes.robot, "foot_left")[2] + part(*axes.robot, "foot_right")[2], axes.weight_N(),
              0.1 * axes.weight_N());
  const OtherJointRobot cells(test::with_pressure_cells(test::default_robot()));
  double sum_N = 0.0;
  for (const char* foot : {"foot_left", "foot_right"}) {
    const auto forces_N = part(*cells.robot, foot);
    for (std::size_t cell = 0; cell < 4; ++cell) sum_N += forces_N[cell];
  }
  EXPECT_NEAR(sum_N, cells.weight_N(), 0.1 * cells.weight_N());
  const OtherJointRobot switches(test::with_contact_switches(test::default_robot()));
  for (const char* foot : {"foot_left", "foot_right"})
    EXPECT_EQ(part(*switches.robot, foot), (std::vector<double>{0, 0, 1, 0, 0, 0})) << foot;
}

TEST(JointRobot, ObservesZerosOfFeetWithoutSensors) {
  const OtherJointRobot none(test::without_ankle_sensors(test::default_robot()));
  for (const char* foot : {"foot_left", "foot_right"})
    EXPECT_EQ(part(*none.robot, foot), std::vector<double>(6, 0.0)) << foot;
  EXPECT_GT(part(*none.robot, "supply_V")[0], 7.0);
}

TEST(JointRobot, SeesEncodersInTheirSteps) {
  JointRobot robot(joints_scenario(), 1);
  const auto before = part(robot, "joint_position_rad");
  robot.step(1'500);
  const auto after = part(robot, "joint_position_rad");
  int moved = 0;
  for (std::size_t joint = 0; joint < after.size(); ++joint) {
    const double step_rad = std::ldexp(2.0 * std::numbers::pi, -robot.robot().joints[joint].encoder.bits);
    const double steps = (after[joint] - before[joint]) / step_rad;
    EXPECT_NEAR(steps, std::round(steps), 1e-3) << robot.robot().joints[joint].name;
    moved += std::abs(steps) > 0.5 ? 1 : 0;
  }
  EXPECT_GT(moved, 3);  // the robot sagged when it took its weight
}

TEST(JointRobot, GoesLimpAndComesBack) {
  JointRobot robot(joints_scenario(), 1);
  robot.step(1'000);
  robot.enable(false);
  robot.step(1'500);
  EXPECT_FALSE(robot.enabled());
  EXPECT_EQ(part(robot, "enabled")[0], 0.0);
  EXPECT_LT(robot.truth().p_WB_W.z(), 0.8 * JointRobot(joints_scenario(), 1).truth().p_WB_W.z());
  robot.set_targets(part(robot, "joint_position_rad"));
  robot.enable(true);
  robot.step(500);
  EXPECT_TRUE(robot.enabled());
}

TEST(JointRobot, LimitsTorques) {
  JointRobot robot(joints_scenario(), 1);
  robot.limit_torques(std::vector<double>(robot.robot().joints.size(), 0.0));
  robot.step(2'500);
  EXPECT_TRUE(robot.enabled());
  EXPECT_LT(robot.truth().p_WB_W.z(), 0.8 * JointRobot(joints_scenario(), 1).truth().p_WB_W.z());
}

TEST(JointRobot, GivesTheSameBitsAgain) {
  const auto prepared = joints_scenario({{"world", "rough"}});
  const auto play = [](JointRobot& robot) {
    auto targets = part(robot, "joint_position_rad");
    targets[0] += 0.1;
    robot.set_targets(targets);
    robot.step(700);
    return observed(robot);
  };
  JointRobot first(prepared, 3);
  const auto expected = play(first);
  JointRobot other(prepared, 4);
  EXPECT_NE(play(other), expected);
  other.reset(3);
  EXPECT_EQ(play(other), expected);

  JointRobot third(prepared, 3);
  auto saved = third.save();
  EXPECT_EQ(play(third), expected);
  third.restore(saved);
  EXPECT_EQ(play(third), expected);
  EXPECT_THROW(first.restore(saved), std::logic_error) << "a state of another robot";
  third.reset(3);
  EXPECT_THROW(third.restore(saved), std::logic_error);
}

TEST(JointRobot, RefusesWhatItCannotDo) {
  JointRobot robot(joints_scenario(), 1);
  const std::size_t joints = robot.robot().joints.size();
  const auto message = [](const auto& act) {
    try {
      act();
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  std::vector<double> targets(joints, 0.0);
  targets[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message([&] { robot.set_targets(targets); }),
            "found nan for " + robot.robot().joints[2].name + ", expected an angle in rad");
  EXPECT_EQ(message([&] { robot.set_targets(std::vector<double>(3)); }),
            "found 3 numbers, expected " + std::to_string(joints) + ", one for each joint");
  EXPECT_NE(message([&] { robot.limit_torques(std::vector<double>(joints, 1.5)); }), "accepted");
  EXPECT_THROW(static_cast<void>(prepare_joint_level(scenario_of("go"))), InputError);
}

TEST(JointRobot, NamesTheDriveThatFails) {
  JointRobot robot(joints_scenario(), 1);
  robot.step(100);
  robot.board().electronics().cut_drive_power(4);
  robot.step(1'000);
  EXPECT_FALSE(robot.enabled());
  EXPECT_NE(robot.fault().find(robot.robot().joints[4].name), std::string::npos) << robot.fault();
}

TEST(JointRobots, GiveEachTheBitsThatItHasAlone) {
  const std::vector<std::uint64_t> seeds{7, 2, 9};
  JointRobots robots(scenario_of("joints"), seeds, 2);
  const std::size_t joints = robots.at(0).robot().joints.size();
  const std::size_t size = robots.at(0).observation_size();
  std::vector<double> targets(seeds.size() * joints, 0.1);
  std::vector<double> rows(seeds.size() * size);
  for (int i = 0; i < 30; ++i) robots.step(targets, 10, rows);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    JointRobot alone(joints_scenario(), seeds[i]);
    alone.set_targets(std::vector<double>(joints, 0.1));
    // Observations of means over a step depend on its length.
    for (int step = 0; step < 30; ++step) alone.step(10);
    EXPECT_EQ(observed(alone),
              std::vector<double>(rows.begin() + static_cast<std::ptrdiff_t>(i * size),
                                  rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * size)));
  }
}

TEST(JointRobots, RestartOnlyThoseThatAreNamed) {
  const std::vector<std::uint64_t> seeds{7, 2};
  JointRobots robots(scenario_of("joints"), seeds, 2);
  std::vector<double> rows(2 * robots.at(0).observation_size());
  robots.step({}, 300, rows);
  const std::uint64_t booted_us = JointRobot(joints_scenario(), 5).now_us();
  const std::vector<JointRobots::Restart> restarts{{1, 5}};
  robots.reset(restarts);
  EXPECT_EQ(robots.at(1).now_us(), booted_us);
  EXPECT_EQ(robots.at(1).seed(), 5u);
  EXPECT_EQ(robots.at(0).now_us(), booted_us + 300'000);
}

TEST(JointRobots, CheckAllTargetsBeforeAnyMoves) {
  const std::vector<std::uint64_t> seeds{7, 2};
  JointRobots robots(scenario_of("joints"), seeds, 1);
  std::vector<double> rows(2 * robots.at(0).observation_size());
  std::vector<double> targets(2 * robots.at(0).robot().joints.size(), 0.0);
  targets.back() = std::numeric_limits<double>::infinity();
  const std::uint64_t before_us = robots.at(0).now_us();
  EXPECT_THROW(robots.step(targets, 10, rows), std::invalid_argument);
  EXPECT_EQ(robots.at(0).now_us(), before_us);
  EXPECT_THROW(robots.step(std::vector<double>(3), 10, rows), std::invalid_argument);
}

}  // namespace
}  // namespace koboshi::simulation
