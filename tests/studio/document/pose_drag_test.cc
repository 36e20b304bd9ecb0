#include "studio/document/pose_drag.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/fixed/host/convert.h"
#include "sim_board/description/hinge_tree.h"
#include "sim_board/description/load.h"
#include "tests/studio/document/sample_document.h"

namespace koboshi::studio {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kTargets = 200;
constexpr double kReached_m = 0.0005;
constexpr double kSupport_m = 0.0001;

// The bodies in double precision, from the robot's description: another way than that of the firmware.
class Bodies {
 public:
  Bodies()
      : robot_(sim_board::load_robot(KOBOSHI_SOURCE_DIR "/robots/koboshi/robot.sdf")),
        tree_(sim_board::hinge_tree(robot_)) {}

  // In the trunk's frame.
  Isometry3d pose(DragBody body, std::span<const double> angles_rad) const {
    const auto links = tree_.poses(Isometry3d::Identity(), angles_rad);
    return links[static_cast<std::size_t>(link(body))];
  }

 private:
  int link(DragBody body) const {
    const auto child = [&](const char* joint) {
      return robot_.joints[static_cast<std::size_t>(*robot_.find_joint(joint))].child;
    };
    switch (body) {
      case DragBody::kLeftFoot:
        return child("left_ankle_roll");
      case DragBody::kRightFoot:
        return child("right_ankle_roll");
      case DragBody::kLeftHand:
        return child("left_elbow");
      case DragBody::kRightHand:
        return child("right_elbow");
      default:
        return 0;
    }
  }

