#include <gtest/gtest.h>

#include "firmware/canopen/cia402.h"
#include "tests/closed_loop/run.h"

namespace koboshi::test {
namespace {

using behaviour::Reason;
using behaviour::State;
using drive::DriveFault;
using Kind = simulation::Fault::Kind;
using DriveState = canopen::cia402::State;

constexpr std::uint8_t kFirstDrive = 16;
constexpr std::uint16_t kBehaviour = 0xFF00;  // error code of the controller, in the range of device-specific
                                              // errors
constexpr std::uint64_t kInMotion_us = 2'000'000;
// Maximum time from the trigger to torque off: 50 ms of ramp, 100 ms of holding, one period of the drive's
// loop and one cycle.
constexpr std::uint64_t kStop_us = 165'000;

// Checks state, drive-enable line, drives and emergency messages half a second after any fault.
void expect_fault(RobotRun& run, std::uint64_t at_us, Reason reason) {
  run.run_until_us(at_us + 500'000);
  EXPECT_EQ(run.behaviour().state, State::kFault);
  EXPECT_EQ(run.behaviour().reason, reason);
  EXPECT_EQ(run.behaviour().faults, 1);
  EXPECT_FALSE(run.board().electronics().drive_enable_line());
  EXPECT_EQ(run.torque_count(), 0);
}

void expect_emergency(const RobotRun& run, State state, Reason reason) {
  const auto emergencies = run.emergencies(kController, kBehaviour);
  ASSERT_EQ(emergencies.size(), 1u);
  EXPECT_EQ(emergencies[0].frame.data[3], static_cast<std::uint8_t>(state));
  EXPECT_EQ(emergencies[0].frame.data[4], static_cast<std::uint8_t>(reason));
}

// --- The firmware stops

TEST(FirmwareStops, InMidSquatAllDrivesPerformAQuickStopThenCutTheirTorque) {
  RobotRun run(with_fault(quick_squat(), Kind::kControllerStop, kMidSquat_us));
  run.run_until_us(kMidSquat_us);
  ASSERT_EQ(run.count_in(DriveState::kOperationEnabled), 20);

  // Limits: five cycles without SYNC, or 60 ms without heartbeat. Both periods began up to one cycle or one
  // heartbeat earlier.
  run.run_until_us(kMidSquat_us + 38'000);
  EXPECT_EQ(run.count_in(DriveState::kOperationEnabled), 20);
  run.run_until_us(kMidSquat_us + 52'000);
  EXPECT_EQ(run.count_in(DriveState::kFaultReactionActive), 20);
  EXPECT_EQ(run.torque_count(), 20);  // the drives hold their position and keep torque
  EXPECT_TRUE(run.board().electronics().drive_enable_line());
  run.run_until_us(kMidSquat_us + 52'000 + kStop_us);
  EXPECT_EQ(run.count_in(DriveState::kFault), 20);
  EXPECT_EQ(run.torque_count(), 0);

  for (std::uint8_t node = kFirstDrive; node < kFirstDrive + 20; ++node) {
    auto told = run.emergencies(node, canopen::cia402::kErrorSyncLost);
    for (const auto& frame : run.emergencies(node, canopen::cia402::kErrorHeartbeatLost))
      told.push_back(frame);
    ASSERT_FALSE(told.empty()) << int{node};  // the second loss follows the first
    EXPECT_LE(told[0].end_us, kMidSquat_us + 55'000);
  }
}

TEST(FirmwareStops, WatchdogLowersTheLine) {
  RobotRun run(with_fault(hanging_squat(), Kind::kControllerStop, kInMotion_us));
  run.run_until_us(kInMotion_us + sim_board::Electronics::kWatchdog_us - 1'000);
  EXPECT_TRUE(run.board().electronics().drive_enable_line());
  run.run_until_us(kInMotion_us + sim_board::Electronics::kWatchdog_us + 1'000);
  EXPECT_FALSE(run.board().electronics().drive_enable_line());
  EXPECT_TRUE(run.board().electronics().watchdog_bitten());
}

// --- Drives

TEST(DriveHangs, FromTheStartTheRobotStaysLimp) {
  RobotRun run(with_fault(hanging_squat(), Kind::kDriveSilent, 0, "left_knee"));
  ASSERT_TRUE(run.run_until(State::kFault, 1'100'000));
  EXPECT_EQ(run.behaviour().drive_fault, DriveFault::kSilent);
  EXPECT_EQ(run.behaviour().faulty_joint, run.joint("left_knee"));
  expect_fault(run, 1'100'000, Reason::kDriveFault);
  expect_emergency(run, State::kBoot, Reason::kDriveFault);
}

TEST(DriveHangs, InMotionTheOthersStop) {
  RobotRun run(with_fault(hanging_squat(), Kind::kDriveSilent, kInMotion_us, "left_knee"));
  ASSERT_TRUE(run.run_until(State::kFault, kInMotion_us + 61'000));
  EXPECT_EQ(run.behaviour().drive_fault, DriveFault::kLost);
  EXPECT_EQ(run.behaviour().faulty_joint, run.joint("left_knee"));
  // The motor of the hanging drive keeps its last torque until the drive-enable line falls.
  run.run_until_us(run.now_us() + kStop_us);
  EXPECT_EQ(run.torque_count(), 1);
  EXPECT_TRUE(run.board().electronics().drive_enable_line());
  expect_fault(run, kInMotion_us, Reason::kDriveFault);
  expect_emergency(run, State::kMotion, Reason::kDriveFault);
}

TEST(DriveLosesPower, InMotionTheOthersStop) {
  RobotRun run(with_fault(hanging_squat(), Kind::kDrivePowerLoss, kInMotion_us, "right_hip_pitch"));
  ASSERT_TRUE(run.run_until(State::kFault, kInMotion_us + 61'000));
  EXPECT_EQ(run.behaviour().drive_fault, DriveFault::kLost);
  EXPECT_EQ(run.behaviour().faulty_joint, run.joint("right_hip_pitch"));
  expect_fault(run, kInMotion_us, Reason::kDriveFault);
  expect_emergency(run, State::kMotion, Reason::kDriveFault);
}

// --- Reset

// At some of these times the drives' answers to the last SYNC are still on the bus when the command arrives.
TEST(Reset, IsProcessedInEachMillisecondOfTheCycle) {
  constexpr std::uint64_t kPeriod_us = 900'000;
  constexpr std::uint64_t kPhases = 10;
  simulation::Scenario scenario = hanging_squat();
  scenario.physics.stepper = sim_board::Stepper::kLumped;
  scenario.commands.clear();
  for (std::uint64_t i = 0; i < 2 * kPhases; ++i) {
    const std::uint64_t from_us = (1 + i) * kPeriod_us;
    if (i < kPhases) {
      scenario.faults.push_back({.at_us = from_us,
                                 .duration_us = 100'000,
                                 .kind = Kind::kControllerStop,
                                 .target = {},
                                 .frames = {},
                                 .babble = {}});
    } else {
      scenario.commands.push_back({.at_us = from_us, .kind = simulation::Command::Kind::kEmergencyStop});
    }
    const std::uint64_t phase_us = i % kPhases * 1'000;
    scenario.commands.push_back(
        {.at_us = from_us + 200'000 + phase_us, .kind = simulation::Command::Kind::kReset});
  }
  RobotRun run(scenario);
  for (std::uint64_t i = 0; i < 2 * kPhases; ++i) {
    SCOPED_TRACE(testing::Message() << (i < kPhases ? "fault, " : "emergency stop, ") << i % kPhases
                                    << " ms");
    run.run_until_us((1 + i) * kPeriod_us + 199'000);
    EXPECT_EQ(run.behaviour().state, i < kPhases ? State::kFault : State::kEmergencyStop);
    run.run_until_us((2 + i) * kPeriod_us - 1'000);
    EXPECT_EQ(run.behaviour().state, State::kLimp);
    EXPECT_EQ(run.behaviour().faults, std::min(i + 1, kPhases));
  }
}

// --- Sensors

TEST(InertialUnitStops, InMotion) {
  RobotRun run(with_fault(hanging_squat(), Kind::kImuStop, kInMotion_us));
  EXPECT_TRUE(run.run_until(State::kFault, kInMotion_us + 65'000));
  expect_fault(run, kInMotion_us, Reason::kImuSilent);
  expect_emergency(run, State::kMotion, Reason::kImuSilent);
}

TEST(InertialUnitStops, FromTheStart) {
  RobotRun run(with_fault(hanging_squat(), Kind::kImuStop, 0));
  ASSERT_TRUE(run.run_until(State::kFault, 600'000));
  expect_fault(run, 600'000, Reason::kImuSilent);
}

TEST(AnkleSensorStops, InMotion) {
  RobotRun run(with_fault(hanging_squat(), Kind::kAnkleStop, kInMotion_us));
  EXPECT_TRUE(run.run_until(State::kFault, kInMotion_us + 70'000));
  expect_fault(run, kInMotion_us, Reason::kAnkleSilent);
  expect_emergency(run, State::kMotion, Reason::kAnkleSilent);
}

// --- The bus

TEST(BusWithoutAcknowledgement, FromTheStart) {
  RobotRun run(with_fault(hanging_squat(), Kind::kBusUnacknowledged, 0));
  ASSERT_TRUE(run.run_until(State::kFault, 210'000));
  expect_fault(run, 210'000, Reason::kNoAcknowledge);
  EXPECT_TRUE(run.frames().empty());
}

TEST(BusWithoutAcknowledgement, InMotionTheDrivesStopAutonomously) {
  RobotRun run(with_fault(hanging_squat(), Kind::kBusUnacknowledged, kInMotion_us));
  ASSERT_TRUE(run.run_until(State::kFault, kInMotion_us + 30'000));
  run.run_until_us(kInMotion_us + 61'000);
  EXPECT_EQ(run.count_in(DriveState::kFaultReactionActive), 20);
  expect_fault(run, kInMotion_us, Reason::kNoAcknowledge);
  EXPECT_EQ(run.count_in(DriveState::kFault), 20);
}

// Each second, dozens of frames are lost, duplicated, delayed or retransmitted while the robot walks.
TEST(BadBus, DoesNotStopAWalkingRobot) {
  const std::vector<Override> faults{
      {"faults",
       "[{at_s: 2, kind: frames_lost, share: 0.01}, {at_s: 2, kind: frames_doubled, share: 0.01},"
       " {at_s: 2, kind: frames_corrupted, share: 0.02},"
       " {at_s: 2, kind: frames_delayed, share: 0.02, delay_ms: 3}]"},
      {"physics.stepper", "lumped"}};
  simulation::Scenario scenario =
      simulation::read_scenario(KOBOSHI_SOURCE_DIR "/scenarios/walk.yaml", faults);
  scenario.initial.release_us = kRelease_us;
  scenario.commands = {{.at_us = kEnable_us, .kind = simulation::Command::Kind::kEnable},
                       {.at_us = 2'000'000, .kind = simulation::Command::Kind::kPlay, .motion = 0}};
  RobotRun run(scenario);
  run.run_until_us(2'000'000);
  const Eigen::Vector3d start_W = run.board().world().body(0).X_WL.translation();
  run.run_until_us(6'000'000);
  const Eigen::Vector3d end_W = run.board().world().body(0).X_WL.translation();
  EXPECT_EQ(run.behaviour().state, State::kMotion);
  EXPECT_EQ(run.behaviour().faults, 0);
  EXPECT_EQ(run.torque_count(), 20);
  EXPECT_GT(end_W.x() - start_W.x(), 0.2);
  EXPECT_NEAR(end_W.z(), start_W.z(), 0.03);
  // At least one per cent of about 20 000 frames.
  EXPECT_GT(run.board().electronics().bus().usage().error_frames, 200u);
}

// --- Emergency stop

TEST(EmergencyStop, InMidSquatCutsAllTorqueAtOnce) {
  auto scenario = quick_squat();
  scenario.commands.push_back({.at_us = kMidSquat_us, .kind = simulation::Command::Kind::kEmergencyStop});
  RobotRun run(scenario);
  run.run_until_us(kMidSquat_us);
  ASSERT_EQ(run.torque_count(), 20);
  run.run_until_us(kMidSquat_us + 3'000);  // the frame, one service call and the drives' next loop
  EXPECT_EQ(run.behaviour().state, State::kEmergencyStop);
  EXPECT_EQ(run.torque_count(), 0);
  run.run_until_us(kMidSquat_us + 300'000);
  EXPECT_EQ(run.count_in(DriveState::kSwitchOnDisabled), 20);
  EXPECT_EQ(run.behaviour().faults, 0);
}

TEST(EmergencyStop, EndsByResetAndTheRobotEnablesAgain) {
  auto scenario = hanging_squat();
  using CommandKind = simulation::Command::Kind;
  scenario.commands.push_back({.at_us = 2'000'000, .kind = CommandKind::kEmergencyStop});
  scenario.commands.push_back({.at_us = 2'200'000, .kind = CommandKind::kEnable});
  scenario.commands.push_back({.at_us = 2'400'000, .kind = CommandKind::kReset});
  scenario.commands.push_back({.at_us = 3'400'000, .kind = CommandKind::kEnable});
  RobotRun run(scenario);
  run.run_until_us(2'400'000);
  EXPECT_EQ(run.behaviour().state, State::kEmergencyStop);
  EXPECT_EQ(run.behaviour().refusal, Reason::kNotInThisState);
  ASSERT_TRUE(run.run_until(State::kLimp, 3'400'000));
  EXPECT_TRUE(run.run_until(State::kStanding, 6'000'000));
  EXPECT_EQ(run.torque_count(), 20);
}

}  // namespace
}  // namespace koboshi::test
