#include "lab/tune/optimiser.h"

#include <algorithm>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <pagmo/utils/multi_objective.hpp>
#include <tuple>
#include <utility>

#include "sim_board/random/random_stream.h"

namespace koboshi::lab {
namespace {

// A user-defined problem in pagmo's sense.
struct BoxProblem {
  const Objectives* objectives = nullptr;  // pagmo copies the problem
  std::size_t count = 0;                   // of the objectives
  std::size_t dimensions = 0;

  pagmo::vector_double fitness(const pagmo::vector_double& x) const { return (*objectives)(x); }
  pagmo::vector_double::size_type get_nobj() const { return count; }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    return {pagmo::vector_double(dimensions, 0.0), pagmo::vector_double(dimensions, 1.0)};
  }
};

// The start, and others scattered about it.
pagmo::population first_generation(const BoxProblem& problem, const std::vector<double>& start,
                                   const OptimiserOptions& options) {
  pagmo::population population(pagmo::problem(problem), 0u, options.seed);
  population.push_back(start);
  sim_board::RandomStream random(options.seed, "first generation");
  while (population.size() < options.population) {
    std::vector<double> x = start;
    for (double& value : x) value = std::clamp(value + options.spread * random.normal(), 0.0, 1.0);
    population.push_back(x);
  }
  return population;
}

}  // namespace

std::vector<double> minimise(const Objective& objective, const std::vector<double>& start,
                             const OptimiserOptions& options) {
  const Objectives objectives = [&](const std::vector<double>& x) { return std::vector{objective(x)}; };
  pagmo::population population = first_generation({&objectives, 1, start.size()}, start, options);
  const std::size_t generations = options.evaluations / options.population;
  if (generations < 2) return population.champion_x();
  constexpr double kDefault = -1.0;  // of the strategy's learning rates
  constexpr double kNever = 0.0;     // both cases get the same number of evaluations, however flat it is
  const pagmo::algorithm strategy(pagmo::cmaes(static_cast<unsigned>(generations - 1), kDefault, kDefault,
                                               kDefault, kDefault, options.spread, kNever, kNever, false,
                                               true, options.seed));
  return strategy.evolve(population).champion_x();
}

void minimise_each(const Objectives& objectives, std::size_t count, const std::vector<double>& start,
                   const OptimiserOptions& options) {
  OptimiserOptions rounded = options;
  rounded.population = (options.population + 3) / 4 * 4;
  pagmo::population population = first_generation({&objectives, count, start.size()}, start, rounded);
  const std::size_t generations = options.evaluations / rounded.population;
  if (generations < 2) return;
  constexpr double kCrossover = 0.95;  // probability; these are pagmo's defaults
  constexpr double kCrossoverIndex = 10.0;
  constexpr double kMutationIndex = 50.0;
  const double mutation = 1.0 / static_cast<double>(start.size());  // one number of each child
  const pagmo::algorithm strategy(pagmo::nsga2(static_cast<unsigned>(generations - 1), kCrossover,
                                               kCrossoverIndex, mutation, kMutationIndex, options.seed));
  static_cast<void>(strategy.evolve(population));
}

std::vector<std::size_t> non_dominated(const std::vector<std::vector<double>>& values) {
  if (values.size() < 2) return std::vector<std::size_t>(values.size(), 0);
  std::vector<std::size_t> front = std::get<0>(pagmo::fast_non_dominated_sorting(values)).front();
  std::ranges::sort(front);
  return front;
}

}  // namespace koboshi::lab
