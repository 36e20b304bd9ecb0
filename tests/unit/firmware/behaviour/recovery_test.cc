// A fall and getting up, state by state, without bus, board and sensors.

#include "firmware/behaviour/recovery.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/fixed/host/convert.h"
#include "hal/fake/storage.h"
#include "tests/support/factory_values.h"
#include "tests/support/robot_storage.h"
#include "tests/unit/firmware/robot/test_robot.h"

namespace koboshi::behaviour {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;  // in a degree
constexpr std::uint64_t kLater_us = 100'000;           // after a state began

// Each motion that the behaviour plays by itself: a move of 1 s.
std::vector<std::byte> storage_with_every_role() {
  const std::vector<std::byte> image = test::encode(test::make_test_robot());
  robot::RobotModel model;
  static_cast<void>(robot::load_model(image, model));
  std::vector<std::vector<std::byte>> motions;
  for (const std::string_view name : motion::kMotionNames) {
    std::vector<fixed::Angle> pose(model.joint_count);
    pose[test::kKnee] = test::degrees(10);
    motions.push_back(test::encode(
        test::TestMotion{.name = std::string(name),
                         .poses = {pose},
                         .steps = {{motion::Opcode::kMove, 0, 1'000'000}, {motion::Opcode::kEnd}}},
        model.id));
  }
  return test::make_storage(image, motions, test::encode(test::factory_values(), model.id));
}

class RecoveryStage : public testing::Test {
 protected:
  RecoveryStage() {
    flash.load(0, storage_with_every_role());
    catalogue.emplace(flash.contents());
    items.emplace(flash, storage::kRobotLogSize_bytes);
    static_cast<void>(robot::load_model(catalogue->find(storage::ItemKind::kRobotModel, 0), model));
    motions.load();
    drives.enabled = true;
    parameters.getting_up = {.attempts = 3, .slower = 20};
    lean(0, 0);
  }

  void lean(double roll_deg, double pitch_deg) {
    const double roll = roll_deg * kRadians;
    const double pitch = pitch_deg * kRadians;
    robot.roll = fixed::from_double<fixed::Angle>(roll);
    robot.pitch = fixed::from_double<fixed::Angle>(pitch);
    robot.up_B = {fixed::from_double<fixed::Ratio>(-std::sin(pitch)),
                  fixed::from_double<fixed::Ratio>(std::sin(roll) * std::cos(pitch)),
                  fixed::from_double<fixed::Ratio>(std::cos(roll) * std::cos(pitch))};
  }
  void shake() { robot.rates_B.x = fixed::from_double<fixed::AngularRate>(2.0); }
  std::optional<Recovery::Outcome> run(State state, std::uint64_t elapsed_us = 0) {
    return recovery.run(state, elapsed_us, cycle(), inputs(), targets());
  }
  Event event_of(State state, std::uint64_t elapsed_us = 0) {
    const auto outcome = run(state, elapsed_us);
    return outcome ? outcome->event : Event::kReady;
  }
  // Has lain still until an attempt begins.
  void begin_attempt() {
    recovery.begin_state();
    for (int i = 0; i < RestDetector::kCycles - 1; ++i) ASSERT_FALSE(run(State::kFallen, kLater_us));
    ASSERT_EQ(event_of(State::kFallen, kLater_us), Event::kStill);
  }
  void bend_hips(double degrees) {
    for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight})
      drives.angles[model.leg(side)[robot::kHipPitch]] = test::degrees(degrees);
  }

  Cycle cycle() { return {.robot = robot, .drives = drives, .network = network, .values = {}, .now_us = 0}; }
  motion::Inputs inputs() { return {.robot = robot, .angles = {drives.angles.data(), model.joint_count}}; }
  std::span<fixed::Angle> targets() { return {angles.data(), model.joint_count}; }

  robot::RobotModel model = test::make_test_robot();
  hal::FakeStorage flash;
  std::optional<storage::Catalogue> catalogue{std::in_place, std::span<const std::byte>()};
  std::optional<storage::ItemStore> items{std::in_place, flash, storage::kRobotLogSize_bytes};
  motion::MotionLibrary motions{*catalogue, *items, model};
  RecoveryParameters parameters = test::kTestRecovery;
  MotionPlayer player{model, motions, parameters};
  Recovery recovery{model, motions, player, parameters};
  estimation::RobotState robot;
  drive::DriveStatus drives;
  NetworkStatus network;
  std::array<fixed::Angle, robot::kMaxJoints> angles{};
};

TEST_F(RecoveryStage, TakesARobotThatStaysUpAndMovesForDownAfterATime) {
  lean(0, 40);
  shake();
  EXPECT_FALSE(run(State::kFalling, 1'499'999));
  EXPECT_EQ(event_of(State::kFalling, 1'500'000), Event::kDown);
}

