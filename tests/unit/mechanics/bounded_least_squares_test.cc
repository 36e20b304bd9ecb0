#include "mechanics/bounded_least_squares.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim_board/random/random_stream.h"
#include "tests/support/allocations.h"

namespace koboshi::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using sim_board::RandomStream;

MatrixXd random_matrix(RandomStream& random, Eigen::Index rows, Eigen::Index columns) {
  return MatrixXd::NullaryExpr(rows, columns, [&] { return random.normal(); });
}

// Karush, Kuhn and Tucker: the cost falls in no direction that the bounds permit.
TEST(BoundedLeastSquares, FindsTheMinimumOfALinearProblem) {
  RandomStream random(3, "problems");
  for (int trial = 0; trial < 200; ++trial) {
    const MatrixXd A = random_matrix(random, 6, 4);
    const VectorXd b = random_matrix(random, 6, 1);
    VariableBounds bounds{VectorXd::Constant(4, -0.5), VectorXd::Constant(4, 0.7)};
    bounds.lower[trial % 4] = 0.0;
    VectorXd q = VectorXd::Constant(4, 0.1);
    BoundedLeastSquares solver(4, 0, 6);
    solver.minimise([&](const VectorXd& at, Residuals& r) { r.soft = 0.05 * (A * at - b); }, bounds, q);
    const VectorXd slope = A.transpose() * (A * q - b);
    for (Eigen::Index k = 0; k < 4; ++k) {
      ASSERT_GE(q[k], bounds.lower[k]);
      ASSERT_LE(q[k], bounds.upper[k]);
      if (q[k] > bounds.lower[k] + 1e-9) {
        ASSERT_LT(slope[k], 1e-4) << trial;
      }
      if (q[k] < bounds.upper[k] - 1e-9) {
        ASSERT_GT(slope[k], -1e-4) << trial;
      }
    }
  }
}

// A point on a circle, as near as possible to one that is far outside, or that the bound keeps away.
TEST(BoundedLeastSquares, KeepsWhatHasToVanish) {
  const auto circle = [](const VectorXd& q, Residuals& r) {
    r.hard[0] = 0.5 * (q.squaredNorm() - 0.09);
    r.soft[0] = q[0] - 0.8;
    r.soft[1] = q[1] - 0.6;
  };
  BoundedLeastSquares solver(2, 1, 2);
  VectorXd q = VectorXd::Constant(2, 0.1);
  VariableBounds bounds{VectorXd::Constant(2, -1.0), VectorXd::Constant(2, 1.0)};
  solver.minimise(circle, bounds, q);
  EXPECT_NEAR(q[0], 0.24, 1e-5);
  EXPECT_NEAR(q[1], 0.18, 1e-5);
  bounds.upper[0] = 0.2;
  q = VectorXd::Constant(2, 0.1);
  solver.minimise(circle, bounds, q);
  EXPECT_NEAR(q[0], 0.2, 1e-6);
  EXPECT_NEAR(q[1], std::sqrt(0.09 - 0.04), 1e-5);
}

TEST(BoundedLeastSquares, AllocatesOnlyWhenItIsMade) {
  BoundedLeastSquares solver(3, 1, 3);
  const BoundedLeastSquares::Function function = [](const VectorXd& q, Residuals& r) {
    r.hard[0] = q.sum() - 0.3;
    for (Eigen::Index i = 0; i < 3; ++i) r.soft[i] = std::sin(q[i]) - 0.2;
  };
  const VariableBounds bounds{VectorXd::Constant(3, -1.0), VectorXd::Constant(3, 0.15)};
  VectorXd q = VectorXd::Zero(3);
  const long before = test::allocations();
  solver.minimise(function, bounds, q);
  EXPECT_EQ(test::allocations(), before);
  EXPECT_NEAR(q.sum(), 0.3, 1e-6);
}

}  // namespace
}  // namespace koboshi::mechanics
