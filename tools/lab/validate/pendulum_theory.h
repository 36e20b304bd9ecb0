#pragma once

#include <Eigen/Core>

#include "tools/lab/validate/rigs.h"

namespace koboshi::tools {

// Pendulums of HangingLinks without friction. Angles are those of the joints, from straight down.

// (I + m r^2) / (m r): the length of the simple pendulum that swings alike.
[[nodiscard]] double reduced_length_m(const HangingLink& link);

// T = 4 sqrt(l/g) K(sin(amplitude/2)), K the complete elliptic integral of the first kind (Landau and
// Lifshitz, Mechanics, section 11). The amplitude is below pi.
[[nodiscard]] double pendulum_period_s(double reduced_length_m, double amplitude_rad);

// The angle after `duration_s` of a pendulum let go at rest, by Runge-Kutta steps of 10 us.
[[nodiscard]] double pendulum_angle_rad(double reduced_length_m, double start_rad, double duration_s);

// Joint angles and speeds, (q1, q2, w1, w2), of a double pendulum: their derivatives by the Lagrangian.
[[nodiscard]] Eigen::Vector4d double_pendulum_derivative(const HangingLink& upper, const HangingLink& lower,
                                                         const Eigen::Vector4d& state);

}  // namespace koboshi::tools
