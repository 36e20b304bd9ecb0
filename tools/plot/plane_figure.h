#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/plot/columns.h"
#include "tools/plot/figure.h"

namespace koboshi::tools {

// Curves in a plane seen from above, with equal axes: paths over the ground.

struct PlaneCurve {
  std::string label{};  // in the key; empty: none
  std::vector<Point> points{};
  LineStyle style = LineStyle::kSolid;
  int colour = 0;  // as Series::colour
  double width = 1.8;
};

// A closed and lightly filled polygon with a label.
struct Outline {
  std::vector<Point> corners{};
  int colour = 7;
  std::string word{};
  Point word_at{};
};

struct PlaneFigure {
  std::string title{};
  std::string x_label{};
  std::string y_label{};
  std::vector<Outline> outlines{};
  std::vector<PlaneCurve> curves{};  // above the outlines, the last on top
};

// Draws the figure to `without_extension`.png and .svg, as wide as other figures and as high as its data
// need. Throws PlotError.
void draw(const PlaneFigure& figure, const std::filesystem::path& without_extension);

}  // namespace koboshi::tools
