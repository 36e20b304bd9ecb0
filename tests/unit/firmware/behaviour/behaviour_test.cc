// The second stage alone: takes a RobotState, the drives' signals and commands, returns a Decision. Uses no
// bus, board or sensors.

#include "firmware/behaviour/behaviour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "hal/fake/storage.h"
#include "tests/support/controller_bench.h"
#include "tests/support/factory_values.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::behaviour {
namespace {

// Motion indices in factory_storage and factory_storage_with_bend.
constexpr std::uint16_t kNod = 1;
constexpr std::uint16_t kBend = 2;
constexpr std::uint16_t kFails = 3;

class BehaviourStage : public testing::Test {
 protected:
  explicit BehaviourStage(bool model_valid = true,
                          const std::vector<std::byte>& storage = test::factory_storage())
      : behaviour(model, model_valid, motions,
                  {.power = power, .velocity_limits = limits, .walk = gait, .recovery = recovery}) {
    flash.load(0, storage);
    catalogue.emplace(flash.contents());
    items.emplace(flash, storage::kRobotLogSize_bytes);
    // Loads the model from its image, because motions refer to a model by its id.
    static_cast<void>(robot::load_model(catalogue->find(storage::ItemKind::kRobotModel, 0), model));
    motions.load();
    robot.inertial_age_us = 0;
    robot.ankle_age_us = {0, 0};
    robot.gyro_known = true;
    robot.accelerations_B.z = fixed::from_double<fixed::Acceleration>(9.80665);
    drives.limp = true;
    conditions.disabled = true;
    conditions.supply_mV.fill(7'400);
    behaviour.restart(true, now_us);
  }

  const Decision& step(int cycles = 1) {
    for (int i = 0; i < cycles; ++i)
      static_cast<void>(behaviour.step(
          {.robot = robot, .drives = drives, .network = network, .values = {}, .now_us = now_us += 10'000}));
    return behaviour.decision();
  }
  Reason request(Command command, std::int16_t argument = 0) {
    return behaviour.request(command, argument,
                             {.robot = robot, .drives = conditions, .values = {}, .now_us = now_us});
  }
  void boot() {
    drives.configured = drives.booted = true;
    step();
    ASSERT_EQ(behaviour.state(), State::kLimp);
  }
  void stand() {
    boot();
    ASSERT_EQ(request(Command::kEnable), Reason::kNone);
    conditions.disabled = drives.limp = false;
    drives.enabled = true;
    step(200);
    ASSERT_EQ(behaviour.state(), State::kStanding);
  }
  void lean(double pitch_rad) {
    robot.pitch = fixed::from_double<fixed::Angle>(pitch_rad);
    robot.up_B = {fixed::from_double<fixed::Ratio>(-std::sin(pitch_rad)),
                  {},
                  fixed::from_double<fixed::Ratio>(std::cos(pitch_rad))};
  }

  robot::RobotModel model = test::make_test_robot();
  hal::FakeStorage flash;
  std::optional<storage::Catalogue> catalogue{std::in_place, std::span<const std::byte>()};
  std::optional<storage::ItemStore> items{std::in_place, flash, storage::kRobotLogSize_bytes};
  motion::MotionLibrary motions{*catalogue, *items, model};
  PowerParameters power = test::kTestPower;
  walk::VelocityLimits limits = test::kTestVelocityLimits;
  walk::WalkParameters gait = test::tuned_gait();
  RecoveryParameters recovery = test::kTestRecovery;
  Behaviour behaviour;
  estimation::RobotState robot;
  drive::DriveStatus drives;
  drive::EnableConditions conditions;
  NetworkStatus network;
  std::uint64_t now_us = 0;
};

TEST_F(BehaviourStage, BootsLimpUntilDrivesAndSensorsAnswer) {
  EXPECT_EQ(behaviour.decision().boots, 1u);
  EXPECT_FALSE(step(3).drive_enable);
  EXPECT_EQ(behaviour.state(), State::kBoot);
  drives.booted = true;
  step();
  EXPECT_EQ(behaviour.state(), State::kLimp);
  EXPECT_FALSE(behaviour.decision().drive_enable);
}

TEST_F(BehaviourStage, EnablesStandsAndPlays) {
  stand();
  EXPECT_TRUE(step().drive_enable);
  EXPECT_EQ(step().goal, drive::Goal::kEnabled);
  EXPECT_EQ(step().feedback, balance::FeedbackMode::kStanding);
  EXPECT_EQ(request(Command::kPlay, kNod), Reason::kNone);
  EXPECT_EQ(step().feedback, balance::FeedbackMode::kMotion);
  const fixed::Angle before = behaviour.decision().targets[test::kHeadTilt];
  step(10);
  EXPECT_GT(behaviour.decision().targets[test::kHeadTilt], before);
}

TEST_F(BehaviourStage, HoldsTheJointsWhereTheyAreUntilItIsEnabled) {
  boot();
  drives.angles[test::kKnee] = test::degrees(33);
  EXPECT_EQ(step().targets[test::kKnee], test::degrees(33));
}

TEST_F(BehaviourStage, DoesNotWaitForARobotThatHasLainStill) {
  boot();
  lean(1.5);
  step(RestDetector::kCycles);
  EXPECT_EQ(request(Command::kGetUp), Reason::kNone);
  EXPECT_EQ(behaviour.state(), State::kFallen);
  step();
  EXPECT_EQ(behaviour.state(), State::kFallen);  // for a cycle, so that telemetry shows it
  step();
  EXPECT_EQ(behaviour.state(), State::kRighting);
}

TEST_F(BehaviourStage, StatesTheReasonOfARefusal) {
  EXPECT_EQ(request(Command::kEnable), Reason::kNotInThisState);
  boot();
  conditions.supply_mV[4] = 5'900;
  EXPECT_EQ(request(Command::kEnable), Reason::kSupplyOutOfRange);
  EXPECT_EQ(behaviour.status().refusal, Reason::kSupplyOutOfRange);
  conditions.supply_mV[4] = 7'400;
  conditions.beyond_limits = 1u << 2;
  EXPECT_EQ(request(Command::kEnable), Reason::kEncoderBeyondLimits);
  conditions.beyond_limits = 0;
  robot.accelerations_B = {};
  EXPECT_EQ(request(Command::kEnable), Reason::kImuImplausible);
  EXPECT_EQ(request(static_cast<Command>(77)), Reason::kUnknownCommand);
  EXPECT_EQ(behaviour.state(), State::kLimp);
}

TEST_F(BehaviourStage, DropsTheLineAtAnEmergencyStopBeforeTheNextCycle) {
  stand();
  EXPECT_EQ(request(Command::kEmergencyStop), Reason::kNone);
  EXPECT_FALSE(behaviour.decision().drive_enable);
  EXPECT_EQ(behaviour.decision().goal, drive::Goal::kTorqueOff);
}

TEST_F(BehaviourStage, ReportsAFaultOnceAndHoldsTheLineUntilTheDrivesHaveStopped) {
  stand();
  drives.fault = {.kind = drive::DriveFault::kLost, .joint = 7};
  const Decision& decision = step();
  ASSERT_TRUE(decision.fault);
  EXPECT_EQ(decision.fault->state, State::kStanding);
  EXPECT_EQ(decision.fault->reason, Reason::kDriveFault);
  EXPECT_EQ(decision.goal, drive::Goal::kQuickStop);
  EXPECT_TRUE(decision.drive_enable);
  drives.limp = true;
  EXPECT_FALSE(step().drive_enable);
  step(10);
  EXPECT_EQ(behaviour.status().faults, 1u);
}

TEST_F(BehaviourStage, ReportsALostSensorAfterFiftyMilliseconds) {
  boot();
  robot.ankle_age_us[1] = Behaviour::kSensorTimeout_us;
  step();
  EXPECT_EQ(behaviour.state(), State::kLimp);
  ++robot.ankle_age_us[1];
  step();
  EXPECT_EQ(behaviour.status().reason, Reason::kAnkleSilent);
}

TEST_F(BehaviourStage, PredictsAFall) {
  stand();
  step();
  lean(0.2);
  step(3);
  EXPECT_EQ(behaviour.state(), State::kStanding);
  robot.rates_B.y = fixed::from_double<fixed::AngularRate>(3.0);
  step(2);
  EXPECT_EQ(behaviour.state(), State::kFalling);
  EXPECT_EQ(behaviour.status().reason, Reason::kFallPredicted);
  EXPECT_EQ(behaviour.status().falls, 1u);
  lean(1.2);
  EXPECT_FALSE(step().drive_enable) << "it lies: limp";
  EXPECT_EQ(behaviour.state(), State::kFallen);
}

TEST_F(BehaviourStage, DoesNotUseAGyroWithoutBias) {
  robot.gyro_known = false;
  stand();
  lean(0.2);
  robot.rates_B.y = fixed::from_double<fixed::AngularRate>(3.0);
  step(10);
  EXPECT_EQ(behaviour.state(), State::kStanding);
}

TEST_F(BehaviourStage, KeepsTheLastVelocityThatIsWithinItsLimits) {
  EXPECT_EQ(behaviour.request_velocity({.forward_mm_per_s = 100}), Reason::kNone);
  EXPECT_EQ(behaviour.request_velocity({.forward_mm_per_s = 2'000}), Reason::kVelocityOutOfRange);
  EXPECT_EQ(behaviour.velocity().forward_mm_per_s, 100);
  EXPECT_EQ(behaviour.status().refusal, Reason::kVelocityOutOfRange);
}

TEST_F(BehaviourStage, RefusesATurnWithoutHipYaws) {
  EXPECT_EQ(behaviour.request_velocity({.forward_mm_per_s = 100, .turn_mrad_per_s = 100}), Reason::kNone);
  model.joints[*model.find(robot::JointRole::kRightHipYaw)].role = robot::JointRole::kOther;
  EXPECT_EQ(behaviour.request_velocity({.forward_mm_per_s = 50, .turn_mrad_per_s = 100}),
            Reason::kVelocityOutOfRange);
  EXPECT_EQ(behaviour.velocity().forward_mm_per_s, 100);
  EXPECT_EQ(behaviour.request_velocity({.forward_mm_per_s = 50}), Reason::kNone);
}

TEST_F(BehaviourStage, EndsALowBatteryOnlyWhenLimp) {
  stand();
  for (int i = 0; i < SupplyGuard::kReadings; ++i) {
    drives.new_supply_mV = 6'000;
    step();
  }
  EXPECT_TRUE(step().low_battery);
  EXPECT_EQ(request(Command::kPlay, kNod), Reason::kSupplyLow);
  EXPECT_EQ(request(Command::kLimp), Reason::kNone);
  EXPECT_FALSE(step().low_battery);
}

class WithoutAModel : public BehaviourStage {
 protected:
  WithoutAModel() : BehaviourStage(false) {}
};

TEST_F(WithoutAModel, EndsInAFault) {
  step();
  EXPECT_EQ(behaviour.status().reason, Reason::kModelInvalid);
}

// A robot that stands at a limit of 20 mm for its DCM, which is given from the middle of the feet.
class PushedRobot : public BehaviourStage {
 protected:
  PushedRobot() : BehaviourStage(true, test::factory_storage_with_bend()) {
    gait.reaction.max_standing_dcm = 200;
  }
  void SetUp() override { stand(); }
  State pushed(double dcm_x_m, double dcm_y_m, double moving_m) {
    const auto length = [](double value_m) { return fixed::from_double<fixed::Length>(value_m); };
    const double zmp_m = 1e-4 * gait.posture.zmp_forward;
    const double half_width_m = 0.5e-4 * gait.step.width;
    robot.com.valid = true;
    robot.com.sole = hal::Side::kLeft;
    robot.contacts[hal::Side::kLeft].touches = !hangs;
    robot.com.dcm = {length(zmp_m + dcm_x_m), length(dcm_y_m - half_width_m)};
    robot.com.position = {length(zmp_m + dcm_x_m - moving_m), length(dcm_y_m - half_width_m)};
    step();
    return behaviour.state();
  }

  bool hangs = false;
};

TEST_F(PushedRobot, TakesStepsUntilItStandsAgain) {
  EXPECT_EQ(pushed(0.019, 0.0, 0.019), State::kStanding);
  EXPECT_EQ(pushed(0.021, 0.0, 0.021), State::kWalking);
  EXPECT_EQ(behaviour.status().reason, Reason::kPushed);
  EXPECT_EQ(step().feedback, balance::FeedbackMode::kWalking);
  robot.com.valid = false;
  step(400);
  EXPECT_EQ(behaviour.state(), State::kStanding);
  EXPECT_EQ(behaviour.status().reason, Reason::kProgress);
}

TEST_F(PushedRobot, TakesThemBackwardsAsWell) {
  EXPECT_EQ(pushed(-0.019, 0.0, -0.019), State::kStanding);
  EXPECT_EQ(pushed(-0.021, 0.0, -0.021), State::kWalking);
}

TEST_F(PushedRobot, StandsOnASlopeOnWhichItsCentreOfMassIsOff) {
  EXPECT_EQ(pushed(0.03, 0.0, 0.009), State::kStanding);
  EXPECT_EQ(pushed(-0.03, 0.0, 0.03), State::kStanding) << "it returns by itself";
  EXPECT_EQ(pushed(0.03, 0.0, 0.011), State::kWalking);
}

TEST_F(PushedRobot, StandsWhenItIsPushedToTheSide) {
  EXPECT_EQ(pushed(0.021, 0.043, 0.021), State::kStanding);
  EXPECT_EQ(pushed(0.021, -0.043, 0.021), State::kStanding);
  EXPECT_EQ(pushed(0.021, 0.041, 0.021), State::kWalking);
}

// The foot on that side bears the robot already, and the other one is free.
TEST_F(PushedRobot, StandsOnTheFootToWhichItIsPushed) {
  for (const auto& [aside_m, side] : {std::pair{0.01, hal::Side::kLeft}, {-0.01, hal::Side::kRight}}) {
    ASSERT_EQ(pushed(0.03, aside_m, 0.03), State::kWalking);
    robot.com.valid = false;
    while (!step().support) ASSERT_EQ(behaviour.state(), State::kWalking);
    EXPECT_EQ(behaviour.decision().support, side);
    step(400);
    ASSERT_EQ(behaviour.state(), State::kStanding);
  }
}

TEST_F(PushedRobot, TakesNoStepThatAWalkCouldNot) {
  robot.gyro_known = false;
  EXPECT_EQ(pushed(0.03, 0.0, 0.03), State::kStanding);
  robot.gyro_known = true;
  gait.reaction.max_standing_dcm = 0;
  EXPECT_EQ(pushed(0.03, 0.0, 0.03), State::kStanding);
  gait.reaction.max_standing_dcm = 200;
  gait.step.time_ms = 0;
  EXPECT_EQ(pushed(0.03, 0.0, 0.03), State::kStanding) << "without a gait";
}

TEST_F(PushedRobot, TakesNoStepFromAnotherPose) {
  ASSERT_EQ(request(Command::kPlay, kBend), Reason::kNone);
  while (behaviour.state() != State::kStanding) step();
  EXPECT_EQ(pushed(0.03, 0.0, 0.03), State::kStanding);
}

TEST_F(PushedRobot, SaysWhetherAMotionHasFailed) {
  for (const auto& [motion, reason] :
       {std::pair{kBend, Reason::kProgress}, {kFails, Reason::kMotionFailed}, {kBend, Reason::kProgress}}) {
    ASSERT_EQ(request(Command::kPlay, static_cast<std::int16_t>(motion)), Reason::kNone);
    while (behaviour.state() != State::kStanding) step();
    EXPECT_EQ(behaviour.status().reason, reason) << motion;
  }
}

TEST_F(PushedRobot, TakesNoStepInTheAir) {
  hangs = true;
  EXPECT_EQ(pushed(0.03, 0.0, 0.03), State::kStanding);
  hangs = false;
  EXPECT_EQ(pushed(0.03, 0.0, 0.03), State::kWalking);
}

// However late the command comes: in the closing step and afterwards, too.
TEST_F(PushedRobot, WalksOnWhenItIsCommandedTo) {
  for (int delay = 0;; delay += 10) {
    ASSERT_EQ(pushed(0.03, 0.0, 0.03), State::kWalking);
    robot.com.valid = false;
    step(delay);
    if (behaviour.state() != State::kWalking) {
      EXPECT_GT(delay, 100);
      return;
    }
    EXPECT_EQ(request(Command::kWalk), Reason::kNone);
    step(400);
    EXPECT_EQ(behaviour.state(), State::kWalking) << delay;
    EXPECT_EQ(request(Command::kStop), Reason::kNone);
    step(400);
    ASSERT_EQ(behaviour.state(), State::kStanding);
  }
}

TEST_F(PushedRobot, DoesNotWalkOnWithoutWhatAWalkNeeds) {
  ASSERT_EQ(pushed(0.03, 0.0, 0.03), State::kWalking);
  robot.com.valid = false;
  while (step().planned_zmp) ASSERT_EQ(behaviour.state(), State::kWalking);  // settles
  ASSERT_EQ(request(Command::kWalk), Reason::kNone);
  robot.gyro_known = false;
  step(400);
  EXPECT_EQ(behaviour.state(), State::kStanding);
}

}  // namespace
}  // namespace koboshi::behaviour
