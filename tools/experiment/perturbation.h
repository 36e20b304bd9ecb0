#pragma once

#include <cstdint>

#include "sim_board/robot/description.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::tools {

// How far a seed may take the world from the one that the firmware was made for. Everything is drawn
// uniformly between its bounds.
struct PerturbationBounds {
  double lowest_friction = 0.5;  // Coulomb's mu between foot and ground
  double highest_friction = 1.0;
  double mass_share = 0.05;   // of a link's mass, either way; its inertia goes along
  double supply_share = 0.0;  // of the supply's voltage, either way
  double tilt_rad = 0.01745;  // of the ground, largest, in any direction: 1 degree
  // Of soft ground under one contact point, a sole has four; both 0: the ground stays as hard as it is.
  double softest_N_per_m = 0.0;
  double stiffest_N_per_m = 0.0;
};

// Pushes against the trunk at random times and in random level directions.
struct PushBounds {
  double first_s = 0.0;     // after the moment from which it is pushed
  double shortest_s = 1.5;  // from one push to the next
  double longest_s = 3.0;
  double lowest_N_s = 0.0;  // impulse
  double highest_N_s = 0.1;
  double duration_s = 0.05;  // half a sine wave
};

// The links' masses of the world with this seed. The same seed gives the same masses on every machine, and
// so for everything below; each thing has a stream of its own, so that one more does not change the others.
void perturb_robot(sim::RobotDescription& robot, const PerturbationBounds& bounds, std::uint64_t seed);

// Its ground, and the sensors' noise and bias.
void perturb_scenario(sim::Scenario& scenario, const PerturbationBounds& bounds, std::uint64_t seed);

// Adds pushes against `link` from `from_us` to the scenario's end.
void add_pushes(sim::Scenario& scenario, const std::string& link, std::uint64_t from_us,
                const PushBounds& bounds, std::uint64_t seed);

}  // namespace koboshi::tools
