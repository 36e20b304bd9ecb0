#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <span>

#include "simulation/observe/watched_simulation.h"

namespace koboshi::simulation {

// The sources of Truth. The references must outlive it.
struct TrueWorld {
  GroundTruth truth;
  const sim_board::World& world;
  const sim_board::RobotDescription& robot;
  std::uint64_t now_us = 0;
};

// The named tuples State and Truth of the Python module. observation.cc lists the fields of each in one
// table.
class ObservationTypes {
 public:
  explicit ObservationTypes(pybind11::module_& module);

  // Returns the state of these simulations. `by_world` adds a leading dimension to every field; without it
  // there must be exactly one simulation.
  pybind11::object state(std::span<const WatchedSimulation* const> worlds, bool by_world) const;
  pybind11::object truth(std::span<const WatchedSimulation* const> worlds, bool by_world) const;
  pybind11::object truth(std::span<const TrueWorld> worlds, bool by_world) const;

 private:
  pybind11::object state_type_;
  pybind11::object truth_type_;
};

// Adds both types to the module.
ObservationTypes define_observations(pybind11::module_& module);

}  // namespace koboshi::simulation
