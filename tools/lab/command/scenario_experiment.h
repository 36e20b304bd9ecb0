#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "tools/lab/command/experiment_session.h"
#include "tools/lab/plot/plane_figure.h"

namespace koboshi::tools {

// What the commands of experiments on a scenario that walks by command have in common.

inline constexpr const char* kWorlds =
    "Every seed makes a world of its own: friction 0.4 to 1, link masses and supply +-10 %, a floor that\n"
    "tilts up to 2 degrees, backlash up to 0.01 rad and an encoder that is off by up to 0.005 rad in each\n"
    "joint, the sensors' noise and bias.\n";

// What an experiment on a scenario is told at the command line.
template <typename Options>
struct ScenarioArguments {
  ExperimentArguments common;
  Options options;
};

template <typename Options>
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& what,
                      ScenarioArguments<Options>& arguments) {
  CLI::App* command = parent.add_subcommand(name, what);
  command->add_option("SCENARIO", arguments.options.scenario, "A scenario that walks by command")
      ->capture_default_str();
  arguments.common.seeds = arguments.options.seeds;
  add_experiment_options(*command, arguments.common);
  return command;
}

// What the options of all experiments say, where this experiment looks for it.
template <typename Options>
void settle(ScenarioArguments<Options>& arguments, const std::string& name) {
  arguments.options.overrides = overrides(arguments.common);
  arguments.options.first_seed = arguments.common.first_seed;
  arguments.options.seeds = arguments.common.seeds;
  if (arguments.common.out.empty()) arguments.common.out = std::filesystem::path("runs") / name;
  if (arguments.common.section.empty()) arguments.common.section = name;
}

// Draws it in the folder of the results and beside the page. Markdown that shows it there; empty without a
// page or a figure.
[[nodiscard]] std::string draw_figure(const PlaneFigure& figure, const ExperimentArguments& arguments);

}  // namespace koboshi::tools
