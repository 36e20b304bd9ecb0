#include "tools/motion_check/body.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim_board/world/gravity.h"
#include "tests/unit/tools/motion_check/koboshi_robot.h"

namespace koboshi::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

class BodyTest : public testing::Test {
 protected:
  // Smooth angles of all joints around a pose that stands on the right leg with the left foot in the air.
  std::vector<double> angles(double time_s) const {
    std::vector<double> result(robot_.joints.size());
    for (std::size_t j = 0; j < result.size(); ++j) {
      const double k = static_cast<double>(j);
      result[j] = 0.06 * std::sin((1.0 + 0.3 * k) * time_s + k);
    }
    const auto set = [&](const char* name, double by) {
      result[static_cast<std::size_t>(*robot_.find_joint(name))] += by;
    };
    set("left_hip_pitch", -1.0);
    set("left_knee", 1.6);
    set("right_hip_roll", 0.3);
    set("right_ankle_roll", -0.3);
    return result;
  }
  std::vector<double> speeds(double time_s) const { return differences(time_s, 1e-5, false); }
  std::vector<double> accelerations(double time_s) const { return differences(time_s, 1e-4, true); }

  std::vector<double> differences(double time_s, double h, bool second) const {
    const auto a = angles(time_s - h), b = angles(time_s), c = angles(time_s + h);
    std::vector<double> result(a.size());
    for (std::size_t j = 0; j < a.size(); ++j)
      result[j] = second ? (c[j] - 2.0 * b[j] + a[j]) / (h * h) : (c[j] - a[j]) / (2.0 * h);
    return result;
  }

  // Poses of the links in the frame of the right foot, which stands on the ground.
  std::vector<Isometry3d> poses_on_foot(double time_s) const {
    std::vector<Isometry3d> X_FLs;
    body_.place(angles(time_s), X_FLs);
    const Isometry3d X_FB = X_FLs[body_.foot_link(1)].inverse();
    for (Isometry3d& X_FL : X_FLs) X_FL = X_FB * X_FL;
    return X_FLs;
  }

  struct Momenta {
    Vector3d linear = Vector3d::Zero();
    Vector3d angular = Vector3d::Zero();       // about the foot's origin
    Vector3d first_moment = Vector3d::Zero();  // sum of m p
    double energy_J = 0.0;                     // kinetic, of links and rotors, and potential
  };
  // By differences of poses: independent of the recursion.
  Momenta momenta(double time_s) const {
    constexpr double kStep_s = 1e-5;
    const auto before = poses_on_foot(time_s - kStep_s);
    const auto now = poses_on_foot(time_s);
    const auto after = poses_on_foot(time_s + kStep_s);
    Momenta sum;
    for (std::size_t l = 0; l < robot_.links.size(); ++l) {
      const sim_board::LinkDescription& link = robot_.links[l];
      const auto com = [&](const std::vector<Isometry3d>& X_FLs) -> Vector3d {
        return X_FLs[l] * link.p_LCom_L;
      };
      const Vector3d v = (com(after) - com(before)) / (2.0 * kStep_s);
      const Eigen::AngleAxisd turn(Matrix3d(after[l].linear() * before[l].linear().transpose()));
      const Vector3d w = turn.angle() * turn.axis() / (2.0 * kStep_s);
      const Matrix3d inertia = now[l].linear() * link.I_LCom_L * now[l].linear().transpose();
      sum.linear += link.mass_kg * v;
      sum.angular += com(now).cross(link.mass_kg * v) + inertia * w;
      sum.first_moment += link.mass_kg * com(now);
      sum.energy_J += 0.5 * link.mass_kg * v.squaredNorm() + 0.5 * w.dot(inertia * w) +
                      link.mass_kg * sim_board::kGravity_m_per_s2 * com(now).z();
    }
    const std::vector<double> rates = speeds(time_s);
    for (std::size_t j = 0; j < rates.size(); ++j)
      sum.energy_J += 0.5 * robot_.joints[j].servo.rotor_inertia_kg_m2 * rates[j] * rates[j];
    return sum;
  }

  const sim_board::RobotDescription& robot_ = koboshi_robot();
  Body body_{robot_};
};

TEST_F(BodyTest, StandsOnBothFlatSolesAtJointZero) {
  Stance stance;
  body_.solve_at_rest(std::vector<double>(robot_.joints.size(), 0.0), stance);
  EXPECT_TRUE(stance.rest.rests);
  EXPECT_EQ(stance.rest.corners, 0xFFU);
  EXPECT_NEAR(stance.load_share[0], 0.5, 1e-6);
  EXPECT_NEAR(stance.rest.up_B.z(), 1.0, 1e-12);
  EXPECT_NEAR(body_.mass_kg(), robot_.total_mass_kg(), 1e-12);
}

