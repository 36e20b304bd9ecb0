#include "tools/tune/optimiser.h"

#include <algorithm>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>

#include "sim_board/random/random_stream.h"

namespace koboshi::tools {
namespace {

// What pagmo calls a user-defined problem.
struct BoxProblem {
  const Objective* objective = nullptr;  // pagmo copies the problem
  std::size_t dimensions = 0;

  pagmo::vector_double fitness(const pagmo::vector_double& x) const { return {(*objective)(x)}; }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    return {pagmo::vector_double(dimensions, 0.0), pagmo::vector_double(dimensions, 1.0)};
  }
};

}  // namespace

std::vector<double> minimise(const Objective& objective, const std::vector<double>& start,
                             const OptimiserOptions& options) {
  pagmo::population population(pagmo::problem(BoxProblem{&objective, start.size()}), 0u, options.seed);
  population.push_back(start);
  sim::RandomStream random(options.seed, "first generation");
  while (population.size() < options.population) {
    std::vector<double> x = start;
    for (double& value : x) value = std::clamp(value + options.spread * random.normal(), 0.0, 1.0);
    population.push_back(x);
  }
  const std::size_t generations = options.evaluations / options.population;
  if (generations < 2) return population.champion_x();
  constexpr double kDefault = -1.0;  // of the strategy's learning rates
  constexpr double kNever = 0.0;     // both cases get the same number of evaluations, however flat it is
  const pagmo::algorithm strategy(pagmo::cmaes(static_cast<unsigned>(generations - 1), kDefault, kDefault,
                                               kDefault, kDefault, options.spread, kNever, kNever, false,
                                               true, options.seed));
  return strategy.evolve(population).champion_x();
}

}  // namespace koboshi::tools
