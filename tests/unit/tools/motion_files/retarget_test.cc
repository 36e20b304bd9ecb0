#include "tools/motion_files/retarget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <numbers>
#include <string>

#include "base/text/error.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/robot/kinematics.h"
#include "sim_board/description/load.h"
#include "simulation/model/isometry.h"
#include "simulation/motion_language/parse/parse.h"
#include "tools/motion_files/convert.h"
#include "tools/motion_files/flatten.h"
#include "tools/motion_files/retarget_targets.h"

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
    return flatten_motion(simulation::parse_motion(file, model, messages), model);
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

// The fall detector judges the robot by what its motion declares.
TEST_F(RetargetTest, KeepsDeclaredLeans) {
  const std::string text =
      "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {left_knee: 20}\n  q: {left_knee: 40}\nsteps:\n"
      "  - {pose: p, time_s: 1}\n  - {pose: q, time_s: 1, lean: {pitch_deg: 30}}\n"
      "  - {lean: {roll_deg: -5}}\n  - {pose: p, time_s: 1}\n  - {lean: none}\n  - {pose: q, time_s: 1}\n";
  const simulation::MotionFile file = simulation::read_motion_text("a.yaml", text);
  simulation::Diagnostics messages(file.path, file.text);
  ForeignMotion motion = flatten_motion(simulation::parse_motion(file, model, messages), model);
  const ConvertedMotion result =
      convert_motion("a.yaml", motion, retarget_joints("a.yaml", motion, from, to), model, {});
  EXPECT_THAT(result.text, HasSubstr("- {pose: p1, time_s: 1}\n"));
  EXPECT_THAT(result.text, HasSubstr("- {pose: p2, time_s: 1, lean: {pitch_deg: 29.998, roll_deg: 0}}\n"));
  EXPECT_THAT(result.text, HasSubstr("- {pose: p3, time_s: 1, lean: {pitch_deg: 0, roll_deg: -4.999}}\n"));
  EXPECT_THAT(result.text, HasSubstr("- {pose: p4, time_s: 1}\n"));
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

// --- By targets

class RetargetTargets : public testing::Test {
 protected:
  using Angles = std::vector<fixed::Angle>;

  struct Known {
    explicit Known(const std::string& name)
        : description(
              sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/" + name + "/robot.sdf")),
          model(simulation::load_named_model(description)) {}
    sim_board::RobotDescription description;
    simulation::NamedModel model;
  };

  // One key frame, in degrees by names of the robot's joints.
  ForeignMotion frame(const Known& robot, const std::map<std::string, double>& pose_deg) const {
    ForeignFrame frame{.place = "line 1", .move_us = 1'000'000};
    ForeignMotion motion{.name = "a"};
    for (const std::string& name : robot.model.joint_names) {
      motion.joints.push_back({.name = name});
      const auto given = pose_deg.find(name);
      frame.values.emplace_back(given == pose_deg.end() ? 0.0 : given->second * std::numbers::pi / 180.0);
    }
    motion.sections.push_back({.frames = {frame}});
    return motion;
  }
  ForeignMotion retargeted(const ForeignMotion& motion, const Known& from, const Known& to) const {
    return retarget_targets("a.yaml", motion, {from.description, from.model}, {to.description, to.model});
  }
  static Angles angles_of(const ForeignMotion& motion) {
    Angles angles;
    for (const ForeignValue& value : motion.sections.front().frames.front().values)
      angles.push_back(fixed::from_double<fixed::Angle>(value.value_or(0.0)));
    return angles;
  }

  // Soles and centre of mass in the frame midway between the soles.
  struct Stand {
    std::array<Eigen::Isometry3d, 2> X_SSoles;
    Eigen::Vector3d com_S;
    Eigen::Vector3d trunk_rpy;
  };
  static Stand stand_of(const Known& robot, const ForeignMotion& motion) {
    robot::LinkPoses X_BLinks;
    robot::forward_kinematics(robot.model.model, angles_of(motion), X_BLinks);
    std::array<Eigen::Isometry3d, 2> X_BSoles;
    for (std::size_t side = 0; side < 2; ++side)
      X_BSoles[side] = simulation::isometry_of(
          robot::sole_pose(robot.model.model, static_cast<hal::Side>(side), X_BLinks));
    const Eigen::Isometry3d X_SB = simulation::midway(X_BSoles[0], X_BSoles[1]).inverse();
    return {{X_SB * X_BSoles[0], X_SB * X_BSoles[1]},
            X_SB * simulation::vector_of(robot::centre_of_mass(robot.model.model, X_BLinks)),
            simulation::rpy_of(X_SB.linear())};
  }

  const Known koboshi{"koboshi"};
  const std::map<std::string, double> crouched{{"left_hip_pitch", -40},
                                               {"right_hip_pitch", -40},
                                               {"left_knee", 80},
                                               {"right_knee", 80},
                                               {"left_ankle_pitch", -40},
                                               {"right_ankle_pitch", -40},
                                               {"left_shoulder_pitch", -60},
                                               {"left_shoulder_roll", 20},
                                               {"right_shoulder_roll", -10},
                                               {"left_elbow", -40},
                                               {"head_pan", 30}};
};

TEST_F(RetargetTargets, IsTheIdentityForTheSameRobot) {
  const ForeignMotion motion = frame(koboshi, crouched);
  const ForeignMotion result = retargeted(motion, koboshi, koboshi);
  for (std::size_t i = 0; i < koboshi.model.joint_names.size(); ++i)
    EXPECT_NEAR(*result.sections[0].frames[0].values[i], *motion.sections[0].frames[0].values[i], 2e-3)
        << koboshi.model.joint_names[i];
  EXPECT_TRUE(result.notes.empty()) << result.notes.front().text;
  EXPECT_EQ(result.sections[0].frames[0].move_us, 1'000'000);
}

// Soles level and as far apart as the robot's hips, the trunk upright, the centre of mass over the soles, and
// the hips as low as their share of the leg says.
TEST_F(RetargetTargets, StandsOnRobotsOfOtherProportions) {
  const ForeignMotion motion = frame(koboshi, crouched);
  const Stand own = stand_of(koboshi, motion);
  for (const char* const name : {"hanpo", "noppo"}) {
    const Known other(name);
    const ForeignMotion result = retargeted(motion, koboshi, other);
    const Stand stand = stand_of(other, result);
    const Stand upright = stand_of(other, frame(other, {}));
    for (std::size_t side = 0; side < 2; ++side) {
      EXPECT_NEAR(stand.X_SSoles[side].translation().x(), 0.0, 5e-4) << name;
      EXPECT_NEAR(stand.X_SSoles[side].translation().y(), upright.X_SSoles[side].translation().y(), 5e-4);
      EXPECT_NEAR(stand.X_SSoles[side].linear()(2, 2), 1.0, 1e-5);
    }
    EXPECT_NEAR((stand.trunk_rpy - own.trunk_rpy).norm(), 0.0, 2e-3) << name;
    const auto half_m = [](const Known& robot, const Stand& at) {
      const robot::Foot& left = robot.model.model.feet[hal::Side::kLeft];
      return at.X_SSoles[0].translation().y() +
             0.5 * (fixed::to_double(left.left) - fixed::to_double(left.right));
    };
    EXPECT_NEAR(stand.com_S.y() / half_m(other, upright),
                own.com_S.y() / half_m(koboshi, stand_of(koboshi, frame(koboshi, {}))), 0.005)
        << name;
    const robot::Foot& foot = other.model.model.feet[hal::Side::kLeft];
    EXPECT_LT(stand.com_S.x(), fixed::to_double(foot.front));
    EXPECT_GT(stand.com_S.x(), fixed::to_double(foot.back));
    EXPECT_LT(stand.com_S.z(), 0.95 * upright.com_S.z()) << "it crouches";
    const auto head = other.description.find_joint("head_pan");
    if (head) {
      EXPECT_NEAR(*result.sections[0].frames[0].values[static_cast<std::size_t>(*head)], std::numbers::pi / 6,
                  1e-3);
    }
  }
}

// A lifted foot: the other one carries, and the centre of mass stays where it is in its rectangle.
TEST_F(RetargetTargets, KeepsTheCentreOfMassOverTheFootThatCarries) {
  const Known noppo("noppo");
  std::map<std::string, double> pose = crouched;
  for (const char* const side : {"left", "right"}) {
    const double roll_deg = -14.0;
    pose[std::string(side) + "_hip_roll"] = roll_deg;
    pose[std::string(side) + "_ankle_roll"] = -roll_deg;
  }
  pose["right_hip_pitch"] = -60;
  pose["right_knee"] = 110;
  pose["right_ankle_pitch"] = -50;
  const ForeignMotion motion = frame(koboshi, pose);
  const auto in_left_sole = [](const Known& robot, const ForeignMotion& played) {
    robot::LinkPoses X_BLinks;
    robot::forward_kinematics(robot.model.model, angles_of(played), X_BLinks);
    const Eigen::Isometry3d X_BS =
        simulation::isometry_of(robot::sole_pose(robot.model.model, hal::Side::kLeft, X_BLinks));
    return Eigen::Vector3d(X_BS.inverse() *
                           simulation::vector_of(robot::centre_of_mass(robot.model.model, X_BLinks)));
  };
  const auto share = [&](const Known& robot, const ForeignMotion& played) {
    const robot::Foot& foot = robot.model.model.feet[hal::Side::kLeft];
    const double half_m = 0.5 * (fixed::to_double(foot.left) - fixed::to_double(foot.right));
    const double middle_m = 0.5 * (fixed::to_double(foot.left) + fixed::to_double(foot.right));
    return (in_left_sole(robot, played).y() - middle_m) / half_m;
  };
  EXPECT_NEAR(share(noppo, retargeted(motion, koboshi, noppo)), share(koboshi, motion), 0.02);
  EXPECT_LT(std::abs(share(koboshi, motion)), 1.0);
}

// A motion of one arm alone can be played while the robot walks.
TEST_F(RetargetTargets, LeavesLegsAloneThatTheMotionDoesNotMove) {
  ForeignMotion motion = frame(koboshi, crouched);
  for (std::size_t i = 0; i < koboshi.model.joint_names.size(); ++i) {
    const std::string& name = koboshi.model.joint_names[i];
    if (name.find("left_shoulder") != 0 && name != "left_elbow" && name != "head_pan")
      motion.sections[0].frames[0].values[i].reset();
  }
  const Known noppo("noppo");
  const ForeignMotion result = retargeted(motion, koboshi, noppo);
  for (std::size_t i = 0; i < noppo.model.joint_names.size(); ++i) {
    const std::string& name = noppo.model.joint_names[i];
    const bool is_moved = name.find("left_shoulder") == 0 || name == "left_elbow" || name == "head_pan";
    EXPECT_EQ(result.sections[0].frames[0].values[i].has_value(), is_moved) << name;
  }
}

// Straight arms stay nearly straight and alike on both sides, bent ones bend as they did.
TEST_F(RetargetTargets, KeepsTheBendOfElbows) {
  for (const char* const name : {"hanpo", "noppo"}) {
    const Known other(name);
    const auto elbow_deg = [&](const ForeignMotion& motion, const char* joint) {
      const ForeignMotion result = retargeted(motion, koboshi, other);
      const auto at = static_cast<std::size_t>(*other.description.find_joint(joint));
      return *result.sections[0].frames[0].values[at] * 180.0 / std::numbers::pi;
    };
    std::map<std::string, double> pose = crouched;
    for (const double elbow : {0.0, -60.0, 60.0}) {
      pose["left_elbow"] = pose["right_elbow"] = elbow;
      const double left = elbow_deg(frame(koboshi, pose), "left_elbow");
      EXPECT_NEAR(left, elbow_deg(frame(koboshi, pose), "right_elbow"), 2.0) << name << ' ' << elbow;
      EXPECT_NEAR(left, elbow, 25.0) << name;
      if (elbow != 0.0) {
        EXPECT_GT(left * elbow, 0.0) << name;
      }
    }
  }
}

// Knees bent so far that it cannot stand on its soles: the joints have the angles of the others, and a note
// says so.
TEST_F(RetargetTargets, TakesJointAnglesWhereTheRobotDoesNotStand) {
  const ForeignMotion motion = frame(
      koboshi, {{"left_hip_pitch", -75}, {"right_hip_pitch", -75}, {"left_knee", 150}, {"right_knee", 150}});
  const ForeignMotion result = retargeted(motion, koboshi, koboshi);
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_THAT(result.notes[0].text, HasSubstr("1 of 1 poses, in which the robot does not stand"));
  EXPECT_EQ(angles_of(result), angles_of(motion));
}

}  // namespace
}  // namespace koboshi::tools
