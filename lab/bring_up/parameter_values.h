#pragma once

#include <string>
#include <string_view>

#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// Values of parameters by their keys.

// Returns the value of a parameter; null if it is not set.
[[nodiscard]] const double* find_value(const simulation::RobotParameters& parameters, std::string_view key);
[[nodiscard]] double* find_value(simulation::RobotParameters& parameters, std::string_view key);
// The value, or another one where it is not set.
[[nodiscard]] double value_or(const simulation::RobotParameters& parameters, std::string_view key,
                              double otherwise);
// Multiplies a value that is set.
void multiply_value(simulation::RobotParameters& parameters, std::string_view key, double factor);
// Sets a value; a new one comes last.
void set_value(simulation::RobotParameters& parameters, const std::string& key, double value);

}  // namespace koboshi::lab
