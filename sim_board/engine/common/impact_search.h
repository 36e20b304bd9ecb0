#pragma once

namespace koboshi::sim_board {

// Lowers the restitution of a step whose impacts would add energy.
//
// With impulses p, inverse inertia W and velocities v' after the step, an impact adds p.v' - p.W p/2 to the
// kinetic energy. Without restitution it never adds any: normals then have v' = 0, and friction opposes v'.
// With restitution the sum may be positive if friction is strong, so there is a share of the coefficients for
// which it is zero. It is sought by regula falsi; the result is on the side that loses energy.
//
// `solve` solves the step with a share of the coefficients and returns whether there is a solution, `work_J`
// returns the energy that the impacts added in it. The step has been solved with all of them.
template <typename Solve, typename Work>
[[nodiscard]] bool settle_impacts(const Solve& solve, const Work& work_J) {
  constexpr int kMaxSolutions = 4;
  constexpr double kRounding_J = 1e-12;
  double high = 1.0;
  double high_J = work_J();
  if (high_J <= kRounding_J) return true;
  if (!solve(0.0)) return false;
  double low = 0.0;
  double low_J = work_J();
  double last = low;
  for (int i = 0; i < kMaxSolutions && low_J < -kRounding_J; ++i) {
    last = low + (high - low) * low_J / (low_J - high_J);
    if (!solve(last)) return false;
    const double last_J = work_J();
    (last_J > kRounding_J ? high : low) = last;
    (last_J > kRounding_J ? high_J : low_J) = last_J;
  }
  return last == low || solve(low);
}

}  // namespace koboshi::sim_board
