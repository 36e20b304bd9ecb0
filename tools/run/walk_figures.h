#pragma once

#include <filesystem>
#include <optional>

#include "sim_board/robot/description.h"
#include "tools/plot/figure.h"
#include "tools/plot/plane_figure.h"

namespace koboshi::tools {

// The part of the trace.csv of a walk that its figures show: all of a short walk, else three cycles from its
// middle on. Nothing when the trace holds no walk. Throws sim::InputError.
std::optional<Span> walk_to_show(const std::filesystem::path& trace, double cycle_s);

// The paper's figure 8 in a part of a trace: planned, measured and true ZMP over the footprints, from above.
// Throws sim::InputError.
PlaneFigure zmp_figure(const std::filesystem::path& trace, const sim::RobotDescription& robot, Span time_s);

// Draws the figures of a walk from the trace.csv in its folder, as PNG and SVG: zmp.*, joints.* (targets and
// positions of the legs) and attitude.*. Throws sim::InputError and PlotError.
void draw_walk_figures(const std::filesystem::path& folder, const sim::RobotDescription& robot,
                       double cycle_s);

}  // namespace koboshi::tools
