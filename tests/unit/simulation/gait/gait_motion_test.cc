#include "simulation/gait/gait_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/text/error.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/robot/kinematics.h"
#include "sim_board/description/load.h"
#include "simulation/gait/walking_pose.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"
#include "tests/unit/base/scratch_file.h"

namespace koboshi::simulation {
namespace {

using fixed::to_double;

class GaitMotionTest : public testing::Test {
 protected:
  // Returns the poses of links and soles in the trunk's frame.
  robot::LinkPoses links(const std::vector<double>& angles_rad) const {
    std::vector<fixed::Angle> angles;
    for (const double angle : angles_rad) angles.push_back(fixed::from_double<fixed::Angle>(angle));
    robot::LinkPoses X_BLinks;
    forward_kinematics(model_.model, angles, X_BLinks);
    return X_BLinks;
  }

  const sim_board::RobotDescription robot_ =
      sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
  const NamedModel model_ = load_named_model(robot_);
  Gait gait_ = read_gait(KOBOSHI_SOURCE_DIR "/robots/koboshi/gait.yaml");
};

// Uses the firmware's forward kinematics and centre of mass, which are independent of the code that made the
// poses.
TEST_F(GaitMotionTest, PlacesCentreOfMassAndSolesAsPlanned) {
  gait_.sag_compensation = 0.0;
  gait_.trunk_pitch_rad = 0.0;
  const GaitPlan plan(gait_);
  const WalkingPose pose(gait_, robot_, model_);
  for (double t = 0.0; t < plan.start_s() + plan.cycle_s(); t += 0.031) {
    const GaitInstant now = plan.at(t);
    const robot::LinkPoses X_BLinks = links(pose.targets_rad(now));
    const robot::Position com = centre_of_mass(model_.model, X_BLinks);
    for (const hal::Side side : {hal::Side::kLeft, hal::Side::kRight}) {
      const robot::Position sole = sole_pose(model_.model, side, X_BLinks).p;
      const Eigen::Vector3d planned = now.X_WSole[static_cast<std::size_t>(side)].translation();
      EXPECT_NEAR(to_double(com.x - sole.x), now.com_W_m.x() - planned.x(), 5e-5) << t;
      EXPECT_NEAR(to_double(com.y - sole.y), now.com_W_m.y() - planned.y(), 5e-5) << t;
      EXPECT_NEAR(to_double(com.z - sole.z), gait_.com_height_m - planned.z(), 5e-5) << t;
    }
  }
}

TEST_F(GaitMotionTest, CompensatesTheSagOfTheSupportLegOnly) {
  const GaitPlan plan(gait_);
  gait_.sag_compensation = 0.0;
  const std::vector<double> without = WalkingPose(gait_, robot_, model_).targets_rad(plan.at(0.0));
  gait_.sag_compensation = 1.0;
  const std::vector<double> with = WalkingPose(gait_, robot_, model_).targets_rad(plan.at(0.0));
  const auto change = [&](robot::JointRole role) {
    const std::size_t joint = *model_.model.find(role);
    return with[joint] - without[joint];
  };
  // A loaded knee yields, so its target must be a straighter leg.
  EXPECT_LT(change(robot::JointRole::kLeftKnee), -1e-3);
  EXPECT_NEAR(change(robot::JointRole::kLeftKnee), change(robot::JointRole::kRightKnee), 1e-9);
  EXPECT_EQ(change(robot::JointRole::kLeftElbow), 0.0);
}

TEST_F(GaitMotionTest, DividesTheCycleIntoTheRequestedPoints) {
  for (const int points : {4, 7, 8, 16}) {
    gait_.points = points;
    const double slowly = points < 8 ? 1.0 : 0.0;
    gait_.period_s = 0.8 + slowly;
    const MotionSource motion = make_gait_motion(gait_, robot_, model_);
    const auto loop = std::ranges::find(motion.steps, StepSource::Kind::kLoop, &StepSource::kind);
    ASSERT_NE(loop, motion.steps.end());
    EXPECT_EQ(loop->body.size(), static_cast<std::size_t>(points));
    std::uint32_t cycle_us = 0;
    for (const StepSource& step : loop->body) cycle_us += step.time_us;
    EXPECT_EQ(cycle_us, static_cast<std::uint32_t>(std::lround(1e6 * gait_.period_s)));
    EXPECT_FALSE(compile_motion(motion, model_).empty());
  }
}

TEST_F(GaitMotionTest, WritesTheMotionFile) {
  const MotionSource motion = make_gait_motion(gait_, robot_, model_);
  const ScratchFile file("walk.yaml", gait_motion_text(motion, model_));
  EXPECT_EQ(compile_motion(file.path(), model_), compile_motion(motion, model_));
}

TEST_F(GaitMotionTest, RejectsTargetsOutOfReach) {
  gait_.com_height_m = 0.26;
  EXPECT_THROW(static_cast<void>(make_gait_motion(gait_, robot_, model_)), InputError);
}

TEST_F(GaitMotionTest, RejectsAJointThatTheRobotLacks) {
  gait_.upper_body.push_back({"tail", 7, 0.1});
  EXPECT_THROW(static_cast<void>(make_gait_motion(gait_, robot_, model_)), InputError);
}

}  // namespace
}  // namespace koboshi::simulation
