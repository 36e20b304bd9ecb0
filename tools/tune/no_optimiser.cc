#include <stdexcept>

#include "tools/tune/optimiser.h"

namespace koboshi::tools {

// Stands in for optimiser.cc where libpagmo is missing.
std::vector<double> minimise(const Objective&, const std::vector<double>&, const OptimiserOptions&) {
  throw std::runtime_error(
      "this program was built without an optimiser (apt install libpagmo-dev, build anew)");
}

}  // namespace koboshi::tools
