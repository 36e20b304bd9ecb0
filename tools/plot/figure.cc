#include "tools/plot/figure.h"

#include "tools/plot/gnuplot.h"
#include "tools/plot/gnuplot_script.h"

namespace koboshi::tools {

std::set<std::string> columns_of(const Figure& figure) {
  std::set<std::string> names;
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) names.insert(series.column);
  }
  return names;
}

void draw(const Figure& figure, const Columns& columns, const std::filesystem::path& without_extension) {
  run_gnuplot(gnuplot_script(figure, columns), without_extension);
}

void draw_with_csv(const Figure& figure, const Columns& columns,
                   const std::filesystem::path& without_extension, int digits) {
  write_csv(columns, without_extension.string() + ".csv", digits);
  draw(figure, columns, without_extension);
}

}  // namespace koboshi::tools
