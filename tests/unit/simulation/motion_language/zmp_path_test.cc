#include "simulation/motion_language/compile/zmp_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "firmware/fixed/host/convert.h"
#include "firmware/robot/kinematics.h"
#include "sim_board/description/load.h"
#include "simulation/model/isometry.h"
#include "simulation/motion_language/compile/compile.h"
#include "simulation/motion_language/parse/parse.h"

namespace koboshi::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kGravity_m_per_s2 = 9.80665;

class ZmpPath : public testing::Test {
 protected:
  MotionSource parsed(const std::string& steps, Diagnostics* messages = nullptr) {
    const std::string text =
        "version: 2\nrobot: koboshi\nname: a\nposes:\n"
        "  stand: {others: zero, hip_pitch: -15.9, knee: 43.7, ankle_pitch: -27.8, shoulder_roll: 8}\n"
        "  low: {from: stand, com: {x_mm: 8, y_mm: 0, z_mm: 160}}\n"
        "  left: {from: low, com: {y_mm: 30}}\n"
        "  lifted: {from: left, support: left, com: {x_mm: 8, y_mm: 0}, right_foot: {z_mm: 20}}\n"
        "  wave: {left_elbow: -60}\n"
        "steps:\n  - {pose: low, time_s: 1}\n" +
        steps;
    const MotionFile file = read_motion_text("a.yaml", text);
    Diagnostics own(file.path, file.text);
    Diagnostics& diagnostics = messages != nullptr ? *messages : own;
    MotionSource motion = with_zmp_paths(parse_motion(file, robot_, diagnostics), robot_, diagnostics);
    static_cast<void>(compile_motion(motion, robot_, diagnostics));
    EXPECT_FALSE(diagnostics.has_errors());
    return motion;
  }
  // By step: where the robot is at its end, in the frame of the left sole.
  struct Point {
    double time_s = 0.0;  // of the step
    Vector3d com_S;
    Isometry3d X_SRight;
    double elbow_rad = 0.0;
  };
  std::vector<Point> points(const MotionSource& motion) const {
    std::vector<fixed::Angle> angles(robot_.joint_names.size());
    std::vector<Point> points;
    for (const StepSource& step : motion.steps) {
      const PoseSource& pose = motion.poses[step.pose];
      for (std::size_t i = 0; i < angles.size(); ++i) {
        if (pose.angles[i]) angles[i] = *pose.angles[i];
      }
      robot::LinkPoses X_BLinks;
      robot::forward_kinematics(robot_.model, angles, X_BLinks);
      const Isometry3d X_SB =
          isometry_of(robot::sole_pose(robot_.model, hal::Side::kLeft, X_BLinks)).inverse();
      points.push_back(
          {.time_s = step.time_us * 1e-6,
           .com_S = X_SB * vector_of(robot::centre_of_mass(robot_.model, X_BLinks)),
           .X_SRight = X_SB * isometry_of(robot::sole_pose(robot_.model, hal::Side::kRight, X_BLinks)),
           .elbow_rad = fixed::to_double(angles[*robot_.model.find(robot::JointRole::kLeftElbow)])});
    }
    return points;
  }

  const NamedModel robot_ =
      load_named_model(sim_board::load_robot(std::string(KOBOSHI_SOURCE_DIR) + "/robots/koboshi/robot.sdf"));
};

// The ZMP of the path, computed from its centre of mass alone, goes evenly from the middle to the left.
TEST_F(ZmpPath, MovesTheZmpStraightFromPoseToPose) {
  const std::vector<Point> path =
      points(parsed("  - {pose: low, time_s: 0.6, path: zmp}\n  - {pose: left, time_s: 0.8, path: zmp}\n"
                    "  - {pose: left, time_s: 0.6, path: zmp}\n"));
  ASSERT_EQ(path.size(), 1u + 15 + 20 + 15);
  const double from_m = path.front().com_S.y();
  const double to_m = path.back().com_S.y();
  ASSERT_NEAR(to_m - from_m, 0.030, 5e-4);
  double elapsed_s = 0.0;
  double largest_m = 0.0;
  for (std::size_t k = 1; k + 1 < path.size(); ++k) {
    elapsed_s += path[k].time_s;
    EXPECT_NEAR(path[k].time_s, 0.04, 1e-9);
    const Vector3d acceleration =
        (path[k + 1].com_S - 2.0 * path[k].com_S + path[k - 1].com_S) / (path[k].time_s * path[k].time_s);
    const double zmp_m = path[k].com_S.y() - path[k].com_S.z() / kGravity_m_per_s2 * acceleration.y();
    const double wanted_m = std::lerp(from_m, to_m, std::clamp((elapsed_s - 0.6) / 0.8, 0.0, 1.0));
    largest_m = std::max(largest_m, std::abs(zmp_m - wanted_m));
  }
  EXPECT_LT(largest_m, 0.003) << "the targets are in encoder-free angles of 2^-14 turn";
}

TEST_F(ZmpPath, KeepsTheSolesWhereTheyAre) {
  const std::vector<Point> path = points(parsed("  - {pose: left, time_s: 0.4, path: zmp}\n"));
  for (const Point& point : path) {
    EXPECT_LT((point.X_SRight.translation() - path.front().X_SRight.translation()).norm(), 5e-4);
    EXPECT_NEAR(point.com_S.z(), path.front().com_S.z(), 0.004);
  }
}

// The right foot rises while the left one carries; the arm moves beside it.
TEST_F(ZmpPath, MovesTheOtherFootAndTheArmsFromPoseToPose) {
  const std::vector<Point> path =
      points(parsed("  - {pose: left, time_s: 0.6, path: zmp}\n  - {pose: {from: lifted, left_elbow: -60}, "
                    "time_s: 0.5, path: zmp}\n"));
  EXPECT_NEAR(path.back().X_SRight.translation().z() - path.front().X_SRight.translation().z(), 0.020, 5e-4);
  EXPECT_NEAR(path.back().elbow_rad, -60.0 / 180.0 * 3.14159265, 1e-3);
  for (std::size_t k = 1; k < path.size(); ++k) EXPECT_LE(path[k].elbow_rad, path[k - 1].elbow_rad + 1e-9);
}

TEST_F(ZmpPath, TakesTheTimeOfItsMoves) {
  const MotionSource motion =
      parsed("  - {pose: left, time_s: 0.777, path: zmp, pause_s: 0.1}\n  - {wait_s: 1}\n");
  std::uint64_t sum_us = 0;
  for (const StepSource& step : motion.steps) sum_us += step.time_us + step.pause_us;
  EXPECT_EQ(sum_us, 1'000'000u + 777'000u + 100'000u + 1'000'000u);
}

TEST_F(ZmpPath, WarnsOfAZmpThatTheEndsAtRestKeepFromItsPath) {
  Diagnostics slow("a.yaml", "");
  parsed("  - {pose: left, time_s: 2, path: zmp}\n", &slow);
  EXPECT_EQ(slow.all().size(), 0u);
  Diagnostics fast("a.yaml", "");
  parsed("  - {pose: left, time_s: 0.2, path: zmp}\n", &fast);
  ASSERT_EQ(fast.all().size(), 1u);
  EXPECT_EQ(fast.all().front().code, "M053");
}

// A motion without such moves keeps its bytes.
TEST_F(ZmpPath, LeavesOtherMovesAlone) {
  const MotionSource motion = parsed("  - {pose: left, time_s: 0.4}\n");
  EXPECT_EQ(motion.steps.size(), 2u);
}

}  // namespace
}  // namespace koboshi::simulation
