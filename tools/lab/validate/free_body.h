#pragma once

#include <Eigen/Core>

namespace koboshi::tools {

// A rigid body free of torques, its angular velocity in its principal axes, by Euler's equations
//   I1 w1' = (I2 - I3) w2 w3  and so on.

// Moments of inertia in rising order, kg m^2.
using Moments = Eigen::Vector3d;

[[nodiscard]] Eigen::Vector3d euler_rate(const Moments& moments, const Eigen::Vector3d& w);

// Kinetic energy and the square of the angular momentum, which both stay.
struct FreeBodyConstants {
  double energy_J = 0.0;
  double momentum_squared = 0.0;  // (kg m^2/s)^2

  friend bool operator==(const FreeBodyConstants&, const FreeBodyConstants&) = default;
};
[[nodiscard]] FreeBodyConstants constants_of(const Moments& moments, const Eigen::Vector3d& w);

// How long it takes from one passage of w2 = 0 to the next, which is one flip about the intermediate axis:
// 2 K(k)/p with
//   p^2 = (I3 - I2)(L^2 - 2 E I1) / (I1 I2 I3),
//   k^2 = (I2 - I1)(2 E I3 - L^2) / ((I3 - I2)(L^2 - 2 E I1))
// where L^2 > 2 E I2; otherwise with I1 and I3 exchanged (Landau and Lifshitz, Mechanics, section 37).
[[nodiscard]] double flip_time_s(const Moments& moments, const FreeBodyConstants& constants);

}  // namespace koboshi::tools
