#include "mechanics/hinge_tree.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/unit/mechanics/random_tree.h"

namespace koboshi::mechanics {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// 0 - 1 - 2 - 3 and 1 - 4 - 5; the hinges are in no order.
HingeTree forked() {
  return {std::vector<Link>(6, Link{.mass_kg = 1.0}), {{4, 5}, {1, 2}, {0, 1}, {2, 3}, {1, 4}}};
}

TEST(HingeTree, CountsTheHingesBetweenLinks) {
  const HingeTree tree = forked();
  EXPECT_EQ(tree.distance(0, 0), 0);
  EXPECT_EQ(tree.distance(0, 3), 3);
  EXPECT_EQ(tree.distance(3, 5), 4);
  EXPECT_EQ(tree.distance(5, 3), 4);
  EXPECT_EQ(tree.distance(1, 5), 2);
}

TEST(HingeTree, CarriesALinkAndAllThatHangOnIt) {
  const HingeTree tree = forked();
  EXPECT_TRUE(tree.carries(1, 1));
  EXPECT_TRUE(tree.carries(0, 5));
  EXPECT_TRUE(tree.carries(1, 3));
  EXPECT_FALSE(tree.carries(3, 1));
  EXPECT_FALSE(tree.carries(2, 5));
  EXPECT_FALSE(tree.carries(4, 2));
}

TEST(HingeTree, OrdersParentsBeforeChildren) {
  const HingeTree tree = forked();
  std::vector<bool> is_placed{true, false, false, false, false, false};
  for (const std::size_t index : tree.hinges_from_root()) {
    EXPECT_TRUE(is_placed[tree.hinges()[index].parent]) << index;
    is_placed[tree.hinges()[index].child] = true;
  }
  EXPECT_EQ(is_placed, std::vector<bool>(6, true));
}

TEST(HingeTree, RefusesWhatIsNoTree) {
  const std::vector<Link> links(3);
  EXPECT_THROW(HingeTree({}, {}), std::invalid_argument);
  EXPECT_THROW(HingeTree(links, {{0, 1}}), std::invalid_argument);                  // a link is apart
  EXPECT_THROW(HingeTree(links, {{0, 1}, {0, 1}}), std::invalid_argument);          // the same twice
  EXPECT_THROW(HingeTree(links, {{0, 1}, {2, 1}}), std::invalid_argument);          // two parents
  EXPECT_THROW(HingeTree(links, {{0, 1}, {1, 2}, {2, 0}}), std::invalid_argument);  // a loop
  EXPECT_THROW(HingeTree(links, {{0, 1}, {1, 3}}), std::invalid_argument);          // no such link
  EXPECT_THROW(HingeTree(links, {{0, 1}, {3, 2}}), std::invalid_argument);
}

TEST(HingeTree, PlacesCoupledHingesByTheirLeaders) {
  sim_board::RandomStream random(2, "couplings");
  for (int trial = 0; trial < 20; ++trial) {
    const HingeTree whole = random_tree(random, 12);
    const std::vector<Hinge> hinges(whole.hinges().begin(), whole.hinges().end());
    const std::vector<Coupling> couplings{{random.bits() % 9, -0.7, 0.2}, {random.bits() % 9, 1.5, 0.0}};
    const HingeTree tree({whole.links().begin(), whole.links().end()}, hinges, couplings);
    ASSERT_EQ(tree.free_hinges(), 9U);
    std::vector<double> positions_rad = random_numbers(random, 9, 2.0);
    const auto X_WLs = tree.poses(Isometry3d::Identity(), positions_rad);
    for (const Coupling& coupling : couplings)
      positions_rad.push_back(coupling.multiplier * positions_rad[coupling.leader] + coupling.offset_rad);
    const auto expected = whole.poses(Isometry3d::Identity(), positions_rad);
    for (std::size_t l = 0; l < expected.size(); ++l) ASSERT_TRUE(X_WLs[l].isApprox(expected[l], 1e-12));
  }
  const std::vector<Link> links(3);
  EXPECT_THROW(HingeTree(links, {{0, 1}, {0, 2}}, {{1, 1.0, 0.0}}), std::invalid_argument);  // follows itself
  EXPECT_THROW(HingeTree(links, {{0, 1}, {0, 2}}, {{0}, {0}, {0}}), std::invalid_argument);
}

TEST(HingeTree, PlacesTheLinksOfRandomTrees) {
  sim_board::RandomStream random(1, "trees");
  for (int trial = 0; trial < 50; ++trial) {
    const std::size_t links = 1 + random.bits() % 32;
    const HingeTree tree = random_tree(random, links);
    const auto positions_rad = random_numbers(random, links - 1, 3.0);
    const Isometry3d X_WB =
        Eigen::Translation3d(0.1, -2.0, 0.3) * Eigen::AngleAxisd(1.0, Vector3d(1.0, 2.0, 2.0) / 3.0);
    const auto X_WLs = tree.poses(X_WB, positions_rad);
    Vector3d moment = Vector3d::Zero();
    double mass_kg = 0.0;
    for (std::size_t l = 0; l < links; ++l) {
      const Isometry3d expected = X_WB * reference_pose(tree, l, positions_rad);
      ASSERT_TRUE(X_WLs[l].isApprox(expected, 1e-12)) << trial << ", link " << l;
      moment += tree.links()[l].mass_kg * (expected * tree.links()[l].p_LCom_L);
      mass_kg += tree.links()[l].mass_kg;
    }
    EXPECT_LT((tree.centre_of_mass(X_WLs) - moment / mass_kg).norm(), 1e-12);
    EXPECT_NEAR(tree.mass_kg(), mass_kg, 1e-12);
  }
}

}  // namespace
}  // namespace koboshi::mechanics
