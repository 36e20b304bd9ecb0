// Two motions at once, on a fake board.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/controller_bench.h"
#include "tests/support/factory_values.h"
#include "tests/support/robot_storage.h"
#include "tests/support/sdo_pc.h"

namespace koboshi::app {
namespace {

using enum motion::Opcode;
using motion::Condition;
using motion::Interpolation;
using motion::Source;
using test::ControllerBench;
using test::kHeadTilt;
using test::kKnee;
using test::MotionBuilder;

constexpr std::size_t kHeadPan = 18;
constexpr std::int16_t kBend = 1;   // bends the knee to and fro until stopped
constexpr std::int16_t kNod = 2;    // tilts the head and holds it for 0.2 s
constexpr std::int16_t kShake = 3;  // pans the head to and fro until stopped
constexpr std::int16_t kObey = 4;   // tilts the head when the second input exceeds 1000
constexpr std::int16_t kBow = 5;    // declares a lean of 20 degrees, tilts the head and waits
constexpr std::uint8_t kNone = behaviour::Status::kNoOverlay;

constexpr std::int16_t kTwentyDegrees = 3'641;

class OverlayTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::vector<std::byte> model_image = test::encode(test::make_test_robot());
    const robot::RobotModel& model = bench.model();
    const auto image = [&](const char* name, MotionBuilder builder) {
      builder.name = name;
      return builder.image();
    };
    const auto to_and_fro = [&](std::size_t joint) {
      return MotionBuilder(model)
          .pose(joint, 30)
          .pose(joint, 0)
          .step(kLoopBegin, 0)
          .step(kMove, 0, 200'000)
          .step(kMove, 1, 200'000)
          .step(kLoopEnd, 0)
          .step(kEnd);
    };
    const std::vector<std::vector<std::byte>> motions{
        image("stand", MotionBuilder(model).pose(kKnee, 40).step(kMove, 0, 500'000).step(kEnd)),
        image("bend", to_and_fro(kKnee)),
        image("nod", MotionBuilder(model)
                         .pose(kHeadTilt, 20)
                         .step(kMove, 0, 200'000)
                         .step(kWait, 0, 200'000)
                         .step(kEnd)),
        image("shake", to_and_fro(kHeadPan)),
        image("obey",
              MotionBuilder(model)
                  .pose(kHeadTilt, 20)
                  .step(Condition{}.await(motion::kNoStep, 60'000'000))
                  .step(motion::Test{{Source::kInput, 1}, motion::Comparison::kGreater, false, 1'000}.step())
                  .step(kMove, 0, 50'000)
                  .step(kWait, 0, 10'000'000)
                  .step(kEnd)),
        image("lean", MotionBuilder(model)
                          .pose(kHeadTilt, 20)
                          .step(motion::LeanDeclaration{kTwentyDegrees, 0}.step())
                          .step(kMove, 0, 200'000)
                          .step(kWait, 0, 10'000'000)
                          .step(kEnd)),
    };
    bench.restart(test::make_storage(model_image, motions, test::encode(test::factory_values(), model.id)));
    ASSERT_TRUE(bench.run_until_ready_to_walk());
  }
  Reason play(std::int16_t number) {
    bench.command(Command::kPlay, number);
    return bench.now().refusal;
  }
  // Turns the trunk forward to this pitch in 0.4 s, with consistent readings of gyro and accelerometer.
  void pitch_to(double pitch_deg) {
    const double pitch_rad = pitch_deg * test::kRadPerDegree;
    bench.imu_sample.gyro_raw[1] = static_cast<std::int16_t>(pitch_rad / 0.4 * test::kCountsPerRadPerS);
    bench.run_ms(400);
    bench.imu_sample.gyro_raw = {};
    bench.imu_sample.accelerometer_raw = {static_cast<std::int16_t>(-std::sin(pitch_rad) * test::kCountsPerG),
                                          0,
                                          static_cast<std::int16_t>(std::cos(pitch_rad) * test::kCountsPerG)};
  }
  double target_deg(std::size_t joint) const {
    return fixed::to_double(bench.target(joint)) / test::kRadPerDegree;
  }

  ControllerBench bench;
  test::SdoPc pc{bench};
};

TEST_F(OverlayTest, PlaysBesideAMotionOnOtherJoints) {
  ASSERT_EQ(play(kBend), Reason::kNone);
  EXPECT_EQ(bench.now().overlay, kNone);
  ASSERT_EQ(play(kNod), Reason::kNone);
  bench.run_ms(210);
  EXPECT_EQ(bench.now().state, State::kMotion);
  EXPECT_EQ(bench.now().motion, kBend);
  EXPECT_EQ(bench.now().overlay, kNod);
  EXPECT_NEAR(target_deg(kHeadTilt), 20, 0.01);
  double highest_deg = 0;
  double lowest_deg = 90;
  for (int i = 0; i < 40; ++i) {
    bench.run_ms(10);
    highest_deg = std::max(highest_deg, target_deg(kKnee));
    lowest_deg = std::min(lowest_deg, target_deg(kKnee));
  }
  EXPECT_NEAR(highest_deg, 30, 0.01);
  EXPECT_NEAR(lowest_deg, 0, 0.01);
}

TEST_F(OverlayTest, ReturnsToTheFirstLayerWithinHalfASecondWithoutAJump) {
  ASSERT_EQ(play(kBend), Reason::kNone);
  ASSERT_EQ(play(kNod), Reason::kNone);
  bench.run_ms(400);
  double before_deg = target_deg(kHeadTilt);
  for (int i = 0; i < 55; ++i) {
    bench.run_ms(10);
    EXPECT_LE(std::abs(target_deg(kHeadTilt) - before_deg), 20.0 / 50 + 0.01);
    before_deg = target_deg(kHeadTilt);
  }
  EXPECT_EQ(target_deg(kHeadTilt), 0);
  EXPECT_EQ(bench.now().overlay, kNone);
  EXPECT_EQ(play(kShake), Reason::kNone);
}

TEST_F(OverlayTest, IsRefusedOnJointsInUse) {
  ASSERT_EQ(play(kNod), Reason::kNone);
  EXPECT_EQ(play(kObey), Reason::kJointsInUse);
  ASSERT_EQ(play(kShake), Reason::kNone);
  EXPECT_EQ(play(kBend), Reason::kNotInThisState);  // there are two already
  ASSERT_TRUE(bench.run_until(State::kStanding, 500));
  EXPECT_EQ(play(kShake), Reason::kJointsInUse);
  bench.run_ms(20);
  EXPECT_EQ(play(kBend), Reason::kNone);
}

TEST_F(OverlayTest, StopEndsBoth) {
  ASSERT_EQ(play(kBend), Reason::kNone);
  ASSERT_EQ(play(kShake), Reason::kNone);
  bench.run_ms(100);
  bench.command(Command::kStop);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  bench.run_ms(500);
  EXPECT_EQ(bench.now().state, State::kStanding);
  EXPECT_EQ(bench.now().overlay, kNone);
}

TEST_F(OverlayTest, GoesOnInStandingUntilItIsStopped) {
  ASSERT_EQ(play(kNod), Reason::kNone);
  ASSERT_EQ(play(kShake), Reason::kNone);
  ASSERT_TRUE(bench.run_until(State::kStanding, 500));
  bench.run_ms(1'000);
  EXPECT_EQ(bench.now().overlay, kShake);
  bench.command(Command::kStop);
  EXPECT_EQ(bench.now().refusal, Reason::kNone);
  bench.run_ms(1'000);
  EXPECT_EQ(bench.now().overlay, kNone);
  EXPECT_NEAR(target_deg(kHeadPan), 0, 0.01);
  EXPECT_NEAR(target_deg(kHeadTilt), 20, 0.01) << "the end of the first motion";
  bench.command(Command::kStop);
  EXPECT_EQ(bench.now().refusal, Reason::kNotInThisState);
}

// A motion or a walk that starts below an overlay takes the first layer's angles of its joints, not the
// overlay's.
TEST_F(OverlayTest, DoesNotLeaveItsAnglesToTheFirstLayer) {
  for (const Command begins : {Command::kPlay, Command::kWalk}) {
    ASSERT_EQ(play(kNod), Reason::kNone);
    ASSERT_EQ(play(kShake), Reason::kNone);
    ASSERT_TRUE(bench.run_until(State::kStanding, 500));
    for (int i = 0; i < 40 && target_deg(kHeadPan) < 10; ++i) bench.run_ms(10);
    ASSERT_GE(target_deg(kHeadPan), 10);
    bench.command(begins, kNod);
    ASSERT_EQ(bench.now().refusal, Reason::kNone);
    bench.run_ms(500);
    bench.command(Command::kStop);
    bench.run_ms(3'000);
    EXPECT_EQ(bench.now().state, State::kStanding);
    EXPECT_EQ(bench.now().overlay, kNone);
    EXPECT_NEAR(target_deg(kHeadPan), 0, 0.01);
  }
}

TEST_F(OverlayTest, PlaysBesideTheWalkUnlessItMovesTheLegs) {
  bench.command(Command::kWalk);
  ASSERT_EQ(bench.now().state, State::kWalking);
  EXPECT_EQ(play(kBend), Reason::kJointsInUse);
  ASSERT_EQ(play(kNod), Reason::kNone);
  bench.run_ms(250);
  EXPECT_EQ(bench.now().state, State::kWalking);
  EXPECT_NEAR(target_deg(kHeadTilt), 20, 0.01);
}

// Only the first layer moves the legs: the robot does not lean because an overlay says so.
TEST_F(OverlayTest, DoesNotMoveTheFallDetectorByItsLean) {
  ASSERT_EQ(pc.write({0x2140, 7}, kTwentyDegrees, 2), canopen::AbortCode::kNone);
  ASSERT_EQ(play(kBend), Reason::kNone);
  ASSERT_EQ(play(kBow), Reason::kNone);
  bench.run_ms(600);
  ASSERT_EQ(bench.now().overlay, kBow);
  pitch_to(32);
  EXPECT_EQ(bench.now().state, State::kFalling);
}

TEST_F(OverlayTest, MovesTheFallDetectorByTheLeanOfTheFirstLayer) {
  ASSERT_EQ(pc.write({0x2140, 7}, kTwentyDegrees, 2), canopen::AbortCode::kNone);
  ASSERT_EQ(play(kBow), Reason::kNone);
  ASSERT_EQ(play(kBend), Reason::kNone);
  bench.run_ms(600);
  ASSERT_EQ(bench.now().overlay, kBend);
  pitch_to(32);
  EXPECT_EQ(bench.now().state, State::kMotion);
}

TEST_F(OverlayTest, LimpEndsBothAtOnce) {
  ASSERT_EQ(play(kBend), Reason::kNone);
  ASSERT_EQ(play(kShake), Reason::kNone);
  bench.run_ms(100);
  bench.command(Command::kLimp);
  EXPECT_EQ(bench.now().overlay, kNone);
}

TEST_F(OverlayTest, ReadsInputsThatAMasterWrites) {
  ASSERT_EQ(play(kObey), Reason::kNone);
  bench.run_ms(200);
  EXPECT_NEAR(target_deg(kHeadTilt), 0, 0.01);
  hal::CanFrame frame{.identifier = 0x401, .size = 8};
  frame.data = {0, 0, 0xE9, 0x03, 0, 0, 0, 0};  // the second input: 1001
  bench.board.can.deliver(frame);
  bench.run_ms(80);
  EXPECT_NEAR(target_deg(kHeadTilt), 20, 0.01);
}

TEST_F(OverlayTest, ReadsInputsThatAreWrittenBySdo) {
  ASSERT_EQ(play(kObey), Reason::kNone);
  ASSERT_EQ(pc.write({kMotionInputObject, 2}, 1'001, 2), canopen::AbortCode::kNone);
  bench.run_ms(80);
  EXPECT_NEAR(target_deg(kHeadTilt), 20, 0.01);
}

}  // namespace
}  // namespace koboshi::app
