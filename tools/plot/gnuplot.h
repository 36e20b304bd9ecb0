#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/plot/columns.h"

namespace koboshi::tools {

// The interface to gnuplot that all figures share.

// Quotes a text as a string of gnuplot.
std::string quoted(const std::string& text);
// Okabe and Ito, https://jfly.uni-koeln.de/color: blue, orange, green, purple, yellow, light blue, black,
// grey; any number. legend.h says what each of them means.
std::string palette_colour(std::size_t number);
// Writes a data block; NaN breaks the line.
void write_block(std::ostream& out, const std::string& name, const std::vector<Point>& points);
// The pages that a script draws, by extension.
inline constexpr const char* kPageExtensions[] = {".png", ".svg"};
// `set terminal` and `set output` of a page with one of these extensions. run_gnuplot sets the file, in the
// variable output_png or output_svg.
std::string open_page(const std::string& extension, int width_px, int height_px);
// Axes, tics and grid.
std::string axes_style();

// Runs the script and writes its pages, each whole or not at all. Leaves a script that fails beside them.
// Throws PlotError and WriteError.
void run_gnuplot(const std::string& script, const std::filesystem::path& without_extension);

}  // namespace koboshi::tools