  sim_board::RobotDescription robot_;
  mechanics::HingeTree tree_;
};

const Bodies& bodies() {
  static const Bodies all;
  return all;
}

struct Dragged {
  DragBody body;
  DragSupport support = DragSupport::kBothFeet;  // of the trunk
};

class PoseDrags : public testing::TestWithParam<Dragged> {
 protected:
  DragBody body() const { return GetParam().body; }
  bool is_trunk() const { return body() == DragBody::kTrunk; }
  bool moves_over_both() const { return is_trunk() && GetParam().support == DragSupport::kBothFeet; }
  // A foot that stays while the trunk moves; of both feet the left one.
  DragBody support() const {
    return GetParam().support == DragSupport::kRightFoot ? DragBody::kRightFoot : DragBody::kLeftFoot;
  }
  const std::vector<double>& standing() const { return sample_robot()->standing_rad; }
  // A point of the body, off its origin.
  Vector3d point_L() const { return {0.01, -0.005, -0.02}; }
  Vector3d grabbed_B() const { return bodies().pose(body(), standing()) * point_L(); }
  PoseDrag drag() const { return {*sample_robot(), standing(), body(), grabbed_B(), GetParam().support}; }
  // Where the grabbed point is, in axes of the trunk at the start: for the trunk, as its support sees it.
  Vector3d point(const std::vector<double>& angles_rad) const {
    if (!is_trunk()) return bodies().pose(body(), angles_rad) * point_L();
    const Isometry3d X_BF0 = bodies().pose(support(), standing());
    const Isometry3d X_BF = bodies().pose(support(), angles_rad);
    return X_BF0 * X_BF.inverse() * point_L();
  }
  void expect_support_kept(const std::vector<double>& angles_rad) const {
    if (moves_over_both()) {
      const auto between = [](const std::vector<double>& angles) {
        return Isometry3d(bodies().pose(DragBody::kLeftFoot, angles).inverse() *
                          bodies().pose(DragBody::kRightFoot, angles));
      };
      const Isometry3d X = between(standing()).inverse() * between(angles_rad);
      EXPECT_LT(X.translation().norm(), kSupport_m);
      EXPECT_LT(Eigen::AngleAxisd(X.linear()).angle(), 1e-3);
    } else {
      // All others stay relative to the trunk, and so to the support foot.
      for (const DragBody other :
           {DragBody::kLeftFoot, DragBody::kRightFoot, DragBody::kLeftHand, DragBody::kRightHand}) {
        if (other == (is_trunk() ? support() : body())) continue;
        EXPECT_LT(
            (bodies().pose(other, angles_rad).translation() - bodies().pose(other, standing()).translation())
                .norm(),
            kSupport_m);
      }
    }
  }
  void expect_within_limits(const std::vector<double>& angles_rad) const {
    for (std::size_t joint = 0; joint < angles_rad.size(); ++joint) {
      const robot::Joint& model = sample_robot()->model.model.joints[joint];
      EXPECT_GE(angles_rad[joint], fixed::to_double(model.lower) - 1e-6);
      EXPECT_LE(angles_rad[joint], fixed::to_double(model.upper) + 1e-6);
    }
  }
  // A foot or the trunk that is moved keeps its orientation.
  void expect_oriented(const std::vector<double>& angles_rad) const {
    if (is_hand()) return;
    const auto seen = [&](const std::vector<double>& angles) {
      return Isometry3d(is_trunk() ? bodies().pose(support(), angles).inverse()
                                   : bodies().pose(body(), angles));
    };
    const Isometry3d before = seen(standing());
    EXPECT_LT(Eigen::AngleAxisd(before.linear().transpose() * seen(angles_rad).linear()).angle(), 2e-3);
  }
  bool is_hand() const { return body() == DragBody::kLeftHand || body() == DragBody::kRightHand; }
  // Another search than that of the drag: all poses of an arm on a grid of angles; of legs, places nearer to
  // the target around the one that was found, none of which may be reached.
  void expect_none_nearer(const PoseDrag& drag, const Vector3d& target, const DraggedPose& found) {
    if (is_hand()) {
      EXPECT_LE(found.missing_m, nearest_on_grid_m(drag, target) + 1e-5);
      return;
    }
    const Vector3d reached = point(found.angles_rad) - grabbed_B();
    for (int i = 0; i < 40; ++i) {
      const Vector3d tried = reached + (0.001 + 0.0005 * i) * random_direction();
      if ((tried - target).norm() > found.missing_m - 0.0005) continue;
      EXPECT_FALSE(drag.move(tried).reached) << "nearer by " << found.missing_m - (tried - target).norm();
    }
  }
  double nearest_on_grid_m(const PoseDrag& drag, const Vector3d& target) const {
    constexpr int kPlaces = 31;
    std::vector<std::size_t> joints;
    for (std::size_t joint = 0; joint < standing().size(); ++joint)
      if ((drag.joints() >> joint & 1U) != 0) joints.push_back(joint);
    std::vector<double> angles_rad = standing();
    double nearest_m = 1.0;
    int count = 1;
    for (std::size_t i = 0; i < joints.size(); ++i) count *= kPlaces;
    for (int n = 0; n < count; ++n) {
      int rest = n;
      for (const std::size_t joint : joints) {
        const robot::Joint& model = sample_robot()->model.model.joints[joint];
        const double lower_rad = fixed::to_double(model.lower);
        const double share = static_cast<double>(rest % kPlaces) / (kPlaces - 1);
        angles_rad[joint] = lower_rad + share * (fixed::to_double(model.upper) - lower_rad);
        rest /= kPlaces;
      }
      nearest_m = std::min(nearest_m, (point(angles_rad) - grabbed_B() - target).norm());
    }
    return nearest_m;
  }
  std::mt19937 random_{7};
  Vector3d random_direction() {
    std::normal_distribution<double> normal;
    return Vector3d(normal(random_), normal(random_), normal(random_)).normalized();
  }
};

TEST_P(PoseDrags, ReachTargetsWithinReachAndKeepTheSupport) {
  const PoseDrag drag = this->drag();
  std::uniform_real_distribution<double> turn(-0.3, 0.3);
  int reached = 0;
  for (int i = 0; i < kTargets; ++i) {
    // Within reach by construction: where a pose near the standing pose has the point.
    std::vector<double> angles_rad = standing();
    for (std::size_t joint = 0; joint < angles_rad.size(); ++joint) {
      const robot::Joint& model = sample_robot()->model.model.joints[joint];
      if ((drag.joints() >> joint & 1U) == 0) continue;
      angles_rad[joint] = std::clamp(angles_rad[joint] + turn(random_), fixed::to_double(model.lower),
                                     fixed::to_double(model.upper));
    }
    Vector3d displacement = point(angles_rad) - grabbed_B();
    Vector3d rotation = Vector3d::Zero();
    if (!is_trunk() && !is_hand()) {
      const Eigen::AngleAxisd turned(bodies().pose(body(), angles_rad).linear() *
                                     bodies().pose(body(), standing()).linear().transpose());
      rotation = turned.angle() * turned.axis();
    } else if (is_trunk()) {
      displacement = 0.012 * random_direction();
      displacement.z() = -std::abs(displacement.z());
      rotation = 0.05 * random_direction();
    }
    const DraggedPose pose = drag.move(displacement, rotation);
    expect_support_kept(pose.angles_rad);
    expect_within_limits(pose.angles_rad);
    if (!pose.reached) continue;
    ++reached;
    EXPECT_LT((point(pose.angles_rad) - grabbed_B() - displacement).norm(), kReached_m);
  }
  EXPECT_EQ(reached, kTargets);
}

TEST_P(PoseDrags, GoToTheNearestReachablePoseWithoutJumps) {
  // Between targets 2 mm apart. The elbow turns most: at the stretched arm, 0.2 mm of reach are 0.2 rad.
  constexpr double kMaxJump_rad = 0.35;
  constexpr double kPitch_m = 0.002;
  constexpr double kFar_m = 0.4;
  const PoseDrag drag = this->drag();
  for (int i = 0; i < 3; ++i) {
    const Vector3d direction = random_direction();
    const Vector3d along = direction.unitOrthogonal();
    std::vector<double> before;
    for (int k = 0; k < 20; ++k) {
      const Vector3d target = kFar_m * direction + k * kPitch_m * along;
      const DraggedPose pose = drag.move(target);
      EXPECT_FALSE(pose.reached);
      expect_support_kept(pose.angles_rad);
      expect_within_limits(pose.angles_rad);
      EXPECT_NEAR((point(pose.angles_rad) - grabbed_B() - target).norm(), pose.missing_m, kReached_m);
      for (std::size_t joint = 0; joint < before.size(); ++joint)
        EXPECT_LT(std::abs(pose.angles_rad[joint] - before[joint]), kMaxJump_rad)
            << sample_robot()->model.joint_names[joint] << " of target " << i << ' ' << k;
      before = pose.angles_rad;
      expect_oriented(pose.angles_rad);
      if (k == 0) expect_none_nearer(drag, target, pose);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, PoseDrags,
                         testing::Values(Dragged{DragBody::kTrunk},
                                         Dragged{DragBody::kTrunk, DragSupport::kLeftFoot},
                                         Dragged{DragBody::kTrunk, DragSupport::kRightFoot},
                                         Dragged{DragBody::kLeftFoot}, Dragged{DragBody::kRightFoot},
                                         Dragged{DragBody::kLeftHand}, Dragged{DragBody::kRightHand}));

TEST(PoseDrag, NamesTheJointAtItsLimit) {
  const auto& standing = sample_robot()->standing_rad;
  const Vector3d foot = bodies().pose(DragBody::kLeftFoot, standing).translation();
  const PoseDrag drag(*sample_robot(), standing, DragBody::kLeftFoot, foot);
  const DraggedPose pose = drag.move({0.0, 0.0, 0.0}, {2.0, 0.0, 0.0});
  EXPECT_FALSE(pose.reached);
  EXPECT_TRUE(std::ranges::find(pose.at_limit, joint_of("left_ankle_roll")) != pose.at_limit.end());
}

TEST(PoseDrag, TurnsAsFarAsItCanAndKeepsTheGrabbedPoint) {
  const auto& standing = sample_robot()->standing_rad;
  const Vector3d foot = bodies().pose(DragBody::kRightFoot, standing).translation();
  const PoseDrag drag(*sample_robot(), standing, DragBody::kRightFoot, foot);
  const DraggedPose pose = drag.move(Vector3d::Zero(), {0.0, 0.0, 2.5});
  EXPECT_FALSE(pose.reached);
  EXPECT_GT(pose.missing_rad, 0.1);
  EXPECT_EQ(pose.missing_m, 0.0);
  const Isometry3d X = bodies().pose(DragBody::kRightFoot, pose.angles_rad);
  EXPECT_LT((X.translation() - foot).norm(), kReached_m);
  const Eigen::AngleAxisd turned(X.linear() *
                                 bodies().pose(DragBody::kRightFoot, standing).linear().transpose());
  EXPECT_NEAR(pose.missing_rad + turned.angle() * turned.axis().z(), 2.5, 0.15);
}

// The orientation after 4.5 rad is that after -1.8 rad.
TEST(PoseDrag, StaysAtItsLimitBeyondHalfATurn) {
  const auto& standing = sample_robot()->standing_rad;
  const Vector3d foot = bodies().pose(DragBody::kRightFoot, standing).translation();
  const PoseDrag drag(*sample_robot(), standing, DragBody::kRightFoot, foot);
  const DraggedPose half = drag.move(Vector3d::Zero(), {0.0, 0.0, 3.14});
  const DraggedPose beyond = drag.move(Vector3d::Zero(), {0.0, 0.0, 4.5});
  EXPECT_FALSE(beyond.reached);
  EXPECT_NEAR(beyond.missing_rad - half.missing_rad, 4.5 - 3.14, 0.01);
  for (std::size_t joint = 0; joint < standing.size(); ++joint)
    EXPECT_NEAR(beyond.angles_rad[joint], half.angles_rad[joint], 0.01)
        << sample_robot()->model.joint_names[joint];
}

// Aside, the leg of the other foot is too short: the trunk reaches the place only over the foot on that side.
TEST(PoseDrag, OverOneFootReachesFartherThanOverBoth) {
  const auto& standing = sample_robot()->standing_rad;
  const auto reached = [&](DragSupport support, double left_m) {
    return PoseDrag(*sample_robot(), standing, DragBody::kTrunk, Vector3d::Zero(), support)
        .move({0.0, left_m, 0.0})
        .reached;
  };
  for (const double left_m : {0.05, -0.05}) {
    EXPECT_FALSE(reached(DragSupport::kBothFeet, left_m));
    EXPECT_EQ(reached(DragSupport::kLeftFoot, left_m), left_m > 0.0);
    EXPECT_EQ(reached(DragSupport::kRightFoot, left_m), left_m < 0.0);
  }
}

TEST(PoseDrag, WithoutADisplacementChangesNothing) {
  const auto& standing = sample_robot()->standing_rad;
  const PoseDrag drag(*sample_robot(), standing, DragBody::kTrunk, Vector3d::Zero());
  const DraggedPose pose = drag.move(Vector3d::Zero());
  for (std::size_t joint = 0; joint < standing.size(); ++joint)
    EXPECT_NEAR(pose.angles_rad[joint], standing[joint], 0.01 * kDegree);
}

}  // namespace
}  // namespace koboshi::studio
