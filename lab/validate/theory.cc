#include "lab/validate/theory.h"

#include <Eigen/Dense>
#include <cmath>
#include <utility>

namespace koboshi::lab {

double reduced_length_m(const HangingLink& link) {
  return (link.inertia_kg_m2 + link.mass_kg * link.arm_m * link.arm_m) / (link.mass_kg * link.arm_m);
}

double pendulum_period_s(double reduced_length_m, double amplitude_rad) {
  return 4.0 * std::sqrt(reduced_length_m / kGravity_m_per_s2) *
         std::comp_ellint_1(std::sin(0.5 * amplitude_rad));
}

double pendulum_angle_rad(double reduced_length_m, double start_rad, double duration_s) {
  constexpr double kStep_s = 1e-5;
  const double stiffness = kGravity_m_per_s2 / reduced_length_m;
  Eigen::Vector2d state(start_rad, 0.0);
  for (long i = std::lround(duration_s / kStep_s); i > 0; --i) {
    state = runge_kutta_step(state, kStep_s, [&](const Eigen::Vector2d& y) {
      return Eigen::Vector2d(y[1], -stiffness * std::sin(y[0]));
    });
  }
  return state[0];
}

Eigen::Vector4d double_pendulum_derivative(const HangingLink& upper, const HangingLink& lower,
                                           const Eigen::Vector4d& state) {
  // In the links' angles from the vertical, a1 = q1 and a2 = q1 + q2.
  const double a1 = state[0], a2 = state[0] + state[1];
  const double s1 = state[2], s2 = state[2] + state[3];
  const double coupling = lower.mass_kg * upper.length_m * lower.arm_m;
  Eigen::Matrix2d M;
  M(0, 0) = upper.inertia_kg_m2 + upper.mass_kg * upper.arm_m * upper.arm_m +
            lower.mass_kg * upper.length_m * upper.length_m;
  M(1, 1) = lower.inertia_kg_m2 + lower.mass_kg * lower.arm_m * lower.arm_m;
  M(0, 1) = M(1, 0) = coupling * std::cos(a1 - a2);
  const Eigen::Vector2d torque(
      -coupling * std::sin(a1 - a2) * s2 * s2 -
          (upper.mass_kg * upper.arm_m + lower.mass_kg * upper.length_m) * kGravity_m_per_s2 * std::sin(a1),
      coupling * std::sin(a1 - a2) * s1 * s1 -
          lower.mass_kg * lower.arm_m * kGravity_m_per_s2 * std::sin(a2));
  const Eigen::Vector2d acceleration = M.inverse() * torque;
  return {state[2], state[3], acceleration[0], acceleration[1] - acceleration[0]};
}

Eigen::Vector3d euler_rate(const Moments& moments, const Eigen::Vector3d& w) {
  return {(moments[1] - moments[2]) * w[1] * w[2] / moments[0],
          (moments[2] - moments[0]) * w[2] * w[0] / moments[1],
          (moments[0] - moments[1]) * w[0] * w[1] / moments[2]};
}

FreeBodyConstants constants_of(const Moments& moments, const Eigen::Vector3d& w) {
  return {0.5 * moments.dot(w.cwiseAbs2()), moments.cwiseProduct(w).squaredNorm()};
}

double flip_time_s(const Moments& moments, const FreeBodyConstants& constants) {
  double I1 = moments[0], I3 = moments[2];
  const double I2 = moments[1];
  const double E2 = 2.0 * constants.energy_J, L2 = constants.momentum_squared;
  if (L2 < E2 * I2) std::swap(I1, I3);
  const double p = std::sqrt((I3 - I2) * (L2 - E2 * I1) / (I1 * I2 * I3));
  const double k = std::sqrt((I2 - I1) * (E2 * I3 - L2) / ((I3 - I2) * (L2 - E2 * I1)));
  return 2.0 * std::comp_ellint_1(k) / p;
}

}  // namespace koboshi::lab
