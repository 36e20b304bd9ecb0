#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::lab {

// A named way to solve the physics.
struct BenchStepper {
  std::string name;
  simulation::Physics physics;

  bool is_ode() const { return physics.stepper != sim_board::Stepper::kMujoco; }
};

// All steppers of this program: the named ones at 1 ms and `world` with friction by rows.
std::vector<BenchStepper> bench_steppers();

// Largest errors of an accurate squat.
inline constexpr double kSquatRmsBar_m = 2e-4;
inline constexpr double kSquatSlipBar_m = 1e-3;

struct BenchOptions {
  std::filesystem::path walk;   // a scenario
  std::filesystem::path squat;  // a scenario; without its commands to play, the robot stands
  std::filesystem::path lie;    // a scenario whose robot lies on the ground, without its commands
  double duration_s = 20.0;     // of each
  double reference_step_s = 0.00005;
  std::vector<BenchStepper> steppers;
};

// One scenario with one stepper. Times are processor time, not wall-clock time.
struct BenchRun {
  double real_time_factor = 0.0;     // of the closed loop
  double physics_steps_per_s = 0.0;  // of the physics in it, alone
  sim_board::TimeShares shares;      // parts of that time, each 0..1; scenario and observers are the rest
  bool fell = false;
};

struct BenchResult {
  BenchStepper stepper;
  BenchRun walk;
  BenchRun squat;
  BenchRun stand;                        // on its feet, with the drives enabled
  BenchRun lie;                          // limp
  double squat_base_height_rms_m = 0.0;  // against the reference, while the robot stands on its feet
  double squat_foot_slip_m = 0.0;        // largest
  double memory_bytes = 0.0;             // of one world with its board and firmware
  double two_worlds_speedup = 0.0;       // throughput of two threads with a world each against one with one

  bool accurate() const {
    return !walk.fell && !squat.fell && squat_base_height_rms_m <= kSquatRmsBar_m &&
           squat_foot_slip_m <= kSquatSlipBar_m;
  }
};

// Runs the closed loop (firmware, bus, drives, sensors, physics) of all scenarios with every stepper, all in
// turns of a quarter of a simulated second, so that other load of the machine affects all alike. `tell` gets
// the name of each phase. Throws what Simulation throws.
std::vector<BenchResult> bench(const BenchOptions& options,
                               const std::function<void(const std::string&)>& tell);

// The accurate ODE stepper that is fastest in the walk; null if there is none.
const BenchResult* fastest_accurate(const std::vector<BenchResult>& results);

}  // namespace koboshi::lab
