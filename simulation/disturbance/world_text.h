#pragma once

#include <string>
#include <vector>

#include "base/table/table.h"
#include "simulation/disturbance/disturbed_world.h"
#include "simulation/disturbance/world_ranges.h"

namespace koboshi::simulation {

// A factor of a world in words: its name with its unit, and its value or range.
struct FactorText {
  std::string factor;
  std::string text;
};

// The ranges of a world, for readers. The same factors in the same order for every world.
[[nodiscard]] std::vector<FactorText> range_texts(const WorldRanges& ranges);
// A row for each factor, a column for each world: the table of docs/reference/worlds.md.
[[nodiscard]] std::string world_table(TableStyle style);

// Returns the factors that a seed has drawn. Values of links and joints are in the robot's order. Factors
// that the world leaves as they are in the files are missing.
[[nodiscard]] std::vector<FactorText> drawn_texts(const DisturbedWorld& world,
                                                  const sim_board::RobotDescription& robot);

}  // namespace koboshi::simulation
