#include "simulation/batch/batch.h"

#include <exception>
#include <stdexcept>

#include "simulation/batch/parallel.h"

namespace koboshi::simulation {

Batch::Batch(const Scenario& scenario, std::span<const std::uint64_t> seeds, std::size_t threads)
    : threads_(threads), worlds_(seeds.size()) {
  if (seeds.empty()) throw std::invalid_argument("found no seed, expected one for each simulation");
  if (threads == 0) throw std::invalid_argument("found 0 threads, expected at least 1");
  const auto prepared = std::make_shared<const PreparedScenario>(prepare(scenario));
  for_each_parallel(seeds.size(), threads, [&](std::size_t world) {
    worlds_[world] = std::make_unique<WatchedSimulation>(prepared, seeds[world]);
  });
}

void Batch::step(std::size_t milliseconds) {
  std::vector<std::exception_ptr> errors(worlds_.size());
  for_each_parallel(worlds_.size(), threads_, [&](std::size_t world) {
    try {
      worlds_[world]->step(milliseconds);
    } catch (...) {
      errors[world] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

void Batch::reset(std::size_t world, std::uint64_t seed) { worlds_.at(world)->reset(seed); }

}  // namespace koboshi::simulation
