#pragma once

#include <filesystem>
#include <optional>

#include "sim_board/robot/description.h"
#include "sim_board/scenario/scenario.h"
#include "tools/lab/plot/figure.h"
#include "tools/lab/plot/plane_figure.h"

namespace koboshi::tools {

// The part of the trace.csv of a walk that its figures show: of the longest walk, by a gait or at a commanded
// velocity, all if it is short, else three cycles from its middle on. Nothing when the trace holds no walk.
// Throws sim::InputError.
std::optional<Span> walk_to_show(const std::filesystem::path& trace, double cycle_s);

// The paper's figure 8 in a part of a trace: planned, measured and true ZMP over the footprints, from above.
// Where the feet together carry less than a tenth of the weight no ZMP is shown: a point of pressure that
// bears next to nothing jumps about. Throws sim::InputError.
PlaneFigure zmp_figure(const std::filesystem::path& trace, const sim::RobotDescription& robot, Span time_s);

// Two steps of a walk at a commanded velocity, by the scenario's parameters.
double commanded_cycle_s(const sim::Scenario& scenario);

// Draws the figures of a walk, if there is one, from the trace.csv in its folder, as PNG and SVG: zmp.*,
// joints.* (targets and positions of the legs) and attitude.*. Throws sim::InputError and PlotError.
void draw_walk_figures(const std::filesystem::path& folder, const sim::RobotDescription& robot,
                       double cycle_s);

}  // namespace koboshi::tools
