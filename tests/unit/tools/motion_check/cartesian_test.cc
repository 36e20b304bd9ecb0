#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "firmware/fixed/host/convert.h"
#include "firmware/motion/motion.h"
#include "simulation/motion_language/parse/body_targets.h"
#include "tests/support/seed.h"
#include "tests/unit/simulation/motion_language/random_program.h"
#include "tests/unit/tools/motion_check/koboshi_robot.h"
#include "tools/motion_check/body.h"

// Compares the Cartesian poses that the compiler solves with the firmware's kinematics against the links of
// the robot's file, which Body places in double precision.
namespace koboshi::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using simulation::koboshi_model;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMaxError_m = 1e-4;
constexpr double kMaxError_rad = 0.1 * kDegree;
// Error of a stored angle: half a unit of 2^-14 turn.
constexpr double kHalfUnit_rad = std::numbers::pi / (1 << motion::kPoseBits);

// Positions and orientations of the parts that can have targets, in the frame of a sole.
struct Parts {
  std::array<Isometry3d, 2> soles;
  Isometry3d hips;  // the trunk's axes in the centre between the hips
  std::array<Vector3d, 2> hands;
  Vector3d com;
};

class CartesianPoses : public testing::Test {
 protected:
  // Returns the parts in axes of the trunk.
  Parts parts_B(const std::vector<double>& angles_rad) const {
    std::vector<Isometry3d> X_BLs;
    body_.place(angles_rad, X_BLs);
    const auto link_pose = [&](int link) { return X_BLs[static_cast<std::size_t>(link)]; };
    Parts parts;
    parts.hips = Isometry3d::Identity();
    parts.com.setZero();
    for (std::size_t side = 0; side < 2; ++side) {
      const std::string name = side == 0 ? "left_" : "right_";
      const sim_board::JointDescription& ankle = joint(name + "ankle_roll");
      const sim_board::JointDescription& elbow = joint(name + "elbow");
      // A sole is parallel to the trunk at zero, below the ankle, at the height of the lowest collision box.
      Isometry3d X_MSole = link(0).X_ML;
      X_MSole.translation() = ankle.p_MJ;
      X_MSole.translation().z() = lowest_M(ankle.child);
      parts.soles[side] = link_pose(ankle.child) * link(ankle.child).X_ML.inverse() * X_MSole;
      parts.hips.translation() += 0.5 * (link(0).X_ML.inverse() * joint(name + "hip_yaw").p_MJ);
      const robot::Position& tip = *koboshi_model().hands[side];
      const Vector3d tip_M =
          elbow.p_MJ + link(0).X_ML.linear() * Vector3d(fixed::to_double(tip.x), fixed::to_double(tip.y),
                                                        fixed::to_double(tip.z));
      parts.hands[side] = link_pose(elbow.child) * (link(elbow.child).X_ML.inverse() * tip_M);
    }
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      parts.com += robot_.links[i].mass_kg / robot_.total_mass_kg() *
                   (link_pose(static_cast<int>(i)) * robot_.links[i].p_LCom_L);
    }
    return parts;
  }

  // Returns the parts in the frame of the sole of `side`.
  Parts parts_S(const std::vector<double>& angles_rad, std::size_t side) const {
    Parts parts = parts_B(angles_rad);
    const Isometry3d X_SB = parts.soles[side].inverse();
    for (Isometry3d& sole : parts.soles) sole = X_SB * sole;
    for (Vector3d& hand : parts.hands) hand = X_SB * hand;
    parts.hips = X_SB * parts.hips;
    parts.com = X_SB * parts.com;
    return parts;
  }

  // Returns random angles of a robot that stands on bent legs.
  std::vector<double> random_angles() {
    std::vector<double> angles(robot_.joints.size());
    for (std::size_t i = 0; i < angles.size(); ++i) {
      const std::string& name = robot_.joints[i].name;
      const auto ends = [&](const char* text) { return name.ends_with(text); };
      const double out = name.starts_with("left_") ? 1.0 : -1.0;
      angles[i] = kDegree * (ends("hip_pitch")        ? uniform(-60, -10)
                             : ends("knee")           ? uniform(20, 90)
                             : ends("ankle_pitch")    ? uniform(-50, 0)
                             : ends("roll")           ? out * uniform(0, 15)
                             : ends("hip_yaw")        ? uniform(-15, 15)
                             : ends("shoulder_pitch") ? uniform(-90, 40)
                             : ends("elbow")          ? uniform(-85, -15)
                                                      : uniform(-20, 20));
    }
    return angles;
  }

  // Compiles a motion with one pose. `stored_rad`: the angles of the image; without joints of the pose, zero.
  // Returns the unrounded angles.
  std::vector<double> compile(const std::string& pose, std::vector<double>& stored_rad) const {
    const simulation::Compiled compiled = simulation::compile_text(
        "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: " + pose + "\nsteps: [{pose: p, time_s: 1}]\n");
    EXPECT_EQ(compiled.messages(), "") << pose;
    motion::Motion opened;
    if (!motion::Motion::open(compiled.motion.image, koboshi_model().model, opened).ok()) return {};
    std::vector<double> angles_rad(robot_.joints.size());
    stored_rad.assign(robot_.joints.size(), 0.0);
    for (std::size_t i = 0; i < angles_rad.size(); ++i) {
      if ((opened.joint_mask(0) >> i & 1u) == 0) continue;
      angles_rad[i] = fixed::to_double(*compiled.source.poses[0].angles[i]);
      stored_rad[i] = fixed::to_double(opened.angle(0, i));
    }
    return angles_rad;
  }

  // Returns the keys of a target: "x_mm: 1, roll_deg: 2".
  static std::string target(const Isometry3d& X) {
    const Matrix3d R = X.linear();
    return fmt::format("{}, roll_deg: {:.9f}, pitch_deg: {:.9f}, yaw_deg: {:.9f}",
                       target(Vector3d(X.translation())), std::atan2(R(2, 1), R(2, 2)) / kDegree,
                       std::asin(-R(2, 0)) / kDegree, std::atan2(R(1, 0), R(0, 0)) / kDegree);
  }
  static std::string target(const Vector3d& p) {
    return fmt::format("x_mm: {:.9f}, y_mm: {:.9f}, z_mm: {:.9f}", 1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z());
  }

  static double angle_between(const Isometry3d& a, const Isometry3d& b) {
    return Eigen::AngleAxisd(Matrix3d(a.linear().transpose() * b.linear())).angle();
  }

  // Bound of the displacement of a point by the rounding of the stored angles: the sum of half a unit times
  // the distance to each of `joints`, first order.
  template <typename Point>
  double rounding_m(const std::vector<double>& angles_rad, Point point) const {
    constexpr double kStep = 1e-6;
    double bound_m = 0.0;
    const Vector3d here = point(angles_rad);
    for (std::size_t i = 0; i < angles_rad.size(); ++i) {
      std::vector<double> moved = angles_rad;
      moved[i] += kStep;
      bound_m += kHalfUnit_rad * (point(moved) - here).norm() / kStep;
    }
    return bound_m;
  }

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1.0p-53);
  }
  const sim_board::JointDescription& joint(const std::string& name) const {
    return robot_.joints[static_cast<std::size_t>(*robot_.find_joint(name))];
  }
  const sim_board::LinkDescription& link(int index) const {
    return robot_.links[static_cast<std::size_t>(index)];
  }
  double lowest_M(int index) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const sim_board::BoxDescription& box : link(index).collisions) {
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3d sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
        lowest = std::min(lowest, (link(index).X_ML * (box.X_LG * sign.cwiseProduct(box.size_m))).z());
      }
    }
    return lowest;
  }

  const sim_board::RobotDescription& robot_ = koboshi_robot();
  const Body body_{robot_};
  std::mt19937_64 random_{test::kSeed};
};

