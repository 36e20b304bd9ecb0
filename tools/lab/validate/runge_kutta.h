#pragma once

namespace koboshi::tools {

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

}  // namespace koboshi::tools
