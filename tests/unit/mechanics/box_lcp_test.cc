#include "mechanics/box_lcp.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim_board/random/random_stream.h"

namespace koboshi::mechanics {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Problem {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  std::vector<BoxLcp::Bounds> bounds;
};

// A of this rank plus `softness` on the diagonal, as contacts have that share a body. Of four rows, one has
// no bounds, one a lower one, two have both.
Problem random_problem(sim_board::RandomStream& random, Eigen::Index rows, Eigen::Index rank,
                       double softness) {
  Eigen::MatrixXd J(rows, rank);
  for (double& value : J.reshaped()) value = random.within(1.0);
  Problem problem{
      J * J.transpose() + softness * Eigen::MatrixXd::Identity(rows, rows), Eigen::VectorXd(rows), {}};
  for (double& value : problem.b) value = random.within(1.0);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double bound = 0.5 * random.uniform();
    problem.bounds.push_back({i % 4 == 0   ? -kInfinity
                              : i % 4 == 1 ? 0.0
                                           : -bound,
                              i % 4 < 2 ? kInfinity : bound});
  }
  return problem;
}

void load(BoxLcp& lcp, const Problem& problem) {
  lcp.resize(static_cast<std::size_t>(problem.b.size()));
  std::ranges::copy(problem.A.reshaped(), lcp.A().begin());
  std::ranges::copy(problem.b, lcp.b().begin());
  std::ranges::copy(problem.bounds, lcp.bounds().begin());
  std::ranges::fill(lcp.x(), 0.0);
  std::ranges::fill(lcp.sides(), BoxLcp::Side::kFree);
}

Eigen::VectorXd solution(const BoxLcp& lcp) {
  return Eigen::VectorXd::Map(lcp.x().data(), static_cast<Eigen::Index>(lcp.x().size()));
}

// Largest violation of a condition: of a bound by x, or of the sign of w.
double violation(const Problem& problem, const Eigen::VectorXd& x) {
  const Eigen::VectorXd w = problem.A * x - problem.b;
  double largest = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto& [lower, upper] = problem.bounds[static_cast<std::size_t>(i)];
    largest = std::max({largest, lower - x[i], x[i] - upper});
    if (lower == upper) continue;
    if (x[i] > lower) largest = std::max(largest, w[i]);
    if (x[i] < upper) largest = std::max(largest, -w[i]);
  }
  return largest;
}

// Tries each row at each of its bounds and free.
Eigen::VectorXd try_all(const Problem& problem) {
  const Eigen::Index rows = problem.b.size();
  const int combinations = static_cast<int>(std::lround(std::pow(3, rows)));
  Eigen::VectorXd best;
  double least = kInfinity;
  for (int combination = 0; combination < combinations; ++combination) {
    Eigen::MatrixXd system = problem.A;
    Eigen::VectorXd right = problem.b;
    bool possible = true;
    for (int i = 0, rest = combination; i < rows; ++i, rest /= 3) {
      if (rest % 3 == 0) continue;
      const auto& bounds = problem.bounds[static_cast<std::size_t>(i)];
      system.row(i) = Eigen::RowVectorXd::Unit(rows, i);
      right[i] = rest % 3 == 1 ? bounds.lower : bounds.upper;
      possible = possible && std::isfinite(right[i]);
    }
    if (!possible) continue;
    Eigen::VectorXd x = system.fullPivLu().solve(right);
    for (int i = 0, rest = combination; i < rows; ++i, rest /= 3)
      if (rest % 3 != 0) x[i] = right[i];  // without the rounding of the factorisation
    if (violation(problem, x) >= least) continue;
    least = violation(problem, x);
    best = x;
  }
  EXPECT_LT(least, 1e-9);
  return best;
}

TEST(BoxLcp, FindsTheOneCombinationOfSidesThatHolds) {
  BoxLcp lcp(8);
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    sim_board::RandomStream random(seed, "lcp");
    const Problem problem = random_problem(random, 6, 6, 0.01);
    load(lcp, problem);
    ASSERT_TRUE(lcp.solve()) << seed;
    EXPECT_LT((solution(lcp) - try_all(problem)).cwiseAbs().maxCoeff(), 1e-8) << seed;
  }
}

// Twelve rows on each of two bodies, of rank six each but for the softness of sticking rows at 1 ms.
TEST(BoxLcp, MeetsTheConditionsWhereRowsAreRedundant) {
  BoxLcp lcp(8);
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    sim_board::RandomStream random(seed, "lcp");
    const Problem problem = random_problem(random, 24, 12, 1e-7);
    load(lcp, problem);
    ASSERT_TRUE(lcp.solve()) << seed;
    EXPECT_LT(violation(problem, solution(lcp)), 1e-8) << seed;
  }
}

