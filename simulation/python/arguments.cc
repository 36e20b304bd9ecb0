#include "simulation/python/arguments.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "base/text/text.h"
#include "simulation/assembly/operator_input.h"
#include "simulation/disturbance/world_text.h"
#include "simulation/scenario/paths.h"
#include "simulation/scenario/reader.h"

namespace py = pybind11;

namespace koboshi::simulation {
namespace {

// Converts a Python value to YAML for the scenario readers. JSON is a subset of YAML.
std::string yaml_of(const py::handle& value) {
  // JSON makes pairs of surrogates of characters beyond U+FFFF, which YAML does not have.
  // NumPy's numbers and arrays are none of JSON's.
  const py::cpp_function plain([](const py::handle& other) -> py::object {
    if (py::hasattr(other, "tolist")) return other.attr("tolist")();
    throw py::type_error("found " + py::str(py::type::of(other)).cast<std::string>() +
                         ", expected numbers, texts, lists and dictionaries");
  });
  const auto text = py::module_::import("json").attr("dumps")(value, py::arg("ensure_ascii") = false,
                                                              py::arg("default") = plain);
  return text.cast<std::string>();
}

// A Python value on one line of a message; NumPy writes a row of a matrix on a line of its own.
std::string quoted(const py::handle& value) {
  const py::str words = py::str(" ").attr("join")(py::repr(value).attr("split")());
  return one_line(words.cast<std::string>());
}

std::vector<double> numbers_of(const py::handle& vector) {
  try {
    return vector.cast<std::vector<double>>();
  } catch (const py::cast_error&) {
    throw std::invalid_argument("found " + quoted(vector) + ", expected a list of numbers");
  }
}

}  // namespace

Scenario read(const std::filesystem::path& file, const std::optional<std::uint64_t>& seed,
              const std::optional<std::string>& stepper, const std::optional<std::filesystem::path>& robot,
              const std::optional<std::string>& world, const py::dict& set) {
  std::vector<Override> overrides;
  for (const auto& [path, value] : set) overrides.push_back({py::str(path), yaml_of(value), "set"});
  if (seed) overrides.push_back({"seed", std::to_string(*seed), "seed"});
  if (robot) {
    overrides.push_back(robot_override(robot->string()));
    overrides.back().option = "robot";
  }
  if (stepper) overrides.push_back({"physics.stepper", *stepper, "stepper"});
  if (world) overrides.push_back(text_override("world", *world, "world"));
  Scenario scenario = read_scenario(find_input(InputKind::kScenario, file), overrides);
  if (const std::string text = left_out_text(scenario); !text.empty())
    py::module_::import("warnings").attr("warn")(text, py::arg("stacklevel") = 1);
  return scenario;
}

void give_command(Simulation& simulation, const std::string& verb, const py::object& value,
                  const py::kwargs& fields) {
  py::dict item;
  if (fields.empty() && value.is_none()) {
    item[py::str(verb)] =
        verb == "walk" || verb == "stream" ? py::object(py::dict()) : py::object(py::bool_(true));
  } else if (fields.empty()) {
    item[py::str(verb)] = value;
  } else {
    if (!value.is_none()) throw py::type_error("command() takes a value or fields, not both");
    item[py::str(verb)] = fields;
  }
  command(simulation, yaml_of(item));
}

StreamSet stream_set(const py::object& targets_rad, const py::object& torque_limits_percent) {
  return {.targets_rad = numbers_of(targets_rad),
          .torque_limits_percent =
              torque_limits_percent.is_none() ? std::vector<double>() : numbers_of(torque_limits_percent)};
}

std::vector<StreamSet> stream_sets(const py::object& targets_rad, const py::object& torque_limits_percent,
                                   std::size_t worlds) {
  const auto numpy = py::module_::import("numpy");
  const auto of_world = [&](const py::object& values, std::size_t world) -> py::object {
    if (values.is_none()) return values;
    const py::object array = numpy.attr("asarray")(values);
    if (array.attr("ndim").cast<int>() == 1) return array;
    if (py::len(array) != worlds)
      throw std::invalid_argument("found " + std::to_string(py::len(array)) + " sets, expected " +
                                  std::to_string(worlds) + ", one for each simulation");
    return array[py::int_(world)];
  };
  std::vector<StreamSet> sets;
  for (std::size_t world = 0; world < worlds; ++world)
    sets.push_back(stream_set(of_world(targets_rad, world), of_world(torque_limits_percent, world)));
  return sets;
}

std::map<std::string, std::string> drawn_factors(const DisturbedWorld* world,
                                                 const sim_board::RobotDescription& robot) {
  std::map<std::string, std::string> factors;
  if (world == nullptr) return factors;
  for (const auto& [factor, value] : drawn_texts(*world, robot)) factors.emplace(factor, value);
  return factors;
}

Push read_push(const sim_board::RobotDescription& robot, const py::object& force_N, double duration_s,
               const std::optional<std::string>& link, const py::object& at_m, const std::string& shape) {
  py::dict item;
  item["link"] = link.value_or(robot.links.front().name);
  item["force_N"] = numbers_of(force_N);
  item["duration_s"] = duration_s;
  item["shape"] = shape;
  if (!at_m.is_none()) item["at_m"] = numbers_of(at_m);
  return read_push(yaml_of(item), robot);
}

void give_push(Simulation& simulation, const py::object& force_N, double duration_s,
               const std::optional<std::string>& link, const py::object& at_m, const std::string& shape) {
  simulation.push(read_push(simulation.robot(), force_N, duration_s, link, at_m, shape));
}

}  // namespace koboshi::simulation
