#pragma once

#include <pybind11/pybind11.h>

#include "simulation/python/observation.h"

namespace koboshi::simulation {

// Adds Robot and Robots, which are controlled joint by joint, to the module.
void define_joint_level(pybind11::module_& module, const ObservationTypes& types);

}  // namespace koboshi::simulation