TEST(BoxLcp, EndsAtOnceAtTheSolutionAndThereFromAnyStart) {
  BoxLcp lcp(24);
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    sim_board::RandomStream random(seed, "lcp");
    const Problem problem = random_problem(random, 24, 24, 0.01);
    load(lcp, problem);
    ASSERT_TRUE(lcp.solve()) << seed;
    const Eigen::VectorXd x = solution(lcp);
    const std::uint64_t before = lcp.iterations();
    ASSERT_TRUE(lcp.solve()) << seed;
    EXPECT_EQ(lcp.iterations(), before + 1) << seed;

    load(lcp, problem);
    for (BoxLcp::Side& side : lcp.sides()) side = static_cast<BoxLcp::Side>(random.bits() % 4);
    for (double& value : lcp.x()) value = random.within(1.0);
    ASSERT_TRUE(lcp.solve()) << seed;
    EXPECT_LT((solution(lcp) - x).cwiseAbs().maxCoeff(), 1e-8) << seed;
  }
}

// As friction rows are, which have no room until the normal impulses are known.
TEST(BoxLcp, FixesRowsWithEqualBoundsUntilTheyDiffer) {
  sim_board::RandomStream random(1, "lcp");
  const Problem wide = random_problem(random, 8, 8, 0.1);
  Problem narrow = wide;
  narrow.bounds[2] = narrow.bounds[5] = {0.125, 0.125};
  BoxLcp lcp(8);
  load(lcp, narrow);
  ASSERT_TRUE(lcp.solve());
  EXPECT_EQ(lcp.x()[2], 0.125);
  EXPECT_EQ(lcp.x()[5], 0.125);
  EXPECT_LT(violation(narrow, solution(lcp)), 1e-9);
  std::ranges::copy(wide.bounds, lcp.bounds().begin());
  ASSERT_TRUE(lcp.solve());
  EXPECT_LT(violation(wide, solution(lcp)), 1e-9);
}

TEST(BoxLcp, RejectsAMatrixThatIsNotPositiveDefinite) {
  BoxLcp lcp(2);
  Problem problem{Eigen::MatrixXd::Identity(2, 2),
                  Eigen::VectorXd::Ones(2),
                  {{-kInfinity, kInfinity}, {-kInfinity, kInfinity}}};
  problem.A(0, 1) = problem.A(1, 0) = 2.0;
  load(lcp, problem);
  EXPECT_FALSE(lcp.solve());
}

// Row by row, with Eigen's dot products: the order of operations that runs had before rows were factorised
// four at a time, and that their bits depend on.
Eigen::VectorXd solve_row_by_row(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index rows = b.size();
  RowMajor L = RowMajor::Zero(rows, rows);
  Eigen::VectorXd inverses(rows);
  const auto product = [](const double* one, const double* other, Eigen::Index size) {
    return Eigen::VectorXd::Map(one, size).dot(Eigen::VectorXd::Map(other, size));
  };
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) L(i, j) = (A(i, j) - product(&L(i, 0), &L(j, 0), j)) * inverses[j];
    L(i, i) = std::sqrt(A(i, i) - product(&L(i, 0), &L(i, 0), i));
    inverses[i] = 1.0 / L(i, i);
  }
  Eigen::VectorXd x = b;
  for (Eigen::Index i = 0; i < rows; ++i) x[i] = (x[i] - product(&L(i, 0), x.data(), i)) * inverses[i];
  for (Eigen::Index i = rows; i-- > 0;) {
    x[i] *= inverses[i];
    for (Eigen::Index j = 0; j < i; ++j) x[j] -= L(i, j) * x[i];
  }
  return x;
}

TEST(BoxLcp, FactorisesFourRowsAtATimeWithTheBitsOfOne) {
  sim_board::RandomStream random(7, "four rows");
  for (Eigen::Index rows = 1; rows <= 21; ++rows) {
    Problem problem = random_problem(random, rows, 6, 1e-3);
    problem.bounds.assign(static_cast<std::size_t>(rows), {-kInfinity, kInfinity});
    BoxLcp lcp(1);
    load(lcp, problem);
    ASSERT_TRUE(lcp.solve());
    EXPECT_EQ(solution(lcp), solve_row_by_row(problem.A.transpose(), problem.b)) << rows << " rows";
  }
}

}  // namespace
}  // namespace koboshi::mechanics
