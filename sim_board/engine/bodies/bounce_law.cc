#include "sim_board/engine/bodies/bounce_law.h"

#include <algorithm>
#include <cmath>

namespace koboshi::sim_board {

double bounce_damping(double restitution) {
  constexpr double kLeast = 0.02;
  constexpr double kElastic = 1.0 - 1e-6;
  const double e = std::max(restitution, kLeast);
  if (e >= kElastic) return 0.0;
  // The sides cross once between these bounds: below, the right side is larger from lambda = 0 on only by
  // terms of third order, so that zero itself is left out.
  double low = 1e-9;
  double high = (1.0 - 1e-15) / e;
  for (int i = 0; i < 200; ++i) {
    const double lambda = 0.5 * (low + high);
    const bool too_small = std::log((1.0 + lambda) / (1.0 - lambda * e)) < (1.0 + e) * lambda;
    (too_small ? low : high) = lambda;
  }
  return 0.5 * (low + high);
}

}  // namespace koboshi::sim_board
