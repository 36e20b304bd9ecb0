#include "sim_board/engine/mujoco/lift_iteration.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/seed.h"

namespace koboshi::sim_board {
namespace {

using Slips = std::function<std::vector<double>(std::span<const double> lifts)>;

// How often it asks.
int iterate(LiftIteration& iteration, const std::vector<double>& first, const Slips& slips) {
  int solutions = 1;
  iteration.begin(first);
  for (std::vector<double> found = slips(iteration.lifts_m_per_s()); !iteration.is_over(found); ++solutions)
    found = slips(iteration.lifts_m_per_s());
  return solutions;
}

// One contact that slides forwards on the plane, by the derivation in the header: it is off where the lift is
// high, and slides on with what the force then leaves it, until it sticks.
Slips struck_contact(double W_nn, double W_nt, double W_tt, double friction, double v_n, double v_t) {
  return [=](std::span<const double> lifts) {
    const double D = W_nn - 2.0 * friction * W_nt + friction * friction * W_tt;
    const double force = std::max(0.0, (friction * v_t - v_n - lifts[0]) / D);
    return std::vector<double>{friction * std::max(0.0, v_t + (W_nt - friction * W_tt) * force)};
  };
}

TEST(LiftIteration, NeedsOneSolutionWithoutSliding) {
  LiftIteration iteration(2);
  EXPECT_EQ(iterate(iteration, {0.0, 0.001}, [](auto) { return std::vector<double>{0.001, 0.0}; }), 1);
  EXPECT_TRUE(iteration.settled());
}

// mu W_nt is 0.72 of W_nn = 1, no paradox, but the plain iteration has the slope -2.9 and alternates.
TEST(LiftIteration, ConvergesWhereThePlainIterationAlternates) {
  const Slips slips = struck_contact(1.0, 0.99, 1.0, 0.9, -1.24, 0.5);
  double plain = 0.45;
  std::vector<double> seen;
  for (int i = 0; i < 40; ++i) seen.push_back(plain = slips({{plain}})[0]);
  EXPECT_GT(std::abs(seen[38] - seen[39]), 0.5);

  LiftIteration iteration(1);
  EXPECT_LE(iterate(iteration, {0.45}, slips), 8);
  EXPECT_TRUE(iteration.settled());
  const double lift = iteration.lifts_m_per_s()[0];
  EXPECT_NEAR(slips({{lift}})[0], lift, LiftIteration::kTolerance_m_per_s);
}

TEST(LiftIteration, ConvergesForEveryContactWithoutParadox) {
  std::mt19937_64 random(test::kSeed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double W_tt = std::pow(10.0, 2.0 * share(random) - 1.0);
    const double friction = 0.1 + 1.1 * share(random);
    // The matrix is that of an inertia, so |W_nt| < sqrt(W_nn W_tt), and mu W_nt < W_nn.
    const double W_nt = std::min(0.98 * std::sqrt(W_tt), 0.9 / friction) * (2.0 * share(random) - 1.0);
    const double v_t = 3.0 * share(random);
    const double first = friction * v_t;
    LiftIteration iteration(1);
    iterate(iteration, {first}, struck_contact(1.0, W_nt, W_tt, friction, -2.0 * share(random), v_t));
    EXPECT_TRUE(iteration.settled()) << "W_nt " << W_nt << ", W_tt " << W_tt << ", mu " << friction;
  }
}

// Slips that no lift agrees with: whatever is left, no lift stays above its slip, so no contact is off that
// must not be.
TEST(LiftIteration, EndsBelowAnUnreachableLift) {
  const Slips jumps = [](std::span<const double> lifts) {
    const bool off = lifts[0] + 0.5 * lifts[1] > 0.7;
    return off ? std::vector<double>{0.1, 0.3} : std::vector<double>{1.0, 0.8};
  };
  LiftIteration iteration(2);
  EXPECT_LE(iterate(iteration, {0.9, 0.9}, jumps), LiftIteration::kMaxSolutions);
  EXPECT_FALSE(iteration.settled());
  const std::vector<double> left = jumps(iteration.lifts_m_per_s());
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LE(iteration.lifts_m_per_s()[i], left[i] + LiftIteration::kTolerance_m_per_s);
}

}  // namespace
}  // namespace koboshi::sim_board