TEST_F(CartesianPoses, ReachRandomTargetsByTheRobotsFile) {
  double worst_m = 0.0;
  double worst_rad = 0.0;
  double worst_stored_m = 0.0;
  double worst_stored_rad = 0.0;
  const int count = simulation::random_motions(100);
  for (int i = 0; i < count; ++i) {
    const std::size_t support = i % 2 == 0 ? 0 : 1;
    const std::size_t other = 1 - support;
    // Targets taken from a random pose are within reach.
    const Parts wanted = parts_S(random_angles(), support);
    const std::string pose = fmt::format(
        "{{support: {}, {}: {{{}}}, trunk: {{{}}}, left_hand: {{{}}}, right_hand: {{{}}}}}",
        support == 0 ? "left" : "right", support == 0 ? "right_foot" : "left_foot",
        target(wanted.soles[other]), target(wanted.hips), target(wanted.hands[0]), target(wanted.hands[1]));
    std::vector<double> stored_rad;
    const std::vector<double> angles_rad = compile(pose, stored_rad);
    ASSERT_FALSE(angles_rad.empty()) << pose;
    const Parts reached = parts_S(angles_rad, support);
    const Parts stored = parts_S(stored_rad, support);
    const auto check = [&](const Vector3d& goal, auto point) {
      const double error_m = (point(reached) - goal).norm();
      const double stored_m = (point(stored) - goal).norm();
      EXPECT_LT(error_m, kMaxError_m) << pose;
      EXPECT_LT(stored_m, error_m + 1.01 * rounding_m(angles_rad,
                                                      [&](const std::vector<double>& angles) {
                                                        return point(parts_S(angles, support));
                                                      }))
          << pose;
      worst_m = std::max(worst_m, error_m);
      worst_stored_m = std::max(worst_stored_m, stored_m);
    };
    const auto check_rotation = [&](const Isometry3d& goal, auto part, int joints) {
      const double error_rad = angle_between(part(reached), goal);
      const double stored_rad_error = angle_between(part(stored), goal);
      EXPECT_LT(error_rad, kMaxError_rad) << pose;
      EXPECT_LT(stored_rad_error, error_rad + joints * kHalfUnit_rad) << pose;
      worst_rad = std::max(worst_rad, error_rad);
      worst_stored_rad = std::max(worst_stored_rad, stored_rad_error);
    };
    check(wanted.soles[other].translation(),
          [&](const Parts& p) { return Vector3d(p.soles[other].translation()); });
    check(wanted.hips.translation(), [](const Parts& p) { return Vector3d(p.hips.translation()); });
    check(wanted.hands[0], [](const Parts& p) { return p.hands[0]; });
    check(wanted.hands[1], [](const Parts& p) { return p.hands[1]; });
    check_rotation(
        wanted.hips, [](const Parts& p) { return p.hips; }, 6);
    check_rotation(
        wanted.soles[other], [&](const Parts& p) { return p.soles[other]; }, 12);
  }
  std::printf("%d targets: %.4f mm and %.4f degrees, in the image %.4f mm and %.4f degrees\n", count,
              1e3 * worst_m, worst_rad / kDegree, 1e3 * worst_stored_m, worst_stored_rad / kDegree);
}

