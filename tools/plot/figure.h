#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/plot/columns.h"

namespace koboshi::tools {

// Curves over a common abscissa, panel above panel.

enum class LineStyle { kSolid, kDashed, kPoints, kLinesPoints };

struct Series {
  std::string column{};  // of the data
  std::string label{};   // in the key; empty: none
  LineStyle style = LineStyle::kSolid;
  std::optional<int> colour{};     // 0..7 of a colour-blind-safe palette, see legend.h; else by position
  double factor = 1.0;             // from the column's unit to the panel's, such as 180/pi
  std::optional<double> from_x{};  // earlier values are not shown
};

struct Panel {
  std::string y_label{};  // with the unit: "base height [mm]"
  std::vector<Series> series{};
  double smallest_span = 0.0;  // of the ordinate, so that noise of a constant does not fill the panel
};

// A vertical line through all panels, such as the time of a command. Marks are in the order of x; labels that
// would overlap are placed in rows above each other. Marks outside the abscissa are not shown.
struct Mark {
  double x = 0.0;
  std::string label{};
};

struct Span {
  double low = 0.0;
  double high = 0.0;
};

struct Figure {
  std::string title{};
  std::string note{};  // a line below the title
  std::vector<Panel> panels{};
  std::vector<Mark> marks{};
  std::string x_column = "time_s";
  std::string x_label = "time [s]";
  std::optional<Span> x_span{};  // the part that is shown; all by default
  bool log_log = false;          // both axes logarithmic; all values are positive
};

// The columns that the figure shows, without that of the abscissa.
std::set<std::string> columns_of(const Figure& figure);

// A figure that could not be drawn: a missing column, no gnuplot, or gnuplot failed. `what()` is one line.
class PlotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Draws the figure to `without_extension`.png and .svg. Long curves are thinned to what a page can show,
// extremes kept. Throws PlotError where a column is missing or gnuplot fails, and WriteError.
void draw(const Figure& figure, const Columns& columns, const std::filesystem::path& without_extension);

// Draws it beside its data in `without_extension`.csv, as write_csv() writes them.
void draw_with_csv(const Figure& figure, const Columns& columns,
                   const std::filesystem::path& without_extension, int digits = 0);

}  // namespace koboshi::tools
