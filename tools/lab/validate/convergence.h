#pragma once

#include "tools/lab/validate/validation.h"

namespace koboshi::tools {

// How errors shrink with the step, the ground's stiffness held.
[[nodiscard]] Validation convergence();

// The exponent p of error = c step^p: least squares of the logarithms. Two or more, all positive.
[[nodiscard]] double observed_order(const std::vector<double>& steps, const std::vector<double>& errors);

}  // namespace koboshi::tools
