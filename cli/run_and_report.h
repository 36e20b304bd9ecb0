#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "base/yaml/yaml_tree.h"
#include "cli/options.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::cli {

// The command line of a simulated run. The struct must outlive the command that its options are added to.
struct RunArguments {
  std::filesystem::path out;  // empty: runs/ and the scenario's name
  std::vector<std::string> sets;
  std::string seed;
  std::string duration;
  std::string stepper;
  std::string robot;
  std::string world;
  std::vector<std::string> plant;
  std::string controller = "in-process";
  std::filesystem::path image;
  std::filesystem::path storage;
  std::string record = "100";
  tools::LiveOptions live;
  ViewOptions view;
};

// Add the options that choose the engine and the seed, the folder and the recording, and the view.
void add_run_options(CLI::App& command, RunArguments& arguments);

// Returns the keys of the scenario that the options replace. Throws InputError.
std::vector<Override> scenario_overrides(const RunArguments& arguments);

// Runs a scenario and prints its events and its verdict. Returns the exit status. Throws what run() throws.
int run_and_report(const RunArguments& arguments, simulation::Scenario scenario);

}  // namespace koboshi::cli
