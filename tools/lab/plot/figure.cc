#include "tools/lab/plot/figure.h"

#include "tools/lab/plot/columns.h"
#include "tools/lab/plot/gnuplot.h"
#include "tools/lab/plot/gnuplot_script.h"

namespace koboshi::tools {
void draw(const Figure& figure, const std::filesystem::path& csv_file,
          const std::filesystem::path& without_extension) {
  std::vector<std::string> names{figure.x_column};
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) names.push_back(series.column);
  }
  run_gnuplot(gnuplot_script(figure, read_columns(csv_file, names)), without_extension);
}

}  // namespace koboshi::tools
