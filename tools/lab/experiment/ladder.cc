#include "tools/lab/experiment/ladder.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim_board/input/text.h"
#include "tools/lab/plot/legend.h"

namespace koboshi::tools {
namespace {

// Curves on top of each other stay visible: each is drawn narrower than the one below.
constexpr double kWidest = 8.0;
constexpr double kNarrower = 1.8;

class Climber {
 public:
  Climber(const Experiment& experiment, const std::vector<Ladder>& ladders, const ExperimentOptions& options)
      : experiment_(experiment), ladders_(ladders), options_(options), climbs_(ladders.size()) {}

  void climb() {
    for (std::size_t level = 0; play_level(level); ++level) {
    }
  }

  ClimbResult result() {
    ClimbResult all{.experiment = experiment_};
    all.experiment.cells.clear();
    for (std::size_t ladder = 0; ladder < ladders_.size(); ++ladder) {
      OneClimb& climb = climbs_[ladder];
      const std::size_t first = all.experiment.cells.size();
      for (std::size_t level = 0; level < climb.played.size(); ++level) {
        all.experiment.cells.push_back(experiment_.cells[ladders_[ladder].cells[level]]);
        all.result.cells.push_back(std::move(climb.played[level]));
      }
      all.climbs.push_back(
          {.first = first, .levels = climb.played.size(), .highest = std::nullopt, .stop = climb.stop});
      if (climb.held > 0) all.climbs.back().highest = first + climb.held - 1;
    }
    return all;
  }

 private:
  using Clock = std::chrono::steady_clock;

  struct OneClimb {
    bool climbs = true;
    std::size_t held = 0;  // levels
    Stop stop = Stop::kAllSeeds;
    std::vector<CellResult> played{};
  };

  // False when nobody climbs any more.
  bool play_level(std::size_t level) {
    std::vector<std::size_t> climbing;
    std::vector<std::size_t> cells;
    for (std::size_t ladder = 0; ladder < ladders_.size(); ++ladder) {
      if (!climbs_[ladder].climbs || level >= ladders_[ladder].cells.size()) continue;
      climbing.push_back(ladder);
      cells.push_back(ladders_[ladder].cells[level]);
    }
    if (cells.empty()) return false;
    ExperimentResult result = play(cells);
    for (std::size_t i = 0; i < climbing.size(); ++i) {
      judge(climbs_[climbing[i]], std::move(result.cells[i]));
    }
    return true;
  }

  ExperimentResult play(const std::vector<std::size_t>& cells) const {
    Experiment level = experiment_;
    level.cells.clear();
    for (const std::size_t cell : cells) level.cells.push_back(experiment_.cells[cell]);
    level.play = [&](std::size_t cell, std::uint64_t seed) { return experiment_.play(cells[cell], seed); };
    ExperimentOptions options = options_;
    if (options.budget != std::chrono::duration<double>::max()) options.budget -= Clock::now() - start_;
    return play_experiment(level, options);
  }

  static void judge(OneClimb& climb, CellResult played) {
    climb.climbs = played.stop == Stop::kAllSeeds || played.stop == Stop::kTightEnough;
    if (climb.climbs) {
      ++climb.held;
    } else {
      climb.stop = played.stop;
    }
    climb.played.push_back(std::move(played));
  }

  const Experiment& experiment_;
  const std::vector<Ladder>& ladders_;
  const ExperimentOptions& options_;
  const Clock::time_point start_ = Clock::now();
  std::vector<OneClimb> climbs_;  // by ladder
};

}  // namespace

double level_of(const Cell& cell) { return sim::parse_number(cell.settings.back().second).value(); }

std::string climb_line(const Ladder& ladder, const Climb& climb, const ClimbResult& result) {
  const std::string held = climb.highest
                               ? "up to " + result.experiment.cells[*climb.highest].settings.back().second
                               : "at no level";
  const std::string end = climb.stop == Stop::kTooMany  ? "the next is too much"
                          : climb.stop == Stop::kBudget ? "the time was over"
                                                        : "nothing beyond was tried";
  return ladder.name + ": " + held + "; " + end + "\n";
}

PlaneFigure ladder_figure(const std::string& title, const Experiment& experiment,
                          const std::vector<Ladder>& ladders, const ClimbResult& result) {
  PlaneFigure figure{.title = title,
                     .x_label = "level, as a share of the hardest",
                     .y_label = "share of the seeds that failed"};
  figure.curves.push_back({.points = {{0.0, kMostFailures}, {1.0, kMostFailures}},
                           .style = style_of(Role::kTheory),
                           .colour = colour_of(Role::kTheory)});
  const Measure& failure =
      *std::ranges::find_if(experiment.measures, [](const Measure& m) { return m.most_share < 1.0; });
  for (std::size_t i = 0; i < ladders.size(); ++i) {
    const Ladder& ladder = ladders[i];
    const double hardest = level_of(experiment.cells[ladder.cells.back()]);
    PlaneCurve curve{.label = ladder.name + " (1 = " + sim::number_text(hardest) + " " + ladder.unit + ")",
                     .style = LineStyle::kLinesPoints,
                     .colour = static_cast<int>(i),
                     .width = kWidest - kNarrower * static_cast<double>(i)};
    const Climb& climb = result.climbs[i];
    for (std::size_t cell = climb.first; cell < climb.first + climb.levels; ++cell) {
      curve.points.push_back({level_of(result.experiment.cells[cell]) / hardest,
                              share_of(result.result.cells[cell], failure).share});
    }
    figure.curves.push_back(std::move(curve));
  }
  return figure;
}

ClimbResult climb(const Experiment& experiment, const std::vector<Ladder>& ladders,
                  const ExperimentOptions& options) {
  Climber climber(experiment, ladders, options);
  climber.climb();
  return climber.result();
}

}  // namespace koboshi::tools