TEST_F(RecoveryStage, TriesToGetUpAfterATimeAlthoughItIsMoved) {
  lean(0, 90);
  shake();
  EXPECT_FALSE(run(State::kFallen, 3'999'999));
  EXPECT_EQ(event_of(State::kFallen, 4'000'000), Event::kStill);
}

TEST_F(RecoveryStage, GetsUpAfterOneCycleIfItHasLainLimpAndStill) {
  recovery.begin_state();
  for (int i = 0; i < RestDetector::kCycles; ++i) recovery.watch_limp(robot);
  EXPECT_FALSE(run(State::kFallen, hal::kControlPeriod_us));  // shows in telemetry
  EXPECT_EQ(event_of(State::kFallen, hal::kControlPeriod_us + 1), Event::kStill);
}

TEST_F(RecoveryStage, WaitsUntilARobotThatWasMovedWhileLimpLiesStill) {
  recovery.begin_state();
  for (int i = 0; i < RestDetector::kCycles; ++i) recovery.watch_limp(robot);
  shake();
  recovery.watch_limp(robot);
  robot.rates_B.x = {};
  for (int i = 0; i < RestDetector::kCycles - 1; ++i) ASSERT_FALSE(run(State::kFallen, kLater_us));
  EXPECT_EQ(event_of(State::kFallen, kLater_us), Event::kStill);
}

TEST_F(RecoveryStage, GivesUpARiseThatSways) {
  shake();
  EXPECT_FALSE(run(State::kSteadying, 2'999'999));
  EXPECT_EQ(event_of(State::kSteadying, 3'000'000), Event::kRecoveryStepFailed);
}

TEST_F(RecoveryStage, FailsAfterItsLastAttempt) {
  for (int i = 0; i < 3; ++i) begin_attempt();
  EXPECT_EQ(recovery.attempts(), 3);
  recovery.begin_state();
  for (int i = 0; i < RestDetector::kCycles - 1; ++i) ASSERT_FALSE(run(State::kFallen, kLater_us));
  const auto outcome = run(State::kFallen, kLater_us);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->event, Event::kFailure);
  EXPECT_EQ(outcome->reason, Reason::kCannotGetUp);
}

TEST_F(RecoveryStage, StandsUpStraightWhereItIsHeldUpright) {
  begin_attempt();
  const auto outcome = run(State::kRighting);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->event, Event::kUpright);
  EXPECT_EQ(outcome->reason, Reason::kHeldUpright);
}

// It has just failed to rise: it is upright because it sits.
TEST_F(RecoveryStage, RisesFromItsSeatWhereItIsUprightAfterAFailedAttempt) {
  begin_attempt();
  begin_attempt();
  const auto outcome = run(State::kRighting);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->event, Event::kProneOrSupine);
  EXPECT_EQ(outcome->reason, Reason::kOnSeat);
}

// Thighs ahead of the trunk are a seat, thighs behind it are not: the hips' angles count with the sign of
// their axes.
TEST_F(RecoveryStage, TellsASeatByTheHips) {
  for (const auto sign : {1.0, -1.0}) {
    begin_attempt();
    recovery.forget_attempts();
    begin_attempt();
    const bool turns_forward = model.joints[model.leg(hal::Side::kLeft)[robot::kHipPitch]].axis.y.raw() < 0;
    bend_hips(sign * (turns_forward ? 80.0 : -80.0));
    const auto outcome = run(State::kRighting);
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->reason, sign > 0 ? Reason::kOnSeat : Reason::kHeldUpright) << sign;
    recovery.forget_attempts();
  }
}

TEST_F(RecoveryStage, RollsOnceInAnAttempt) {
  lean(90, 0);
  begin_attempt();
  EXPECT_EQ(event_of(State::kRighting), Event::kOnSide);
  EXPECT_EQ(event_of(State::kRighting), Event::kRecoveryStepFailed);
  begin_attempt();
  EXPECT_EQ(event_of(State::kRighting), Event::kOnSide);
}

// The first attempt at the motion's own pace, each further one slower, and none slower than 30 percent.
TEST_F(RecoveryStage, SlowsDownFromAttemptToAttempt) {
  parameters.getting_up = {.attempts = 9, .slower = 25};
  lean(0, 90);
  for (const int percent : {100, 75, 50, 30, 30}) {
    begin_attempt();
    EXPECT_EQ(event_of(State::kRighting), Event::kProneOrSupine);
    int cycles = 0;
    for (; player.running(); ++cycles) static_cast<void>(run(State::kRising));
    EXPECT_NEAR(cycles, 10'000.0 / percent, 2.0) << percent;
  }
}

}  // namespace
}  // namespace koboshi::behaviour
