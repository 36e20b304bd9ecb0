#include "sim_board/world/link_tree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/sample_robots.h"

namespace koboshi::sim_board {
namespace {

TEST(LinkTree, CountsTheJointsBetweenLinks) {
  const RobotDescription robot = sample_humanoid();
  const LinkTree tree(robot);
  EXPECT_EQ(tree.distance(0, 0), 0);
  EXPECT_EQ(tree.distance(0, 6), 6);    // trunk to left foot
  EXPECT_EQ(tree.distance(6, 12), 12);  // foot to foot
  EXPECT_EQ(tree.distance(12, 6), 12);
  EXPECT_EQ(tree.distance(4, 6), 2);
}

TEST(LinkTree, PosesDoNotDependOnTheOrderOfJoints) {
  RobotDescription robot = sample_humanoid();
  std::vector<double> positions;
  for (int j = 0; j < 20; ++j) positions.push_back(0.05 * j - 0.3);
  const Eigen::Isometry3d X_WB(Eigen::Translation3d(0.1, 0.2, 0.3));
  const auto forwards = LinkTree(robot).poses(robot, X_WB, positions);
  std::reverse(robot.joints.begin(), robot.joints.end());
  std::reverse(positions.begin(), positions.end());
  const auto backwards = LinkTree(robot).poses(robot, X_WB, positions);
  for (std::size_t l = 0; l < forwards.size(); ++l)
    EXPECT_TRUE(forwards[l].isApprox(backwards[l], 1e-14)) << l;
}

TEST(LinkTree, BendsAKneeAsTrigonometryPredicts) {
  const RobotDescription robot = sample_humanoid();
  std::vector<double> positions(20, 0.0);
  positions[2] = -0.5;  // left hip pitch
  positions[3] = 1.0;   // left knee
  const auto X_WLs = LinkTree(robot).poses(robot, Eigen::Isometry3d::Identity(), positions);
  const Eigen::Vector3d ankle = X_WLs[5].translation();
  EXPECT_NEAR(ankle.x(), 0.0, 1e-12);  // thigh forward, shank back
  EXPECT_NEAR(ankle.z(), -2 * 0.065 * std::cos(0.5), 1e-12);
}

}  // namespace
}  // namespace koboshi::sim_board
