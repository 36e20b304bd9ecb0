#include "simulation/model/robot_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "base/text/error.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/robot/kinematics.h"
#include "firmware/robot/leg.h"
#include "sim_board/description/load.h"

namespace koboshi::simulation {
namespace {

using fixed::to_double;
using robot::JointRole;
using sim_board::RobotDescription;
using testing::HasSubstr;

constexpr double kRadPerDegree = std::numbers::pi / 180.0;

Eigen::Vector3d to_vector(const robot::Position& p) {
  return {to_double(p.x), to_double(p.y), to_double(p.z)};
}

class RobotModelImageTest : public testing::Test {
 protected:
  static const RobotDescription& koboshi() {
    static const RobotDescription robot =
        sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf");
    return robot;
  }

  static std::string refusal(const std::function<void(RobotDescription&)>& change) {
    RobotDescription robot = koboshi();
    change(robot);
    try {
      static_cast<void>(make_robot_model(robot));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  static std::size_t index(const RobotDescription& robot, const std::string& name) {
    return static_cast<std::size_t>(robot.find_joint(name).value());
  }
};

TEST_F(RobotModelImageTest, IsReproducibleToTheByte) {
  EXPECT_EQ(make_robot_model(koboshi()), make_robot_model(sim_board::load_robot(koboshi().file)));
}

TEST_F(RobotModelImageTest, NamesTheLinkAndTheLineOfAMassThatTheFirmwareCannotHold) {
  const std::string file = koboshi().file.string();
  const auto heavy = [](std::size_t link) {
    return refusal([link](RobotDescription& robot) { robot.links[link].mass_kg = 360.0; });
  };
  EXPECT_EQ(heavy(0),
            file + ":" + std::to_string(koboshi().links[0].mass_line) +
                ": found a mass of 360 kg in link trunk, expected at most 32 kg a link, the most that "
                "the firmware can represent");
  EXPECT_GT(koboshi().links[0].mass_line, 0);
  EXPECT_GT(koboshi().links[1].mass_line, koboshi().links[0].mass_line);
  EXPECT_THAT(heavy(3), HasSubstr("360 kg in link " + koboshi().links[3].name));
}

TEST_F(RobotModelImageTest, DescribesThePapersRobot) {
  const NamedModel named = load_named_model(koboshi());
  const robot::RobotModel& model = named.model;
  EXPECT_EQ(named.robot, "koboshi");
  EXPECT_EQ(model.joint_count, 20u);
  EXPECT_EQ(named.joint_names.size(), 20u);
  EXPECT_NEAR(to_double(model.body_height), 0.38, 0.01);
  double mass_kg = to_double(model.base_mass);
  for (const robot::Joint& joint : model.joints) mass_kg += to_double(joint.mass);
  EXPECT_NEAR(mass_kg, koboshi().total_mass_kg(), 1e-6);
  for (std::uint8_t role = 1; role < robot::kRoleCount; ++role) {
    EXPECT_TRUE(model.find(static_cast<JointRole>(role))) << int{role};
  }
  // The gyro's full-scale value equals its range.
  EXPECT_NEAR(to_double(model.scales.gyro), koboshi().imu->gyro.range, 0.01);
  EXPECT_NEAR(to_double(model.scales.accelerometer), koboshi().imu->accelerometer.range, 0.01);
}

TEST_F(RobotModelImageTest, GivesEachJointItsDrive) {
  const robot::RobotModel model = load_named_model(koboshi()).model;
  for (std::size_t i = 0; i < model.joint_count; ++i) {
    const sim_board::JointDescription& joint = koboshi().joints[i];
    EXPECT_EQ(model.joints[i].drive.node_id, joint.drive.node_id);
    EXPECT_EQ(model.joints[i].drive.serial_number, joint.drive.serial_number);
    EXPECT_EQ(model.joints[i].drive.vendor_id, joint.drive.vendor_id);
    EXPECT_EQ(model.joints[i].drive.sign, joint.drive.sign);
    EXPECT_NEAR(to_double(model.joints[i].drive.zero), joint.drive.zero_rad, 1e-8);
    EXPECT_NEAR(to_double(model.joints[i].lower), joint.lower_rad, 1e-6);
    EXPECT_NEAR(to_double(model.joints[i].upper), joint.upper_rad, 1e-6);
  }
}

TEST_F(RobotModelImageTest, MatchesJointsAndCentreOfMassOfTheDescription) {
  const robot::RobotModel model = load_named_model(koboshi()).model;
  const std::array<fixed::Angle, robot::kMaxJoints> zero{};
  robot::LinkPoses X_BLinks;
  forward_kinematics(model, zero, X_BLinks);
  const Eigen::Isometry3d X_BM = koboshi().links[0].X_ML.inverse();
  for (std::size_t i = 0; i < model.joint_count; ++i) {
    EXPECT_LT((to_vector(X_BLinks[i].p) - X_BM * koboshi().joints[i].p_MJ).norm(), 1e-6);
  }
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const sim_board::LinkDescription& link : koboshi().links)
    moment += link.mass_kg * (link.X_ML * link.p_LCom_L);
  const Eigen::Vector3d p_BCom = X_BM * Eigen::Vector3d(moment / koboshi().total_mass_kg());
  EXPECT_LT((to_vector(centre_of_mass(model, X_BLinks)) - p_BCom).norm(), 2e-6);
}

TEST_F(RobotModelImageTest, FindsLegsAndFeet) {
  const robot::RobotModel model = load_named_model(koboshi()).model;
  robot::LegGeometry leg;
  ASSERT_TRUE(make_leg_geometry(model, hal::Side::kLeft, leg));
  EXPECT_NEAR(to_double(leg.thigh), 0.065, 1e-7);
  EXPECT_NEAR(to_double(leg.shank), 0.065, 1e-7);
  for (const robot::Foot& foot : model.feet) {
    EXPECT_NEAR(to_double(foot.ankle_height), 0.04, 1e-6);
    EXPECT_NEAR(to_double(foot.front), 0.062, 1e-6);
    EXPECT_NEAR(to_double(foot.back), -0.038, 1e-6);
    EXPECT_NEAR(to_double(foot.left), 0.028, 1e-6);
    EXPECT_NEAR(to_double(foot.sensor.z), koboshi().left_ankle->height_above_sole_m, 1e-6);
  }
}

TEST_F(RobotModelImageTest, PairsLeftAndRight) {
  const robot::RobotModel model = load_named_model(koboshi()).model;
  const auto pair = [&](const std::string& name) {
    const robot::Joint& joint = model.joints[index(koboshi(), "left_" + name)];
    EXPECT_EQ(joint.mirror, index(koboshi(), "right_" + name));
    return int{joint.mirror_sign};
  };
  EXPECT_EQ(pair("knee"), 1);
  EXPECT_EQ(pair("hip_roll"), -1);
  EXPECT_EQ(pair("hip_yaw"), -1);
  const std::size_t pan = index(koboshi(), "head_pan");
  EXPECT_EQ(model.joints[pan].mirror, pan);
  EXPECT_EQ(model.joints[pan].mirror_sign, -1);
}

TEST_F(RobotModelImageTest, KeepsTheSignOfALimitOfHalfATurn) {
  RobotDescription robot = koboshi();
  sim_board::JointDescription& shoulder = robot.joints[index(robot, "left_shoulder_pitch")];
  shoulder.lower_rad = -3.141593;
  shoulder.upper_rad = 3.141593;
  const robot::RobotModel model = load_named_model(robot).model;
  EXPECT_EQ(model.joints[index(robot, "left_shoulder_pitch")].lower, fixed::Angle::min());
  EXPECT_EQ(model.joints[index(robot, "left_shoulder_pitch")].upper, fixed::Angle::max());
}

TEST_F(RobotModelImageTest, RejectsRobotsThatItCannotExpress) {
  EXPECT_THAT(refusal([](auto& r) { r.imu.reset(); }),
              HasSubstr("found no inertial unit, expected one in any link"));
  EXPECT_THAT(refusal([](auto& r) { r.left_ankle.reset(); }), HasSubstr("a sensor in one ankle only"));
  EXPECT_THAT(refusal([](auto& r) { r.left_ankle->height_above_sole_m += 0.001; }),
              HasSubstr("at another height"));
  EXPECT_THAT(refusal([](auto& r) { r.left_ankle->force.resolution *= 2; }),
              HasSubstr("of different resolution"));
  EXPECT_THAT(refusal([](auto& r) { r.name = std::string(25, 'x'); }),
              HasSubstr("a name of 1 to 24 letters"));
  EXPECT_THAT(refusal([](auto& r) { r.joints.resize(32, r.joints[0]); }),
              HasSubstr("found 32 joints, expected 1 to 31"));
  EXPECT_THAT(refusal([](auto& r) { r.joints[3].upper_rad = 181 * kRadPerDegree; }),
              HasSubstr("beyond half a turn"));
  EXPECT_THAT(refusal([](auto& r) { r.joints[3].drive.sign = 0; }), HasSubstr("expected 1 or -1"));
  EXPECT_THAT(refusal([](auto& r) { r.joints[3].drive.node_id = 17; }),
              HasSubstr("two drives with one node id"));
  EXPECT_THAT(refusal([](auto& r) { r.joints[3].axis_M = Eigen::Vector3d::UnitZ(); }),
              HasSubstr("no mirror images"));
  EXPECT_THAT(refusal([](auto& r) {
                for (auto& joint : r.joints)
                  if (joint.name.starts_with("left_hip") || joint.name.starts_with("left_ankle") ||
                      joint.name == "left_knee")
                    joint.stated_role = "right_gripper";
              }),
              HasSubstr("no leg on the left"));
  EXPECT_THAT(refusal([](auto& r) {
                for (auto& link : r.links) link.collisions.clear();
              }),
              HasSubstr("no collision box below left_ankle_roll"));
}

}  // namespace
}  // namespace koboshi::simulation
