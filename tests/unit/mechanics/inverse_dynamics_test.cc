#include "mechanics/inverse_dynamics.h"

#include <gtest/gtest.h>

#include "tests/support/allocations.h"
#include "tests/unit/mechanics/random_tree.h"

namespace koboshi::mechanics {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kStep_s = 1e-4;
constexpr double kStep_rad = 1e-5;

Vector3d rotation_vector(const Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

// A motion with constant accelerations, of which one link is at rest, by differences of poses.
struct Motion {
  const HingeTree& tree;
  std::vector<double> positions_rad, speeds, accelerations;
  std::size_t at_rest;

  std::vector<double> positions_at(double time_s) const {
    std::vector<double> result = positions_rad;
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] += time_s * (speeds[i] + 0.5 * time_s * accelerations[i]);
    return result;
  }
  // In the frame of the link at rest.
  Isometry3d pose(std::size_t link, const std::vector<double>& positions) const {
    return reference_pose(tree, at_rest, positions).inverse() * reference_pose(tree, link, positions);
  }
  Isometry3d pose_at(std::size_t link, double time_s) const { return pose(link, positions_at(time_s)); }
  Vector3d com_at(std::size_t link, double time_s) const {
    return pose_at(link, time_s) * tree.links()[link].p_LCom_L;
  }
  Vector3d spin_at(std::size_t link, double time_s) const {
    const Matrix3d before = pose_at(link, time_s - kStep_s).linear();
    return rotation_vector(pose_at(link, time_s + kStep_s).linear() * before.transpose()) / (2.0 * kStep_s);
  }
  Vector3d angular_momentum_at(std::size_t link, double time_s) const {
    const Matrix3d R = pose_at(link, time_s).linear();
    return R * tree.links()[link].I_LCom_L * R.transpose() * spin_at(link, time_s);
  }
  Vector3d force(std::size_t link, const Vector3d& gravity) const {
    const Vector3d acceleration =
        (com_at(link, kStep_s) - 2.0 * com_at(link, 0.0) + com_at(link, -kStep_s)) / (kStep_s * kStep_s);
    return tree.links()[link].mass_kg * (acceleration - gravity);
  }
  Vector3d moment(std::size_t link) const {
    return (angular_momentum_at(link, kStep_s) - angular_momentum_at(link, -kStep_s)) / (2.0 * kStep_s);
  }
};

class RandomMotion : public testing::TestWithParam<int> {
 protected:
  std::size_t size_ = 2 + random_.bits() % 12;
  HingeTree tree_ = random_tree(random_, size_);
  Motion motion_{tree_, random_numbers(random_, size_ - 1, 2.0), random_numbers(random_, size_ - 1, 2.0),
                 random_numbers(random_, size_ - 1, 5.0), random_.bits() % size_};
  Vector3d gravity_B_{1.0, -3.0, -9.0};
  // The same in the frame of the link at rest.
  Isometry3d X_BF_ = reference_pose(tree_, motion_.at_rest, motion_.positions_rad);
  Vector3d gravity_F_ = X_BF_.linear().transpose() * gravity_B_;
  InverseDynamics dynamics_{tree_};

