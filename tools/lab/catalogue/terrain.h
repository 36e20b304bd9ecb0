#pragma once

#include <string>
#include <vector>

#include "tools/lab/experiment/ladder.h"
#include "tools/lab/experiment/report.h"
#include "tools/lab/trial/commanded_walk.h"

namespace koboshi::tools {

// What ground the robot walks over without looking, at a speed that is no challenge on a floor: each kind of
// ground is made harder until more than 5 of 100 seeds fall or do not get over it in twice the time.
struct TerrainOptions : CommandedWalkOptions {
  double speed_m_per_s = 0.15;
  double way_m = 1.5;  // that must be made
};

struct Terrain {
  Experiment experiment;
  std::vector<Ladder> ladders;
};

// Throws sim::InputError.
[[nodiscard]] Terrain make_terrain(const TerrainOptions& options);

// The hardest level of each kind that was passed: step_up_mm and so on.
[[nodiscard]] Conclusions terrain_conclusions(const Terrain& terrain, const ClimbResult& result);

}  // namespace koboshi::tools
