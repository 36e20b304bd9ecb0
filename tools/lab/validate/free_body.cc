#include "tools/lab/validate/free_body.h"

#include <cmath>
#include <utility>

namespace koboshi::tools {

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

}  // namespace koboshi::tools
