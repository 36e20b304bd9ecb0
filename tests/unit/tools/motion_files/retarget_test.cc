#include "tools/motion_files/retarget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "base/text/error.h"
#include "sim_board/description/load.h"
#include "simulation/motion_language/parse/parse.h"
#include "tools/motion_files/convert.h"
#include "tools/motion_files/flatten.h"

namespace koboshi::tools {
namespace {

using testing::HasSubstr;

class RetargetTest : public testing::Test {
 protected:
  std::size_t joint(const sim_board::RobotDescription& robot, const std::string& name) const {
    return static_cast<std::size_t>(*robot.find_joint(name));
  }
  ForeignMotion frames() const {
    const std::string text =
        "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {left_knee: 20, right_knee: 30, head_pan: 10}\n"
        "steps:\n  - {pose: p, time_s: 1}\n";
    const simulation::MotionFile file = simulation::read_motion_text("a.yaml", text);
    simulation::Diagnostics messages(file.path, file.text);
    ForeignMotion motion = flatten_motion(simulation::parse_motion(file, model, messages), model);
    motion.format = MotionFormat::kOwn;
    return motion;
  }
  const sim_board::RobotDescription from =
      sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/koboshi/robot.sdf");
  const simulation::NamedModel model = simulation::load_named_model(from);
  sim_board::RobotDescription to = from;
};

TEST_F(RetargetTest, FindsJointsByRoleAndTurnsThemByTheirAxes) {
  const std::size_t knee = joint(to, "left_knee");
  to.joints[knee].name = "l_leg_kny";
  to.joints[knee].stated_role = "left_knee";
  to.joints[knee].axis_M = -to.joints[knee].axis_M;
  std::swap(to.joints[joint(to, "head_pan")], to.joints[joint(to, "left_hip_yaw")]);
  const JointMap map = retarget_joints("a.yaml", frames(), from, to);
  EXPECT_EQ(map.joints[joint(from, "left_knee")]->joint, knee);
  EXPECT_EQ(map.joints[joint(from, "left_knee")]->sign, -1.0);
  EXPECT_EQ(map.joints[joint(from, "right_knee")]->sign, 1.0);
  EXPECT_EQ(map.joints[joint(from, "head_pan")]->joint, joint(from, "left_hip_yaw"));
  ASSERT_EQ(map.notes.size(), 1u);
  EXPECT_THAT(map.notes[0].text, HasSubstr("turn the other way in koboshi: left_knee"));
}

TEST_F(RetargetTest, IsTheIdentityForTheSameRobot) {
  const ConvertedMotion result =
      convert_motion("a.yaml", frames(), retarget_joints("a.yaml", frames(), from, to), model, {});
  EXPECT_THAT(result.text, HasSubstr("p1: {left_knee: 20, right_knee: 30, head_pan: 10}"));
  EXPECT_EQ(result.clamped, 0u);
}

TEST_F(RetargetTest, DropsTheHeadButNoLeg) {
  to.joints[joint(to, "head_pan")].stated_role = "antenna";
  const JointMap map = retarget_joints("a.yaml", frames(), from, to);
  EXPECT_FALSE(map.joints[joint(from, "head_pan")].has_value());
  ASSERT_EQ(map.notes.size(), 1u);
  EXPECT_THAT(map.notes[0].text, HasSubstr("dropped, because koboshi has none of this role: head_pan"));
  to.joints[joint(to, "left_knee")].stated_role = "tail";
  EXPECT_THROW(static_cast<void>(retarget_joints("a.yaml", frames(), from, to)), InputError);
}

TEST_F(RetargetTest, RefusesAxesOfAnotherDirection) {
  to.joints[joint(to, "right_knee")].axis_M = Eigen::Vector3d::UnitZ();
  EXPECT_THROW(static_cast<void>(retarget_joints("a.yaml", frames(), from, to)), InputError);
}

}  // namespace
}  // namespace koboshi::tools
