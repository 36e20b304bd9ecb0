#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "simulation/observe/watched_simulation.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Several simulations of one scenario with different seeds, stepped in parallel. They share the files, which
// are read and compiled once, and no state: each gives the same bits as alone.
class Batch {
 public:
  // Creates one simulation per seed, at least one, and `threads` >= 1 threads. Throws InputError for an
  // error in a file of the scenario.
  Batch(const Scenario& scenario, std::span<const std::uint64_t> seeds, std::size_t threads);

  std::size_t size() const { return worlds_.size(); }
  WatchedSimulation& at(std::size_t world) { return *worlds_.at(world); }
  const WatchedSimulation& at(std::size_t world) const { return *worlds_.at(world); }

  // Advances each simulation by this many milliseconds. If simulations throw, the others still complete their
  // steps. The exception of the first failed simulation, in order, is then rethrown.
  void step(std::size_t milliseconds);
  // Restarts one simulation with a new seed.
  void reset(std::size_t world, std::uint64_t seed);

 private:
  const std::size_t threads_;
  std::vector<std::unique_ptr<WatchedSimulation>> worlds_;
};

}  // namespace koboshi::simulation