 private:
  sim_board::RandomStream random_{static_cast<std::uint64_t>(GetParam()), "motion"};
};

TEST_P(RandomMotion, NeedsTheForcesOfItsMomenta) {
  dynamics_.place(motion_.positions_rad);
  const Vector6 sum =
      dynamics_.find_forces(motion_.speeds, motion_.accelerations, motion_.at_rest, gravity_B_);
  Vector6 expected = Vector6::Zero();
  for (std::size_t l = 0; l < size_; ++l) {
    const Vector3d f_B = X_BF_.linear() * motion_.force(l, gravity_F_);
    expected += spatial_force(X_BF_ * motion_.com_at(l, 0.0), f_B);
    expected.head<3>() += X_BF_.linear() * motion_.moment(l);
  }
  EXPECT_LT((sum - expected).norm(), 1e-4 * (1.0 + expected.norm()));
}

// The work of the torques in a virtual displacement of one hinge is that of the forces on the links, less
// that of a supporting force. The link at rest, which supplies the rest of the force, has no displacement.
TEST_P(RandomMotion, NeedsTheTorquesOfVirtualWork) {
  dynamics_.place(motion_.positions_rad);
  const Vector6 sum =
      dynamics_.find_forces(motion_.speeds, motion_.accelerations, motion_.at_rest, gravity_B_);
  const std::size_t supported = size_ - 1;
  const Vector3d support_N(1.0, 2.0, 3.0);
  const Vector3d place_L(0.1, 0.0, -0.1);
  const Vector6 support = spatial_force(dynamics_.X_BLs()[supported] * place_L, support_N);
  dynamics_.support(supported, support);
  dynamics_.support(motion_.at_rest, sum - support);
  std::vector<double> torques_Nm(size_ - 1);
  dynamics_.find_torques(torques_Nm);
  const Isometry3d X_FB = X_BF_.inverse();
  for (std::size_t i = 0; i < torques_Nm.size(); ++i) {
    std::vector<double> before = motion_.positions_rad, after = motion_.positions_rad;
    before[i] -= kStep_rad;
    after[i] += kStep_rad;
    double work_Nm = 0.0;
    for (std::size_t l = 0; l < size_; ++l) {
      const Isometry3d X_before = motion_.pose(l, before);
      const Isometry3d X_after = motion_.pose(l, after);
      const Vector3d way = (X_after * tree_.links()[l].p_LCom_L - X_before * tree_.links()[l].p_LCom_L);
      const Vector3d turn = rotation_vector(X_after.linear() * X_before.linear().transpose());
      work_Nm += motion_.force(l, gravity_F_).dot(way) + motion_.moment(l).dot(turn);
      if (l == supported) work_Nm -= (X_FB.linear() * support_N).dot(X_after * place_L - X_before * place_L);
    }
    work_Nm /= 2.0 * kStep_rad;
    EXPECT_NEAR(torques_Nm[i], work_Nm, 1e-4 * (1.0 + std::abs(work_Nm))) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(, RandomMotion, testing::Range(1, 13));

TEST(InverseDynamics, AllocatesOnlyWhenItIsMade) {
  sim_board::RandomStream random(1, "tree");
  const HingeTree tree = random_tree(random, 20);
  InverseDynamics dynamics(tree);
  const std::vector<double> numbers(19, 0.5);
  std::vector<double> torques_Nm(19);
  const long before = test::allocations();
  dynamics.place(numbers);
  const Vector6 sum = dynamics.find_forces(numbers, numbers, 3, -9.81 * Vector3d::UnitZ());
  dynamics.support(3, sum);
  dynamics.find_torques(torques_Nm);
  EXPECT_EQ(test::allocations(), before);
}

// The motor of a hinge supplies the power of those that follow it.
TEST(InverseDynamics, AddsTheTorqueOfAFollowerToItsLeader) {
  sim_board::RandomStream random(3, "coupled");
  const HingeTree whole = random_tree(random, 8);
  const std::vector<Hinge> hinges(whole.hinges().begin(), whole.hinges().end());
  const Coupling coupling{.leader = 2, .multiplier = -0.6, .offset_rad = 0.3};
  InverseDynamics coupled(HingeTree({whole.links().begin(), whole.links().end()}, hinges, {coupling}));
  InverseDynamics free(whole);
  std::vector<double> positions_rad = random_numbers(random, 6, 2.0);
  std::vector<double> speeds = random_numbers(random, 6, 2.0);
  std::vector<double> accelerations = random_numbers(random, 6, 5.0);
  std::vector<double> torques_Nm(6);
  const Vector3d gravity_B(1.0, -3.0, -9.0);
  coupled.place(positions_rad);
  coupled.support(0, coupled.find_forces(speeds, accelerations, 0, gravity_B));
  coupled.find_torques(torques_Nm);
  positions_rad.push_back(coupling.multiplier * positions_rad[2] + coupling.offset_rad);
  speeds.push_back(coupling.multiplier * speeds[2]);
  accelerations.push_back(coupling.multiplier * accelerations[2]);
  std::vector<double> all_Nm(7);
  free.place(positions_rad);
  free.support(0, free.find_forces(speeds, accelerations, 0, gravity_B));
  free.find_torques(all_Nm);
  ASSERT_GT(std::abs(all_Nm[6]), 0.01);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(torques_Nm[i], all_Nm[i] + (i == 2 ? coupling.multiplier * all_Nm[6] : 0.0), 1e-12) << i;
}

}  // namespace
}  // namespace koboshi::mechanics
