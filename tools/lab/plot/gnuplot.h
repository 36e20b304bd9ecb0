#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/lab/plot/columns.h"

namespace koboshi::tools {

// What all figures have in common: how gnuplot is spoken to.

// A string of gnuplot that means the text itself.
std::string quoted(const std::string& text);
// Okabe and Ito, https://jfly.uni-koeln.de/color: blue, orange, green, purple, yellow, light blue, black,
// grey; any number. What each of them stands for: legend.h.
std::string palette_colour(std::size_t number);
// A data block; points that are not numbers break the line.
void write_block(std::ostream& out, const std::string& name, const std::vector<Point>& points);
// The pages that a script draws, by extension.
inline constexpr const char* kPageExtensions[] = {".png", ".svg"};
// `set terminal` and `set output` of a page with one of these extensions. Which file that is, is for
// run_gnuplot to say, in the variable output_png or output_svg.
std::string open_page(const std::string& extension, int width_px, int height_px);
// Axes, tics and grid.
std::string axes_style();

// Runs the script and writes its pages, each whole or not at all. A script that failed is left beside them.
// Throws PlotError, and sim::WriteError.
void run_gnuplot(const std::string& script, const std::filesystem::path& without_extension);

}  // namespace koboshi::tools
