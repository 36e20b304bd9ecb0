#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "simulation/assembly/simulation.h"
#include "simulation/scenario/scenario.h"

// The arguments of the Python module, as the scenario readers take them. All of them throw InputError.
namespace koboshi::simulation {

// Reads a scenario; `set` has the paths and values of the keys to override.
Scenario read(const std::filesystem::path& file, const std::optional<std::uint64_t>& seed,
              const std::optional<std::string>& stepper, const std::optional<std::filesystem::path>& robot,
              const pybind11::dict& set);

// Gives a command with one value or with fields, not both.
void give_command(Simulation& simulation, const std::string& verb, const pybind11::object& value,
                  const pybind11::kwargs& fields);

// Returns a set of the joint target stream. The torque limits may be None.
StreamSet stream_set(const pybind11::object& targets_rad, const pybind11::object& torque_limits_percent);
// Returns a set for each of the worlds, from arrays with or without a leading dimension. Throws
// std::invalid_argument for another number of sets.
std::vector<StreamSet> stream_sets(const pybind11::object& targets_rad,
                                   const pybind11::object& torque_limits_percent, std::size_t worlds);

// The draws of a world: a text for each factor. Empty if `world` is null.
std::map<std::string, std::string> drawn_factors(const DisturbedWorld* world,
                                                 const sim_board::RobotDescription& robot);

// A push of a link, without a name the trunk. `at_m` is None for its centre of mass.
Push read_push(const sim_board::RobotDescription& robot, const pybind11::object& force_N, double duration_s,
               const std::optional<std::string>& link, const pybind11::object& at_m,
               const std::string& shape);
void give_push(Simulation& simulation, const pybind11::object& force_N, double duration_s,
               const std::optional<std::string>& link, const pybind11::object& at_m,
               const std::string& shape);

}  // namespace koboshi::simulation
