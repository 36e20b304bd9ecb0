// Arms, waist and inertial units that move, against mechanics::HingeTree in double precision.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/estimation/inertial_link.h"
#include "firmware/estimation/posture.h"
#include "firmware/fixed/host/convert.h"
#include "firmware/walk/body.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/description/load.h"
#include "simulation/model/robot_model.h"
#include "tests/closed_loop/other_robots.h"
#include "tests/support/temporary_folder.h"

namespace koboshi::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using fixed::from_double;
using fixed::to_double;

Vector3d metres_of(const robot::Position& p) { return {to_double(p.x), to_double(p.y), to_double(p.z)}; }

class UpperBody : public testing::Test {
 protected:
  explicit UpperBody(const std::string& text) {
    test::write_robot(folder_.path, text, true, false);
    robot_ = sim_board::load_robot(folder_.path / "robot.sdf");
  }
  UpperBody() : UpperBody(test::with_longer_arms(test::with_waist(test::default_robot()))) {}

  // Draws the angles of all joints but those of the legs, which stay.
  void draw(const robot::RobotModel& model) {
    for (std::size_t i = 0; i < model.joint_count; ++i) {
      if ((model.leg_joints() >> i & 1u) != 0) continue;
      const double angle_rad = std::uniform_real_distribution(-1.3, 1.3)(random_);
      set(i, angle_rad);
    }
  }
  void set(std::size_t joint, double angle_rad) {
    angles_[joint] = from_double<fixed::Angle>(angle_rad);
    angles_rad_[joint] = to_double(angles_[joint]);
  }

  test::TemporaryFolder folder_;
  sim_board::RobotDescription robot_;
  std::array<fixed::Angle, robot::kMaxJoints> angles_{};
  std::vector<double> angles_rad_ = std::vector<double>(robot::kMaxJoints);
  std::mt19937 random_{45};
};

TEST_F(UpperBody, Has31JointsWhoseCentreOfMassIsThatOfTheTree) {
  const robot::RobotModel model = load_named_model(robot_).model;
  ASSERT_EQ(model.joint_count, 31u);
  const mechanics::HingeTree tree = sim_board::hinge_tree(robot_);
  for (int trial = 0; trial < 200; ++trial) {
    draw(model);
    const auto X_BLs = tree.poses(Isometry3d::Identity(), std::span(angles_rad_).first(31));
    const estimation::Posture posture = estimation::posture_at(model, std::span(angles_).first(31));
    EXPECT_LT((metres_of(posture.p_BCom) - tree.centre_of_mass(X_BLs)).norm(), 3e-6) << trial;
  }
}

// With legs of no mass the plan is exact: the centre of mass comes to lie where the stance has it, whatever
// arms and waist do. With arms that it takes as hanging it does not.
TEST_F(UpperBody, IsInThePlanOfTheWalk) {
  for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
    const std::string& name = robot_.joints[i].name;
    const bool in_leg = name.find("hip") != std::string::npos || name.find("knee") != std::string::npos ||
                        name.find("ankle") != std::string::npos;
    if (in_leg) robot_.links[static_cast<std::size_t>(robot_.joints[i].child)].mass_kg = 1e-6;
  }
  const robot::RobotModel model = load_named_model(robot_).model;
  const mechanics::HingeTree tree = sim_board::hinge_tree(robot_);
  walk::Body body(model);
  double worst_m = 0.0;
  double hanging_m = 0.0;
  int solved = 0;
  for (int trial = 0; trial < 300; ++trial) {
    draw(model);
    walk::Stance stance;
    stance.soles[1].p.y = from_double<fixed::Length>(-0.077);
    const auto about = [&](double middle_m) {
      return from_double<fixed::Length>(middle_m + std::uniform_real_distribution(-0.01, 0.01)(random_));
    };
    stance.centre_of_mass = {about(0.0), about(-0.0385), about(0.19)};
    for (const bool follows : {true, false}) {
      body.begin_in_parts();
      body.set_upper_body(follows ? std::span<const fixed::Angle>(angles_) : std::span<const fixed::Angle>());
      do {
        body.solve(stance, {}, angles_);
      } while (!body.is_complete());
      for (std::size_t i = 0; i < model.joint_count; ++i) angles_rad_[i] = to_double(angles_[i]);
      const auto X_BLs = tree.poses(Isometry3d::Identity(), std::span(angles_rad_).first(31));
      const estimation::Posture posture = estimation::posture_at(model, std::span(angles_).first(31));
      const robot::Pose& X_BSole = posture.X_BSole[hal::Side::kLeft];
      const Vector3d right =
          metres_of(robot::transpose(X_BSole.R) * (posture.X_BSole[hal::Side::kRight].p - X_BSole.p));
      if ((right - Vector3d(0, -0.077, 0)).norm() > 1e-4) continue;  // beyond the reach of the legs
      const Vector3d p_B = tree.centre_of_mass(X_BLs) - metres_of(X_BSole.p);
      // The trunk is upright in this stance, and so is the sole's frame.
      const double error_m = (p_B - metres_of(stance.centre_of_mass)).norm();
      (follows ? worst_m : hanging_m) = std::max(follows ? worst_m : hanging_m, error_m);
      solved += follows ? 1 : 0;
    }
  }
  EXPECT_GT(solved, 50);
  EXPECT_LT(worst_m, 20e-6);
  EXPECT_GT(hanging_m, 0.01);
}

