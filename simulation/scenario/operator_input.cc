#include "simulation/scenario/operator_input.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "sim_board/input/error.h"
#include "sim_board/input/yaml_reader.h"
#include "sim_board/scenario/events.h"

namespace koboshi::simulation {
namespace {

// Returns a scenario document with a single item at the start, under the key of its list.
sim::YamlFile document_of(const std::string& list, const std::string& text) {
  sim::YamlNode root = sim::parse_yaml(list + ": [{at_s: 0}]", list);
  sim::YamlNode item = sim::parse_yaml(text, list);
  if (item.find("at_s") != nullptr) throw sim::InputError(list, 0, "a time (at_s)", "none: it begins now");
  std::ranges::move(item.items, std::back_inserter(root.items.front().items.front().items));
  return {list, std::move(root)};
}

}  // namespace

void command(Simulation& simulation, const std::string& text) {
  const sim::YamlFile document = document_of("commands", text);
  const auto commands = sim::read_commands(document.root(), sim::motion_names(simulation.scenario()));
  document.finish();
  for (const sim::Command& command : commands) simulation.command(command);
}

void push(Simulation& simulation, const std::string& text) {
  const sim::YamlFile document = document_of("pushes", text);
  const auto pushes = sim::read_pushes(document.root());
  document.finish();
  for (const sim::Push& push : pushes) {
    sim::check(push, simulation.robot());
    simulation.push(push);
  }
}

sim::Fault read_fault(const std::string& text) {
  const sim::YamlFile document = document_of("faults", text);
  std::vector<sim::Fault> faults = sim::read_faults(document.root());
  document.finish();
  return std::move(faults.front());
}

void fault(Simulation& simulation, const std::string& text) {
  const sim::Fault fault = read_fault(text);
  sim::check(fault, simulation.robot());
  simulation.fault(fault);
}

void write(Simulation& simulation, const std::string& key, double value) {
  simulation.write({.name = {.text = key, .source = "parameters", .line = 0}, .value = value});
}

}  // namespace koboshi::simulation