TEST_F(BodyTest, AtRestTheZmpIsBelowTheCentreOfMass) {
  Stance stance;
  body_.solve_at_rest(angles(0.1), stance);
  EXPECT_LT((stance.zmp_m - stance.com_m).norm(), 1e-9);
  EXPECT_EQ(stance.load_share[1], 1.0) << "stands on the right sole";
}

// One knee is bent by a little more: a roll of 4 degrees brings that sole to the ground, so that the weight
// may move to it.
TEST_F(BodyTest, ASoleJustAboveTheGroundBelongsToTheSupportPolygon) {
  const auto polygon_of = [&](double lift_rad) {
    std::vector<double> pose(robot_.joints.size(), 0.0);
    const auto bend = [&](const std::string& side, double by_rad) {
      pose[static_cast<std::size_t>(*robot_.find_joint(side + "_hip_pitch"))] = -by_rad;
      pose[static_cast<std::size_t>(*robot_.find_joint(side + "_knee"))] = 2.0 * by_rad;
      pose[static_cast<std::size_t>(*robot_.find_joint(side + "_ankle_pitch"))] = -by_rad;
    };
    bend("left", 0.4 + lift_rad);
    bend("right", 0.4);
    // Towards the right foot, so that it carries alone.
    for (const char* const side : {"left", "right"}) {
      pose[static_cast<std::size_t>(*robot_.find_joint(std::string(side) + "_hip_roll"))] = 0.3;
      pose[static_cast<std::size_t>(*robot_.find_joint(std::string(side) + "_ankle_roll"))] = -0.3;
    }
    Stance stance;
    body_.solve_at_rest(pose, stance);
    EXPECT_EQ(stance.rest.corners, 0xF0U) << "stands on the right sole";
    double left_m = -1.0;
    for (const Vector2d& corner : body_.support_polygon(stance)) left_m = std::max(left_m, corner.y());
    return left_m - stance.com_m.y();
  };
  EXPECT_GT(polygon_of(0.05), 0.05);
  EXPECT_LT(polygon_of(0.4), 0.05);
}

// The power of the servos is the change of the energy, whatever the recursion.
TEST_F(BodyTest, PowerOfTheServosIsTheChangeOfEnergy) {
  constexpr double kStep_s = 1e-4;
  for (const double time_s : {0.1, 0.7, 1.3}) {
    Stance stance;
    body_.solve(angles(time_s), speeds(time_s), accelerations(time_s), stance);
    ASSERT_EQ(stance.rest.corners, 0xF0U) << "stands on the right sole alone";
    ASSERT_EQ(stance.rest.tip_rad, 0.0);
    const std::vector<double> rates = speeds(time_s);
    double power_W = 0.0;
    for (std::size_t j = 0; j < rates.size(); ++j) power_W += stance.torques_Nm[j] * rates[j];
    const double change_W =
        (momenta(time_s + kStep_s).energy_J - momenta(time_s - kStep_s).energy_J) / (2.0 * kStep_s);
    EXPECT_NEAR(power_W, change_W, 1e-4 + 1e-3 * std::abs(change_W)) << time_s;
  }
}

// The ZMP from the rates of the momenta: M = dH/dt + sum(m p) x g up, F = dP/dt + m g up.
TEST_F(BodyTest, ZmpFollowsFromTheMomenta) {
  constexpr double kStep_s = 1e-4;
  for (const double time_s : {0.1, 0.7, 1.3}) {
    Stance stance;
    body_.solve(angles(time_s), speeds(time_s), accelerations(time_s), stance);
    const Momenta a = momenta(time_s - kStep_s), b = momenta(time_s), c = momenta(time_s + kStep_s);
    const Vector3d weight(0.0, 0.0, sim_board::kGravity_m_per_s2);
    const Vector3d force = (c.linear - a.linear) / (2.0 * kStep_s) + body_.mass_kg() * weight;
    const Vector3d moment = (c.angular - a.angular) / (2.0 * kStep_s) + b.first_moment.cross(weight);
    // Relative to the corners of the right sole, in axes of the foot, which are level.
    const double sole_z_m = -robot_.right_ankle->height_above_sole_m;
    const Vector2d zmp_m(-moment.y() + sole_z_m * force.x(), moment.x() + sole_z_m * force.y());
    const Vector2d expected_m = zmp_m / force.z();
    std::vector<Isometry3d> X_BLs;
    body_.place(angles(time_s), X_BLs);
    const GroundAxes axes(stance.rest.up_B);
    const Vector3d zmp_B =
        stance.zmp_m.x() * axes.x_B + stance.zmp_m.y() * axes.y_B + stance.rest.height_m * stance.rest.up_B;
    const Vector3d zmp_F = X_BLs[body_.foot_link(1)].inverse() * zmp_B;
    EXPECT_NEAR(zmp_F.x(), expected_m.x(), 1e-5) << time_s;
    EXPECT_NEAR(zmp_F.y(), expected_m.y(), 1e-5) << time_s;
  }
}

}  // namespace
}  // namespace koboshi::tools
