#include <stdexcept>

#include "lab/tune/optimiser.h"

// Stands in for optimiser.cc where libpagmo is missing.
namespace koboshi::lab {
namespace {

[[noreturn]] void refuse() {
  throw std::runtime_error(
      "this program was built without an optimiser (apt install libpagmo-dev, build anew)");
}

}  // namespace

std::vector<double> minimise(const Objective&, const std::vector<double>&, const OptimiserOptions&) {
  refuse();
}

void minimise_each(const Objectives&, std::size_t, const std::vector<double>&, const OptimiserOptions&) {
  refuse();
}

std::vector<std::size_t> non_dominated(const std::vector<std::vector<double>>&) { refuse(); }

}  // namespace koboshi::lab
