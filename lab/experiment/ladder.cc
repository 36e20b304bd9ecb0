#include "lab/experiment/ladder.h"

#include <algorithm>

#include "base/text/text.h"
#include "lab/experiment/statistics.h"
#include "tools/plot/legend.h"

namespace koboshi::lab {
namespace {

// Curves on top of each other stay visible: each is drawn narrower than the one below.
constexpr double kWidest = 8.0;
constexpr double kNarrower = 1.8;

}  // namespace

bool is_passed(const CellResult& cell) {
  return cell.stop == Stop::kAllSeeds || cell.stop == Stop::kTightEnough;
}

Climb climb_of(const Ladder& ladder, const ExperimentResult& result) {
  Climb climb;
  for (const std::size_t cell : ladder.cells) {
    if (!is_passed(result.cells[cell])) {
      climb.stop = result.cells[cell].stop;
      break;
    }
    climb.highest = cell;
  }
  return climb;
}

std::string climb_line(const Experiment& experiment, const Ladder& ladder, const Climb& climb) {
  const std::string held =
      climb.highest ? "up to " + experiment.cells[*climb.highest].settings.back().second : "at no level";
  const std::string end = climb.stop == Stop::kTooMany  ? "the next is too much"
                          : climb.stop == Stop::kBudget ? "the time was over"
                                                        : "nothing beyond was tried";
  return ladder.name + ": " + held + "; " + end + "\n";
}

double level_of(const Cell& cell) { return koboshi::parse_number(cell.settings.back().second).value(); }

tools::PlaneFigure ladder_figure(const std::string& title, const Experiment& experiment,
                                 const ExperimentResult& result) {
  tools::PlaneFigure figure{.title = title,
                            .x_label = "level, as a share of the hardest",
                            .y_label = "share of the seeds that failed"};
  figure.curves.push_back({.points = {{0.0, kMaxFailureShare}, {1.0, kMaxFailureShare}},
                           .style = tools::style_of(tools::Role::kTheory),
                           .colour = tools::colour_of(tools::Role::kTheory)});
  const auto failure =
      std::ranges::find_if(experiment.metrics, [](const Metric& metric) { return metric.max_share < 1.0; });
  const auto metric = static_cast<std::size_t>(failure - experiment.metrics.begin());
  for (std::size_t i = 0; i < experiment.ladders.size(); ++i) {
    const Ladder& ladder = experiment.ladders[i];
    const double hardest = level_of(experiment.cells[ladder.cells.back()]);
    tools::PlaneCurve& curve = figure.curves.emplace_back(
        tools::PlaneCurve{.label = ladder.name + " (1 = " + number_text(hardest) + " " + ladder.unit + ")",
                          .style = tools::LineStyle::kLinesPoints,
                          .colour = static_cast<int>(i),
                          .width = kWidest - kNarrower * static_cast<double>(i)});
    for (const std::size_t cell : ladder.cells) {
      if (result.cells[cell].stop == Stop::kNotReached) break;
      curve.points.push_back({level_of(experiment.cells[cell]) / hardest,
                              estimate_share(values_of(result.cells[cell], metric)).share});
    }
  }
  return figure;
}

}  // namespace koboshi::lab
