#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/plot/columns.h"

namespace koboshi::tools {

// What all figures have in common: how gnuplot is spoken to.

// A string of gnuplot that means the text itself.
std::string quoted(const std::string& text);
// Okabe and Ito, https://jfly.uni-koeln.de/color, darkest contrast first; any number.
std::string palette_colour(std::size_t number);
// A data block; points that are not numbers break the line.
void write_block(std::ostream& out, const std::string& name, const std::vector<Point>& points);
// `set terminal` and `set output` of a PNG or an SVG page, by the file's extension.
std::string open_page(const std::filesystem::path& file, int width_px, int height_px);
// Axes, tics and grid.
std::string axes_style();

// Runs the script, which lies beside the figures until it has succeeded. Throws PlotError.
void run_gnuplot(const std::string& script, const std::filesystem::path& without_extension);

}  // namespace koboshi::tools
