#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/fixed/host/convert.h"
#include "firmware/motion/interpreter.h"
#include "firmware/robot/kinematics.h"
#include "firmware/walk/gait.h"
#include "sim_board/description/load.h"
#include "simulation/motion_language/compile/compile.h"
#include "tests/support/tuned_gait.h"

// Checks the motions of robots/koboshi against their comments.
namespace koboshi::simulation {
namespace {

using fixed::to_double;

constexpr const char* kRobotFolder = KOBOSHI_SOURCE_DIR "/robots/koboshi/";

// An image stores angles in units of 2^-14 turn.
constexpr double kPoseTolerance_rad = std::numbers::pi / (1 << motion::kPoseBits);

class KoboshiMotionsTest : public testing::Test {
 protected:
  void start(const std::string& name) {
    image_ = compile_motion(std::filesystem::path(kRobotFolder) / "motions" / (name + ".yaml"), named_);
    motion::Motion motion;
    ASSERT_TRUE(motion::Motion::open(image_, named_.model, motion).ok());
    interpreter_.start(motion, interpreter_.targets(), inputs_);
  }

  void advance(std::uint32_t time_us) {
    for (std::uint32_t passed_us = 0; passed_us < time_us; passed_us += 10'000)
      interpreter_.advance(10'000, inputs_);
    forward_kinematics(named_.model, interpreter_.targets(), X_BLinks_);
  }

  robot::Pose sole(hal::Side side) const { return sole_pose(named_.model, side, X_BLinks_); }
  double base_above_ankle_m() const {
    return -to_double(sole(hal::Side::kLeft).p.z) - to_double(named_.model.feet[0].ankle_height);
  }
  double centre_of_mass_ahead_of_ankle_m() const {
    return to_double(centre_of_mass(named_.model, X_BLinks_).x - sole(hal::Side::kLeft).p.x);
  }

  const NamedModel named_ = load_named_model(sim_board::load_robot(std::string(kRobotFolder) + "robot.sdf"));
  const estimation::RobotState state_;
  const motion::Inputs inputs_{.robot = state_};
  motion::Interpreter interpreter_{named_.model};
  std::vector<std::byte> image_;
  robot::LinkPoses X_BLinks_;
};

TEST_F(KoboshiMotionsTest, StandIsUprightWithTheStepWidthOfItsGait) {
  start("stand");
  advance(2'000'000);
  EXPECT_FALSE(interpreter_.running());
  EXPECT_NEAR(base_above_ankle_m(), 0.1197, 1e-4);
  EXPECT_NEAR(centre_of_mass_ahead_of_ankle_m(), 0.012, 2e-4) << "the middle of the feet";
  const robot::Pose left = sole(hal::Side::kLeft);
  EXPECT_NEAR(to_double(left.R.rows[0].z), 0.0, 2e-4);
  EXPECT_NEAR(to_double(left.R.rows[1].z), 0.0, 2e-4);
  const double width_m = 1e-4 * test::tuned_gait().step.width;
  EXPECT_NEAR(to_double(left.p.y - sole(hal::Side::kRight).p.y), width_m, 1e-3);
}

TEST_F(KoboshiMotionsTest, SquatGoesUpAndDownAsARaisedCosineOnFlatFeet) {
  start("squat");
  advance(2'000'000);
  for (int point = 0; point <= 60; ++point) {  // three repetitions, at the poses
    const double expected_m = 0.105 + 0.015 * std::cos(std::numbers::pi * point / 10.0);
    ASSERT_NEAR(base_above_ankle_m(), expected_m, 1e-4) << point;
    ASSERT_NEAR(centre_of_mass_ahead_of_ankle_m(), 0.012, 2e-4) << point;
    const robot::Pose left = sole(hal::Side::kLeft);
    const robot::Pose right = sole(hal::Side::kRight);
    ASSERT_NEAR(to_double(left.R.rows[0].z), 0.0, 2e-4 + 3 * kPoseTolerance_rad)
        << "the sole is level to 0.01 degrees and the rounding of hip, knee and ankle";
    ASSERT_NEAR(to_double(left.p.x - right.p.x), 0.0, 1e-6);
    ASSERT_NEAR(to_double(left.p.y - right.p.y), 0.06, 1e-6);
    advance(100'000);
  }
}

TEST_F(KoboshiMotionsTest, SquatStaysNearTheCosineBetweenItsPoses) {
  start("squat");
  advance(2'000'000);
  for (int tick = 0; tick <= 400; ++tick) {
    const double expected_m = 0.105 + 0.015 * std::cos(std::numbers::pi * tick / 100.0);
    ASSERT_NEAR(base_above_ankle_m(), expected_m, 4e-4) << tick;
    advance(10'000);
  }
}

TEST_F(KoboshiMotionsTest, SquatEndsInItsStandWhenStopped) {
  start("squat");
  advance(5'000'000);
  interpreter_.stop();
  advance(3'000'000);
  EXPECT_FALSE(interpreter_.running());
  EXPECT_NEAR(base_above_ankle_m(), 0.120, 1e-4);
}

TEST_F(KoboshiMotionsTest, WaveEndsInItsStandWithTheArmBack) {
  start("wave");
  advance(2'500'000);
  const robot::Position hand = X_BLinks_[*named_.model.find(robot::JointRole::kRightElbow)].p;
  const robot::Position shoulder = X_BLinks_[*named_.model.find(robot::JointRole::kRightShoulderRoll)].p;
  EXPECT_GT(to_double(hand.z - shoulder.z), 0.03) << "the elbow is above the shoulder";
  advance(4'000'000);
  EXPECT_FALSE(interpreter_.running());
  EXPECT_NEAR(to_double(interpreter_.targets()[*named_.model.find(robot::JointRole::kRightShoulderRoll)]),
              -8.0 * std::numbers::pi / 180.0, kPoseTolerance_rad);
}

}  // namespace
}  // namespace koboshi::simulation
