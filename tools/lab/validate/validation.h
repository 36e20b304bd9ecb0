#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/world/options.h"
#include "tools/lab/plot/figure.h"

namespace koboshi::tools {

// What every experiment of `koboshi validate` is made of: a small world whose motion is known from theory.

// What the experiments are run with. Of `world` they take step, stepper and its settings; ground, start and
// gravity are their own.
struct ValidationSetup {
  sim::WorldOptions world{};
  bool short_form = false;                                  // fewer and shorter runs, for every build
  std::filesystem::path scenario = "scenarios/squat.yaml";  // of the experiments with the whole robot
};

// One quantity, as theory has it and as it was simulated. The tolerance follows from the order of the method
// and its step, never from what came out.
struct Check {
  std::string quantity{};
  std::string unit{};
  double theory = 0.0;
  double simulated = 0.0;
  double tolerance = 0.0;

  double error() const { return simulated - theory; }
  bool passed() const { return std::abs(error()) <= tolerance; }  // not for what is no number
};

// A figure with its data and its caption.
struct Plot {
  std::string name{};  // of its files, without ending
  std::string caption{};
  Columns columns{};
  Figure figure{};
};

struct Findings {
  std::vector<Check> checks{};
  std::vector<Plot> plots{};
};

struct Validation {
  std::string name{};        // on the command line and of its files
  std::string title{};       // of its part of the page
  std::string theory{};      // what is expected, in formulas, with the source and the parameters
  std::string tolerances{};  // where they come from
  std::function<Findings(const ValidationSetup&)> run{};
};

// All there are, in the order of the page.
[[nodiscard]] std::vector<Validation> all_validations();

}  // namespace koboshi::tools
