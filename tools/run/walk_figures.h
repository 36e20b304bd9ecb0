#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "sim_board/description/description.h"
#include "simulation/scenario/scenario.h"
#include "tools/plot/figure.h"
#include "tools/plot/plane_figure.h"

namespace koboshi::tools {

// All functions take the trace of a run, or its columns that walk_columns() names.
std::set<std::string> walk_columns();

// The part of a walk that its figures show: of the longest walk, by a gait or at a commanded velocity, all if
// it is short, else three cycles from its middle on. Nothing where the trace holds no walk.
std::optional<Span> walk_to_show(const Columns& trace, double cycle_s);

// The paper's figure 8: planned, measured and true ZMP over the footprints, seen from above. Shows no ZMP
// where the feet together carry less than a tenth of the weight: there it is noise.
PlaneFigure zmp_figure(const Columns& trace, const sim_board::RobotDescription& robot, Span time_s);

// Duration of two steps of a walk at a commanded velocity, by the scenario's parameters.
double commanded_cycle_s(const simulation::Scenario& scenario);

// Draws the figures of a walk, if there is one, as PNG and SVG: zmp.*, joints.* (targets and positions of the
// legs) and attitude.*. Returns which of them are left out because they would be empty, and why; empty: none.
// Throws PlotError.
[[nodiscard]] std::string draw_walk_figures(const Columns& trace, const sim_board::RobotDescription& robot,
                                            double cycle_s, const std::filesystem::path& folder);

}  // namespace koboshi::tools
