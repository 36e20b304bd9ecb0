#include "sim_board/sensor/pressure_cells.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace koboshi::sim_board {
namespace {

const CellPlaces kPlaces{Eigen::Vector2d(0.05, 0.02), Eigen::Vector2d(0.06, -0.025),
                         Eigen::Vector2d(-0.03, 0.022), Eigen::Vector2d(-0.04, -0.02)};

Eigen::Vector3d wrench_of(const CellForces& forces) {
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < forces.size(); ++i)
    wrench += forces[i] * Eigen::Vector3d(1.0, kPlaces[i].x(), kPlaces[i].y());
  return wrench;
}

// A point inside of the cells is a mean of them with weights of 0 or more.
TEST(PressureCellForces, BalanceALoadBetweenThem) {
  std::mt19937 random(45);
  for (int trial = 0; trial < 5'000; ++trial) {
    Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
    double sum = 0.0;
    for (const Eigen::Vector2d& place : kPlaces) {
      const double weight = std::exponential_distribution(1.0)(random);
      point_m += weight * place;
      sum += weight;
    }
    point_m /= sum;
    const CellForces forces = distribute_load(kPlaces, 7.0, point_m);
    for (const double force_N : forces) EXPECT_GE(force_N, 0.0);
    EXPECT_LT((wrench_of(forces) - 7.0 * Eigen::Vector3d(1.0, point_m.x(), point_m.y())).norm(), 1e-9);
  }
}

TEST(PressureCellForces, BearALoadBesideThem) {
  const CellForces forces = distribute_load(kPlaces, 7.0, {0.12, 0.02});
  EXPECT_NEAR(std::accumulate(forces.begin(), forces.end(), 0.0), 7.0, 1e-9);
  EXPECT_GT(wrench_of(forces)[1], 7.0 * 0.045);  // on the front edge
  for (const double force_N : forces) EXPECT_GE(force_N, 0.0);
}

// The part of the moments that two cells cannot bear is missing; along their line they are in balance.
TEST(PressureCellForces, OfTwoCellsBalanceTheMomentAlongTheirLine) {
  const Eigen::Vector2d line_m = kPlaces[1] - kPlaces[0];
  const Eigen::Vector2d ahead = Eigen::Vector2d(-line_m.y(), line_m.x()).normalized();
  for (const double share : {0.2, 0.5, 0.8}) {
    const CellForces forces = distribute_load(kPlaces, 7.0, kPlaces[0] + share * line_m + 0.1 * ahead);
    EXPECT_NEAR(forces[0], (1.0 - share) * 7.0, 1e-9);
    EXPECT_NEAR(forces[1], share * 7.0, 1e-9);
    EXPECT_EQ(forces[2], 0.0);
    EXPECT_EQ(forces[3], 0.0);
  }
}

TEST(PressureCellForces, OfOneCellBearALoadBeyondIt) {
  const CellForces forces = distribute_load(kPlaces, 7.0, kPlaces[1] + 0.2 * (kPlaces[1] - kPlaces[2]));
  EXPECT_NEAR(forces[1], 7.0, 1e-9);
  EXPECT_NEAR(std::accumulate(forces.begin(), forces.end(), 0.0), 7.0, 1e-9);
}

TEST(PressureCellForces, AreZeroWithoutALoad) {
  for (const double load_N : {0.0, -1.0})
    for (const double force_N : distribute_load(kPlaces, load_N, {0, 0})) EXPECT_EQ(force_N, 0.0);
}

}  // namespace
}  // namespace koboshi::sim_board
