#pragma once

#include <string>

#include "tools/plot/columns.h"
#include "tools/plot/figure.h"

namespace koboshi::tools {

// The gnuplot script, data included, that draws the figure on each of its pages (gnuplot.h).
std::string gnuplot_script(const Figure& figure, const Columns& columns);

}  // namespace koboshi::tools
