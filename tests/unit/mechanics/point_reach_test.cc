#include "mechanics/point_reach.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "mechanics/hinge_tree.h"
#include "sim_board/random/random_stream.h"
#include "tests/support/allocations.h"
#include "tests/unit/mechanics/random_tree.h"

namespace koboshi::mechanics {
namespace {

using Eigen::Vector3d;
using sim_board::RandomStream;

constexpr double kNear_m = 1e-5;

// An arm of three hinges in one plane, each 0.1 m from the next, the point 0.1 m behind the last.
PointChain plane_arm(double limit_rad) {
  PointChain chain;
  for (int i = 0; i < 3; ++i)
    chain.hinges.push_back({.anchor_P = i == 0 ? Vector3d(0.0, 0.2, 0.3) : Vector3d(0.1, 0.0, 0.0),
                            .axis_P = Vector3d::UnitY(),
                            .lower_rad = -limit_rad,
                            .upper_rad = limit_rad});
  chain.tip = {0.1, 0.0, 0.0};
  return chain;
}

TEST(PointReach, PlacesThePointAsATreeOfTheSameHinges) {
  RandomStream random(5, "chains");
  for (std::size_t size = 1; size <= PointChain::kMaxHinges; ++size) {
    PointChain chain;
    std::vector<Link> links(size + 1);
    std::vector<Hinge> hinges;
    std::vector<double> positions_rad;
    Vector3d anchor = Vector3d::Zero();
    for (std::size_t i = 0; i < size; ++i) {
      chain.hinges.push_back(
          {random_vector(random, 0.2), random_vector(random, 1.0).normalized(), -3.0, 3.0});
      anchor += chain.hinges.back().anchor_P;
      links[i + 1].X_ML = Eigen::Translation3d(anchor);
      hinges.push_back({i, i + 1, anchor, chain.hinges.back().axis_P});
      positions_rad.push_back(random.within(3.0));
    }
    chain.tip = random_vector(random, 0.2);
    const auto X_WLs = HingeTree(links, hinges).poses(Eigen::Isometry3d::Identity(), positions_rad);
    EXPECT_LT((chain.tip_at(positions_rad) - X_WLs[size] * chain.tip).norm(), 1e-13) << size;
  }
}

TEST(PointReach, ReachesPlacesOfRandomPosesNearby) {
  RandomStream random(7, "arms");
  const PointChain chain = plane_arm(2.5);
  for (int trial = 0; trial < 100; ++trial) {
    std::array<double, 3> there{}, q{};
    for (std::size_t i = 0; i < 3; ++i) {
      there[i] = 0.8 + random.within(0.5);
      q[i] = there[i] + random.within(0.3);
    }
    EXPECT_LT(reach_point(chain, chain.tip_at(there), q), kNear_m) << trial;
    EXPECT_LT((chain.tip_at(q) - chain.tip_at(there)).norm(), kNear_m) << trial;
  }
}

// Beyond the reach, the damped steps end within a millimetre of the nearest pose.
TEST(PointReach, LeavesTheDistanceOfATargetOutOfReach) {
  const PointChain chain = plane_arm(2.5);
  std::array<double, 3> q{0.3, -0.4, 0.2};
  EXPECT_NEAR(reach_point(chain, {0.5, 0.2, 0.3}, q), 0.2, 1e-3);  // straight ahead, 0.3 m long
  std::array<double, 3> aside{0.3, -0.4, 0.2};
  EXPECT_NEAR(reach_point(chain, {0.2, 0.7, 0.3}, aside), 0.5, 1e-3);  // aside from the plane
}

// At +-0.3 rad each, the point comes down as far as all hinges at their limits let it.
TEST(PointReach, StaysWithinTheLimits) {
  const double limit_rad = 0.3;
  const PointChain chain = plane_arm(limit_rad);
  const std::array<double, 3> all{limit_rad, limit_rad, limit_rad};
  const Vector3d lowest = chain.tip_at(all);
  std::array<double, 3> q{0.0, 0.1, 0.0};
  const Vector3d target = lowest - Vector3d(0.0, 0.0, 0.05);
  EXPECT_NEAR(reach_point(chain, target, q), 0.05, 2e-3);
  for (const double position_rad : q) EXPECT_LE(position_rad, limit_rad);
}

TEST(PointReach, AllocatesNothing) {
  const PointChain chain = plane_arm(2.5);
  std::array<double, 3> q{0.3, -0.4, 0.2};
  const long before = test::allocations();
  EXPECT_LT(reach_point(chain, chain.tip_at(std::array{0.5, 0.5, 0.5}), q), kNear_m);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace koboshi::mechanics
