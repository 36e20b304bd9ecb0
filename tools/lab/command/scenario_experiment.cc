#include "tools/lab/command/scenario_experiment.h"

#include <fmt/core.h>

namespace koboshi::tools {

std::string draw_figure(const PlaneFigure& figure, const ExperimentArguments& arguments) {
  try {
    draw(figure, arguments.out / "figure");
  } catch (const PlotError& error) {
    fmt::print(stderr, "koboshi: no figure: {}\n", error.what());
    return {};
  }
  if (arguments.page.empty()) return {};
  const std::string image = arguments.section + ".png";
  std::filesystem::copy_file(arguments.out / "figure.png", arguments.page.parent_path() / image,
                             std::filesystem::copy_options::overwrite_existing);
  return "![" + figure.title + "](" + image + ")\n";
}

}  // namespace koboshi::tools
