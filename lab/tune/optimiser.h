#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace koboshi::lab {

// An objective over the unit box, to be minimised.
using Objective = std::function<double(const std::vector<double>& x)>;

struct OptimiserOptions {
  std::size_t evaluations = 150;  // of the objective: as many whole generations as that is enough for
  std::size_t population = 8;     // at least 5
  double spread = 0.15;           // standard deviation of the first generation about the start
  std::uint32_t seed = 1;
};

// Evolution strategy with covariance matrix adaptation, as in libpagmo, from `start` in the unit box. The
// start is the first that is evaluated. The same start, options and objective give the same evaluations in
// the same order. Returns the best point evaluated.
[[nodiscard]] std::vector<double> minimise(const Objective& objective, const std::vector<double>& start,
                                           const OptimiserOptions& options);

// Several objectives over the unit box, each to be minimised.
using Objectives = std::function<std::vector<double>(const std::vector<double>& x)>;

// Approaches the Pareto front of `count` objectives by NSGA-II (Deb et al., 2002) as in libpagmo. Returns
// nothing: the caller keeps the points at which the objectives are evaluated. The population is rounded up to
// a multiple of four, and the start is evaluated first, as above.
void minimise_each(const Objectives& objectives, std::size_t count, const std::vector<double>& start,
                   const OptimiserOptions& options);

// The indices of the Pareto-optimal values: no other is smaller in one objective and larger in none. In
// ascending order.
[[nodiscard]] std::vector<std::size_t> non_dominated(const std::vector<std::vector<double>>& values);

}  // namespace koboshi::lab
