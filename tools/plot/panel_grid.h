#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/plot/figure.h"
#include "tools/plot/plane_figure.h"

namespace koboshi::tools {

// Small multiples: panels of one size in rows, each with axes of its own.

struct GridPanel {
  std::string title{};
  std::string x_label{};
  std::string y_label{};
  bool log_x = false;  // its values are positive; likewise for y
  bool log_y = false;
  std::optional<Span> y_span{};  // all by default
  std::vector<PlaneCurve> curves{};
};

struct PanelGrid {
  std::string title{};
  int columns = 3;  // of panels
  int panel_height_px = 210;
  std::vector<GridPanel> panels{};  // row by row. The key, below the title, is that of the first panel
};

// The gnuplot script that draws the figure on each of its pages.
[[nodiscard]] std::string gnuplot_script(const PanelGrid& grid);

// Draws it to `without_extension`.png and .svg. Throws PlotError and WriteError.
void draw(const PanelGrid& grid, const std::filesystem::path& without_extension);

}  // namespace koboshi::tools
