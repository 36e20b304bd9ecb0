// The theory that the simulations are compared with, derived a second time.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lab/validate/theory.h"
#include "lab/validate/validation.h"

namespace koboshi::lab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(RungeKutta, IsOfFourthOrder) {
  const auto error_at = [](int steps) {
    Vector2d y(1.0, 0.0);
    for (int i = 0; i < steps; ++i) {
      y = runge_kutta_step(y, 2.0 / steps, [](const Vector2d& s) { return Vector2d(s[1], -s[0]); });
    }
    return std::abs(y[0] - std::cos(2.0));
  };
  EXPECT_LT(error_at(40), 1e-6);
  EXPECT_NEAR(error_at(20) / error_at(40), 16.0, 2.0);
}

TEST(PendulumPeriod, EqualsTheSeriesAtSmallAmplitudes) {
  const double small_s = 2.0 * std::numbers::pi * std::sqrt(0.3 / kGravity_m_per_s2);
  EXPECT_NEAR(pendulum_period_s(0.3, 1e-6), small_s, 1e-9);
  const double a = 0.2;
  EXPECT_NEAR(pendulum_period_s(0.3, a), small_s * (1.0 + a * a / 16.0 + 11.0 * std::pow(a, 4) / 3072.0),
              1e-6);
}

TEST(PendulumPeriod, ReturnsALargeSwingToItsStart) {
  const double period_s = pendulum_period_s(0.25, 2.5);
  EXPECT_NEAR(pendulum_angle_rad(0.25, 2.5, period_s), 2.5, 1e-6);
  EXPECT_NEAR(pendulum_angle_rad(0.25, 2.5, 0.5 * period_s), -2.5, 1e-6);
  EXPECT_NEAR(pendulum_angle_rad(0.25, 2.5, 0.25 * period_s), 0.0, 1e-3);  // steps of 10 us
}

TEST(PendulumLength, IsTheArmOfAPointMass) {
  EXPECT_DOUBLE_EQ(reduced_length_m({.mass_kg = 2.0, .inertia_kg_m2 = 0.0, .arm_m = 0.3}), 0.3);
  EXPECT_DOUBLE_EQ(reduced_length_m({.mass_kg = 2.0, .inertia_kg_m2 = 0.06, .arm_m = 0.3}), 0.4);
}

// Kinetic and potential energy, written out from the positions of the two centres of mass.
double double_pendulum_energy_J(const HangingLink& upper, const HangingLink& lower,
                                const Eigen::Vector4d& s) {
  const double a1 = s[0], a2 = s[0] + s[1], w1 = s[2], w2 = s[2] + s[3];
  const Vector2d v1 = upper.arm_m * w1 * Vector2d(std::cos(a1), std::sin(a1));
  const Vector2d v2 = upper.length_m * w1 * Vector2d(std::cos(a1), std::sin(a1)) +
                      lower.arm_m * w2 * Vector2d(std::cos(a2), std::sin(a2));
  const double heights = -upper.mass_kg * upper.arm_m * std::cos(a1) -
                         lower.mass_kg * (upper.length_m * std::cos(a1) + lower.arm_m * std::cos(a2));
  return 0.5 * upper.mass_kg * v1.squaredNorm() + 0.5 * lower.mass_kg * v2.squaredNorm() +
         0.5 * upper.inertia_kg_m2 * w1 * w1 + 0.5 * lower.inertia_kg_m2 * w2 * w2 +
         kGravity_m_per_s2 * heights;
}

TEST(DoublePendulum, ConservesEnergy) {
  const HangingLink upper{.mass_kg = 0.3, .inertia_kg_m2 = 1e-3, .arm_m = 0.08, .length_m = 0.2};
  const HangingLink lower{.mass_kg = 0.1, .inertia_kg_m2 = 2e-4, .arm_m = 0.12, .length_m = 0.2};
  Eigen::Vector4d state(1.5, -0.7, 0.0, 2.0);
  const double start_J = double_pendulum_energy_J(upper, lower, state);
  for (int i = 0; i < 20'000; ++i) {
    state = runge_kutta_step(
        state, 1e-4, [&](const Eigen::Vector4d& y) { return double_pendulum_derivative(upper, lower, y); });
  }
  EXPECT_NEAR(double_pendulum_energy_J(upper, lower, state), start_J, 1e-8);
}

// The time between two passages of w2 = 0, by Runge-Kutta.
double integrated_flip_s(const Moments& moments, Vector3d w) {
  constexpr double kStep_s = 1e-4;
  double first_s = 0.0;
  for (int i = 1; i < 1'000'000; ++i) {
    const double before = w[1];
    w = runge_kutta_step(w, kStep_s, [&](const Vector3d& y) { return euler_rate(moments, y); });
    if (before * w[1] >= 0.0) continue;
    const double passage_s = kStep_s * (i - w[1] / (w[1] - before));
    if (first_s > 0.0) return passage_s - first_s;
    first_s = passage_s;
  }
  return std::nan("");
}

TEST(FreeBody, FlipsAtTheTimeOfTheEllipticIntegral) {
  const Moments moments(1e-3, 2e-3, 3e-3), others(2e-3, 2.5e-3, 4e-3);
  for (const Vector3d& w :
       {Vector3d(0, 10, 1), Vector3d(0.5, 10, 0), Vector3d(3, 2, 5), Vector3d(8, 1, 0.5)}) {
    EXPECT_NEAR(flip_time_s(moments, constants_of(moments, w)), integrated_flip_s(moments, w), 1e-6);
    EXPECT_NEAR(flip_time_s(others, constants_of(others, w)), integrated_flip_s(others, w), 1e-6);
  }
}

TEST(FreeBody, ConservesEnergyAndMomentum) {
  const Moments moments(1e-3, 2e-3, 3e-3);
  const Vector3d w(3, 2, 5), rate = euler_rate(moments, w);
  EXPECT_NEAR(moments.cwiseProduct(w).dot(rate), 0.0, 1e-15);
  EXPECT_NEAR(moments.cwiseAbs2().cwiseProduct(w).dot(rate), 0.0, 1e-15);
}

TEST(ObservedOrder, IsTheSlopeInLogarithmicAxes) {
  EXPECT_NEAR(observed_order({1.0, 0.5, 0.1}, {3.0, 1.5, 0.3}), 1.0, 1e-12);
  EXPECT_NEAR(observed_order({1.0, 0.5, 0.25}, {8.0, 2.0, 0.5}), 2.0, 1e-12);
}

}  // namespace
}  // namespace koboshi::lab