// A unit in the chest: rotation and rate of its link relative to the pelvis while the waist turns.
TEST_F(UpperBody, ConvertsAnInertialUnitAboveTheWaist) {
  test::write_robot(
      folder_.path,
      test::with_inertial_unit(test::with_waist(test::default_robot()), "chest", "0 0 0.03 0.4 -0.3 1.2"),
      true, false);
  robot_ = sim_board::load_robot(folder_.path / "robot.sdf");
  const robot::RobotModel model = load_named_model(robot_).model;
  ASSERT_FALSE(model.imu_link.is_trunk());
  estimation::InertialLink link(model);
  const mechanics::HingeTree tree = sim_board::hinge_tree(robot_);
  const auto chest = static_cast<std::size_t>(robot_.imu->link);
  std::array<Vector3d, 3> waist{};  // angle, speed and phase
  std::array<std::size_t, 3> joints{};
  for (std::size_t i = 0; i < 3; ++i) {
    constexpr std::array kNames{"waist_yaw", "waist_roll", "waist_pitch"};
    joints[i] = static_cast<std::size_t>(robot_.find_joint(kNames[i]).value());
    waist[i] = {0.3 + 0.1 * static_cast<double>(i), 0.6, static_cast<double>(i)};
  }
  const auto rotation_at = [&](double time_s) {
    for (std::size_t i = 0; i < 3; ++i)
      set(joints[i], waist[i][0] * std::sin(waist[i][1] * time_s + waist[i][2]));
    return Eigen::Matrix3d(
        tree.poses(Isometry3d::Identity(), std::span(angles_rad_).first(robot_.joints.size()))[chest]
            .linear());
  };
  for (int cycle = 0; cycle < 500; ++cycle) {
    const double time_s = 0.01 * cycle;
    const Eigen::Matrix3d R = rotation_at(time_s);
    link.update(std::span(angles_).first(model.joint_count));
    const robot::Rotation& R_BL = link.R_BL();
    for (int row = 0; row < 3; ++row) {
      const robot::Direction& shown = R_BL.rows[static_cast<std::size_t>(row)];
      EXPECT_LT(
          (Vector3d(to_double(shown.x), to_double(shown.y), to_double(shown.z)) - R.row(row).transpose())
              .norm(),
          1e-6);
    }
    if (cycle < 20) continue;
    // The mean of the last cycles is as late as 1.5 cycles of 10 ms.
    constexpr double kLate_s = 0.015;
    constexpr double kStep_s = 1e-4;
    const Eigen::Matrix3d before = rotation_at(time_s - kLate_s - kStep_s);
    const Eigen::Matrix3d after = rotation_at(time_s - kLate_s + kStep_s);
    const Eigen::AngleAxisd turn(after * before.transpose());
    const Vector3d w_rad_per_s = turn.axis() * turn.angle() / (2.0 * kStep_s);
    const auto& w = link.w_BL_B();
    const Vector3d shown_rad_per_s(to_double(w.x), to_double(w.y), to_double(w.z));
    EXPECT_LT((shown_rad_per_s - w_rad_per_s).norm(), 5e-3) << cycle;
    rotation_at(time_s);
  }
}

}  // namespace
}  // namespace koboshi::simulation
