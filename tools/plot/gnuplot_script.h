#pragma once

#include <filesystem>
#include <string>

#include "tools/plot/columns.h"
#include "tools/plot/figure.h"

namespace koboshi::tools {

// The gnuplot script, data included, that draws the figure to `without_extension`.png and .svg.
std::string gnuplot_script(const Figure& figure, const Columns& columns,
                           const std::filesystem::path& without_extension);

}  // namespace koboshi::tools
