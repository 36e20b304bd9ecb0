#include "simulation/assembly/operator_input.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/text/error.h"
#include "base/yaml/yaml_reader.h"
#include "simulation/scenario/events.h"

namespace koboshi::simulation {
namespace {

// Returns a scenario document with a single item at the start, under the key of its list.
YamlFile document_of(const std::string& list, const std::string& text) {
  YamlNode root = parse_yaml(list + ": [{at_s: 0}]", list);
  YamlNode item = parse_yaml(text, list);
  if (item.find("at_s") != nullptr) throw InputError(list, 0, "a time (at_s)", "none: it begins now");
  std::ranges::move(item.items, std::back_inserter(root.items.front().items.front().items));
  return {list, std::move(root)};
}

}  // namespace

void command(Simulation& simulation, const std::string& text) {
  const YamlFile document = document_of("commands", text);
  const auto commands = read_commands(document.root(), motion_names(simulation.scenario()));
  document.finish();
  for (const Command& command : commands) {
    check(command, simulation.robot());
    simulation.command(command);
  }
}

Push read_push(const std::string& text, const sim_board::RobotDescription& robot) {
  const YamlFile document = document_of("pushes", text);
  std::vector<Push> pushes = read_pushes(document.root());
  document.finish();
  check(pushes.front(), robot);
  return std::move(pushes.front());
}

void push(Simulation& simulation, const std::string& text) {
  simulation.push(read_push(text, simulation.robot()));
}

Fault read_fault(const std::string& text) {
  const YamlFile document = document_of("faults", text);
  std::vector<Fault> faults = read_faults(document.root());
  document.finish();
  return std::move(faults.front());
}

void fault(Simulation& simulation, const std::string& text) {
  const Fault fault = read_fault(text);
  check(fault, simulation.robot());
  simulation.fault(fault);
}

void write(Simulation& simulation, const std::string& key, double value) {
  simulation.write({.name = {.text = key, .source = "parameters", .line = 0}, .value = value});
}

}  // namespace koboshi::simulation
