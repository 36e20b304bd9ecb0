#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace koboshi::tools {

// To be made small over the unit box.
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

}  // namespace koboshi::tools
