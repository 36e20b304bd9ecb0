#pragma once

#include <Eigen/Core>

#include "lab/validate/rigs.h"

namespace koboshi::lab {

// One step of the classical Runge-Kutta method of fourth order for y' = derivative(y); State is a vector of
// Eigen.
template <typename State, typename Derivative>
[[nodiscard]] State runge_kutta_step(const State& y, double step_s, const Derivative& derivative) {
  const State k1 = derivative(y);
  const State k2 = derivative(State(y + 0.5 * step_s * k1));
  const State k3 = derivative(State(y + 0.5 * step_s * k2));
  const State k4 = derivative(State(y + step_s * k3));
  return y + step_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

// Pendulums of HangingLinks without friction. Angles are those of the joints, from straight down.

// The length of the equivalent simple pendulum, (I + m r^2) / (m r).
[[nodiscard]] double reduced_length_m(const HangingLink& link);

// T = 4 sqrt(l/g) K(sin(amplitude/2)), K the complete elliptic integral of the first kind (Landau and
// Lifshitz, Mechanics, section 11). The amplitude is below pi.
[[nodiscard]] double pendulum_period_s(double reduced_length_m, double amplitude_rad);

// The angle after `duration_s` of a pendulum let go at rest, by Runge-Kutta steps of 10 us.
[[nodiscard]] double pendulum_angle_rad(double reduced_length_m, double start_rad, double duration_s);

// Joint angles and speeds, (q1, q2, w1, w2), of a double pendulum: their derivatives by the Lagrangian.
[[nodiscard]] Eigen::Vector4d double_pendulum_derivative(const HangingLink& upper, const HangingLink& lower,
                                                         const Eigen::Vector4d& state);

// A rigid body free of torques, its angular velocity in its principal axes, by Euler's equations
//   I1 w1' = (I2 - I3) w2 w3  and so on.

// Moments of inertia in rising order, kg m^2.
using Moments = Eigen::Vector3d;

[[nodiscard]] Eigen::Vector3d euler_rate(const Moments& moments, const Eigen::Vector3d& w);

// The constants of motion: kinetic energy and the square of the angular momentum.
struct FreeBodyConstants {
  double energy_J = 0.0;
  double momentum_squared = 0.0;  // (kg m^2/s)^2

  friend bool operator==(const FreeBodyConstants&, const FreeBodyConstants&) = default;
};
[[nodiscard]] FreeBodyConstants constants_of(const Moments& moments, const Eigen::Vector3d& w);

// The time between two passages of w2 = 0, one flip about the intermediate axis: 2 K(k)/p with
//   p^2 = (I3 - I2)(L^2 - 2 E I1) / (I1 I2 I3),
//   k^2 = (I2 - I1)(2 E I3 - L^2) / ((I3 - I2)(L^2 - 2 E I1))
// where L^2 > 2 E I2; otherwise with I1 and I3 exchanged (Landau and Lifshitz, Mechanics, section 37).
[[nodiscard]] double flip_time_s(const Moments& moments, const FreeBodyConstants& constants);

}  // namespace koboshi::lab
