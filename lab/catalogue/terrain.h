#pragma once

#include <string>
#include <vector>

#include "lab/experiment/field_table.h"
#include "lab/trial/commanded_walk.h"
#include "lab/trial/scenario_trial.h"

namespace koboshi::lab {

// The ground that the robot walks over without seeing it, at a speed that is easy on a floor: each kind of
// ground is made harder until more than 5 of 100 seeds fall or need more than twice the time.
struct TerrainOptions : ExperimentSetup {
  static const std::vector<std::string>& all_kinds();

  double speed_m_per_s = 0.15;
  double distance_m = 1.5;                       // to be walked
  std::vector<std::string> kinds = all_kinds();  // of ground
  // Levels instead of those of the kinds, rising; empty: their own. Needs kinds with the same unit.
  std::vector<double> levels{};
};

struct TerrainTrial : ScenarioTrial {
  bool not_passed = false;
};
[[nodiscard]] const FieldTable<TerrainTrial>& terrain_fields();

// A ladder for each kind of ground. It concludes the hardest level of each that was passed: step_passed and
// so on. Throws InputError.
[[nodiscard]] Experiment make_terrain(const TerrainOptions& options);

}  // namespace koboshi::lab
