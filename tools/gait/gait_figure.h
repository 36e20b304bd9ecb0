#pragma once

#include <filesystem>

#include "sim_board/description/description.h"
#include "simulation/gait/gait.h"
#include "simulation/model/robot_model.h"

namespace koboshi::tools {

// Draws the profile of a walk and its linear approximation by the gait's points, like the paper's figure 6,
// to PREFIX.png and PREFIX.svg, with the data in PREFIX.csv: two cycles that begin with standing. Throws
// InputError, WriteError and PlotError.
void draw_gait(const simulation::Gait& gait, const sim_board::RobotDescription& robot,
               const simulation::NamedModel& model, const std::filesystem::path& prefix);

}  // namespace koboshi::tools
