#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <span>

#include "simulation/observe/watched_simulation.h"

namespace koboshi::simulation {

// The named tuples State and Truth of the Python module, whose fields stand in one table each
// (observation.cc).
class ObservationTypes {
 public:
  explicit ObservationTypes(pybind11::module_& module);

  // Of these worlds. With `by_world` every field has one more dimension, in front; without, there must be one
  // world.
  pybind11::object state(std::span<const WatchedSimulation* const> worlds, bool by_world) const;
  pybind11::object truth(std::span<const WatchedSimulation* const> worlds, bool by_world) const;

 private:
  pybind11::object state_type_;
  pybind11::object truth_type_;
};

// Adds both types to the module.
ObservationTypes define_observations(pybind11::module_& module);

}  // namespace koboshi::simulation