TEST_F(CartesianPoses, MoveTheCentreOfMassByTheRobotsFile) {
  double worst_m = 0.0;
  const int count = simulation::random_motions(30);
  for (int i = 0; i < count; ++i) {
    const Vector3d goal(uniform(-0.01, 0.02), uniform(0.0, 0.055), uniform(0.125, 0.145));
    std::vector<double> stored_rad;
    const std::vector<double> angles_rad =
        compile(fmt::format("{{support: right, com: {{{}}}}}", target(goal)), stored_rad);
    ASSERT_FALSE(angles_rad.empty());
    const double error_m = (parts_S(angles_rad, 1).com - goal).norm();
    EXPECT_LT(error_m, 2.0 * kMaxError_m) << goal.transpose();
    worst_m = std::max(worst_m, error_m);
  }
  std::printf("%d centres of mass: %.4f mm\n", count, 1e3 * worst_m);
}

TEST_F(CartesianPoses, OutOfReachSayTheDistance) {
  // The stretched leg ends at the hips' height at zero.
  const double reach_mm = 1e3 * parts_S(std::vector<double>(robot_.joints.size()), 0).hips.translation().z();
  for (const double beyond_mm : {1.0, 5.0, 40.0}) {
    const simulation::Compiled compiled = simulation::compile_text(fmt::format(
        "version: 2\nrobot: koboshi\nname: a\nposes:\n  p: {{trunk: {{z_mm: {:.6f}}}}}\nsteps: [end]\n",
        reach_mm + beyond_mm));
    EXPECT_EQ(compiled.codes(), "M016");
    EXPECT_NE(compiled.messages().find(fmt::format("out of reach by {:.1f} mm", beyond_mm)),
              std::string::npos)
        << compiled.messages();
  }
}

}  // namespace
}  // namespace koboshi::tools
