#include "simulation/gait/pendulum.h"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/fixed/gravity.h"
#include "firmware/fixed/host/convert.h"
#include "sim_board/world/gravity.h"

namespace koboshi::simulation {
namespace {

using Eigen::Vector2d;

constexpr double kHeight_m = 0.18;

// Integrates x'' = (x - p) / T_c^2 by the classical Runge-Kutta method.
PendulumState integrate(PendulumState state, const ZmpPiece& zmp, double time_s, int steps) {
  const double h = time_s / steps;
  const double rate = sim_board::kGravity_m_per_s2 / kHeight_m;
  const auto pull = [&](const Vector2d& x, double t) -> Vector2d { return rate * (x - zmp.at(t)); };
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const Vector2d x = state.position_m;
    const Vector2d v = state.velocity_m_per_s;
    const Vector2d k1 = pull(x, t);
    const Vector2d k2 = pull(x + 0.5 * h * v, t + 0.5 * h);
    const Vector2d k3 = pull(x + 0.5 * h * v + 0.25 * h * h * k1, t + 0.5 * h);
    const Vector2d k4 = pull(x + h * v + 0.5 * h * h * k2, t + h);
    state.position_m += h * v + h * h / 6.0 * (k1 + k2 + k3);
    state.velocity_m_per_s += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return state;
}

TEST(Pendulum, HasThePapersTimeConstant) {
  EXPECT_NEAR(Pendulum(kHeight_m).time_constant_s(), std::sqrt(0.18 / 9.80665), 1e-15);
}

TEST(Pendulum, HasTheGravityOfTheFirmware) {
  EXPECT_EQ(fixed::kInverseGravity, fixed::from_double<fixed::Ratio>(1.0 / sim_board::kGravity_m_per_s2));
}

TEST(Pendulum, FollowsEquation3ForAConstantZmp) {
  const Pendulum pendulum(kHeight_m);
  const double Tc = pendulum.time_constant_s();
  const ZmpPiece zmp{1.0, Vector2d::Zero(), Vector2d::Zero()};
  const PendulumState end = pendulum.advance({Vector2d(-0.02, 0.01), Vector2d(0.3, -0.1)}, zmp, 0.2);
  EXPECT_NEAR(end.position_m.x(), -0.02 * std::cosh(0.2 / Tc) + Tc * 0.3 * std::sinh(0.2 / Tc), 1e-15);
  EXPECT_NEAR(end.velocity_m_per_s.y(), 0.01 / Tc * std::sinh(0.2 / Tc) - 0.1 * std::cosh(0.2 / Tc), 1e-15);
}

TEST(Pendulum, AgreesWithIntegrationForAMovingZmp) {
  const Pendulum pendulum(kHeight_m);
  const ZmpPiece zmp{0.15, Vector2d(0.01, -0.03), Vector2d(0.05, 0.03)};
  const PendulumState begin{Vector2d(0.0, 0.004), Vector2d(0.2, 0.15)};
  const PendulumState closed = pendulum.advance(begin, zmp, 0.15);
  const PendulumState integrated = integrate(begin, zmp, 0.15, 2000);
  EXPECT_NEAR((closed.position_m - integrated.position_m).norm(), 0.0, 1e-12);
  EXPECT_NEAR((closed.velocity_m_per_s - integrated.velocity_m_per_s).norm(), 0.0, 1e-11);
}

TEST(Pendulum, RestsAboveItsZmp) {
  const Vector2d p(0.03, -0.01);
  const PendulumState end = Pendulum(kHeight_m).advance({p, Vector2d::Zero()}, {2.0, p, p}, 2.0);
  EXPECT_EQ(end.position_m, p);
  EXPECT_EQ(end.velocity_m_per_s, Vector2d::Zero());
}

}  // namespace
}  // namespace koboshi::simulation
