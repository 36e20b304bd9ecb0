#pragma once

#include <filesystem>

#include "sim_board/scenario/scenario.h"
#include "tools/lab/plot/figure.h"

namespace koboshi::tools {

// Draws the figures of a run from the trace.csv in its folder, as PNG and SVG: body.* (height, inclination,
// feet) and legs.* (targets and positions). Throws PlotError.
void draw_run_figures(const sim::Scenario& scenario, const std::filesystem::path& folder);

}  // namespace koboshi::tools
