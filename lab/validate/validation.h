#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim_board/world/options.h"
#include "tools/plot/figure.h"

namespace koboshi::lab {

// The validations of `koboshi validate`: each simulates a small world whose motion is known from theory, and
// compares the two.

// The settings of a validation. It takes step, stepper and its settings from `world`, and chooses ground,
// start and gravity itself.
struct ValidationSetup {
  sim_board::WorldOptions world{};
  bool short_form = false;                                  // fewer and shorter runs, for tests
  std::filesystem::path scenario = "scenarios/squat.yaml";  // of the validations with the whole robot
};

// A quantity in theory and in the simulation, and the bound of their difference. The tolerance follows from
// the order of the method and its step, never from the result.
struct Check {
  std::string quantity{};
  std::string unit{};
  double theory = 0.0;
  double simulated = 0.0;
  double tolerance = 0.0;

  double error() const { return simulated - theory; }
  bool passed() const { return std::abs(error()) <= tolerance; }  // false for NaN
};

// A figure with its data and its caption.
struct Plot {
  std::string name{};  // of its files, without ending
  std::string caption{};
  tools::Columns columns{};
  tools::Figure figure{};
};

struct Findings {
  std::vector<Check> checks{};
  std::vector<Plot> plots{};

  void check(const std::string& quantity, const std::string& unit, double theory, double simulated,
             double tolerance) {
    checks.push_back({quantity, unit, theory, simulated, tolerance});
  }
};

struct Validation {
  std::string name{};        // on the command line and of its files
  std::string title{};       // of its part of the page
  std::string theory{};      // what is expected, in formulas, with the source and the parameters
  std::string tolerances{};  // where they come from
  std::function<Findings(const ValidationSetup&)> run{};
};

using MakeValidation = Validation();

MakeValidation free_fall;          // of a body
MakeValidation bounce;             // of a box, and the impact of a rod on its edge
MakeValidation slope;              // stick and slip of a box on an inclined plane
MakeValidation pendulum_swing;     // period, motion and energy of a pendulum and a double pendulum
MakeValidation tennis_racket;      // flips of a free body about its intermediate axis
MakeValidation momentum;           // of a chain in free flight that moves its joints
MakeValidation inverted_pendulum;  // of the gaits, and a rigid link that tips over
MakeValidation servo_response;     // steps, sines and the torque-speed line of a servo
MakeValidation friction_loop;      // hysteresis, break-away and rest of a joint with dry friction
MakeValidation zmp_comparison;     // ZMP of squats by sensors, contact forces and the motion of all links
MakeValidation convergence;        // of errors with the step, the ground's stiffness held

// All validations, in the order of the page.
[[nodiscard]] std::vector<Validation> all_validations();

// The error of a simulation that convergence() repeats at several steps.
using SimulationError = double(const ValidationSetup& setup);

SimulationError free_fall_error_m;          // position of a falling box after half a second
SimulationError pendulum_error_rad;         // angle of a pendulum a second after its release at 1.5 rad
SimulationError inverted_pendulum_error_m;  // mass on a massless leg after three time constants
SimulationError servo_error_rad;            // largest error of position in a servo's step of half a radian

// The exponent p of error = c step^p: least squares of the logarithms. Two or more, all positive.
[[nodiscard]] double observed_order(const std::vector<double>& steps, const std::vector<double>& errors);

}  // namespace koboshi::lab
