#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim_board/scenario/scenario.h"
#include "simulation/observe/watched_simulation.h"

namespace koboshi::simulation {

// Simulations of one scenario, each with a seed of its own, that are stepped together on several threads.
// They share no state: each gives the bits that it would give alone.
class Batch {
 public:
  // One simulation for each seed; at least one. `threads` from 1 on. Throws sim::InputError for whatever a
  // file of the scenario has wrong.
  Batch(const sim::Scenario& scenario, std::span<const std::uint64_t> seeds, std::size_t threads);

  std::size_t size() const { return worlds_.size(); }
  WatchedSimulation& at(std::size_t world) { return *worlds_.at(world); }
  const WatchedSimulation& at(std::size_t world) const { return *worlds_.at(world); }

  // Steps each simulation by so many milliseconds. When simulations throw, the others still make their steps
  // and the exception of the first of them in order is thrown on.
  void step(std::size_t milliseconds);
  // Begins one of them anew with a seed.
  void reset(std::size_t world, std::uint64_t seed);

 private:
  const std::size_t threads_;
  std::vector<std::unique_ptr<WatchedSimulation>> worlds_;
};

}  // namespace koboshi::simulation
