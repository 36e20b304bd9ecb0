#include "lab/catalogue/terrain.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "base/text/error.h"
#include "base/text/text.h"
#include "lab/experiment/ladder.h"
#include "lab/experiment/report.h"
#include "lab/trial/pushes.h"

namespace koboshi::lab {
namespace {

constexpr double kTerrainPatience = 2.0;  // times the distance over the command

// A kind of ground, and the overrides of a scenario that make it at a level other than 0, which is a floor.
struct Kind {
  std::string name;
  std::string unit;
  std::vector<double> levels;
  std::function<std::vector<Override>(double level)> ground;
};

// A mat across the path, to step up to and down from.
std::vector<Override> mat(double height_mm) {
  return {{"ground.shapes",
           fmt::format("[{{box: {{position_m: [0.7, 0], size_m: [0.6, 3, {}]}}}}]", 1e-3 * height_mm)}};
}

// The robot is put down with its soles flat on the slope.
std::vector<Override> tilted(double roll_deg, double pitch_deg) {
  return {{"ground.tilt_deg", fmt::format("[{}, {}]", roll_deg, pitch_deg)},
          {"initial.attitude_deg", fmt::format("{{roll: {}, pitch: {}}}", roll_deg, pitch_deg)}};
}

// Strips across the path, half as long again as a foot.
std::vector<Override> slippery_patches(double slipperiness) {
  std::string shapes;
  for (const double x_m : {0.3, 0.6, 0.9, 1.2}) {
    shapes += fmt::format("{}{{patch: {{position_m: [{}, 0], size_m: [0.15, 3], friction: {:.2f}}}}}",
                          shapes.empty() ? "" : ", ", x_m, 1.0 - slipperiness);
  }
  return {{"ground.shapes", "[" + shapes + "]"}};
}

std::vector<Override> bumps(double height_mm) {
  return {
      {"ground.shapes",
       fmt::format(
           "[{{height_field: {{position_m: [1.0, 0], size_m: [1.6, 2], height_m: {}, wavelength_m: 0.1}}}}]",
           1e-3 * height_mm)}};
}

const std::vector<Kind>& grounds() {
  static const std::vector<double> kHeights_mm{0, 2, 4, 6, 8, 10, 14, 20};
  static const std::vector<double> kAngles_deg{0, 2, 4, 6, 8, 10, 14, 20};
  static const std::vector<Kind> kKinds{
      {"step", "mm", kHeights_mm, mat},
      {"uphill", "deg", kAngles_deg, [](double angle_deg) { return tilted(0.0, -angle_deg); }},
      {"downhill", "deg", kAngles_deg, [](double angle_deg) { return tilted(0.0, angle_deg); }},
      {"across", "deg", kAngles_deg, [](double angle_deg) { return tilted(angle_deg, 0.0); }},
      {"slippery", "less than mu 1", {0, 0.7, 0.8, 0.85, 0.9, 0.95}, slippery_patches},
      {"bumps", "mm", kHeights_mm, bumps}};
  return kKinds;
}

TerrainTrial play(const StandingStart& start, const TerrainOptions& options, std::uint64_t seed) {
  const double patience_s = kTerrainPatience * options.distance_m / options.speed_m_per_s;
  TerrainTrial trial{play_in_world(start.walking({options.speed_m_per_s, 0.0, 0.0}, patience_s), seed,
                                   [&](const simulation::RunRecorder& recorder) {
                                     return recorder.walk().displacement().x() >= options.distance_m;
                                   })};
  // False without a walk, too.
  const bool arrived = trial.walk.distance_m >= (1.0 - 1e-9) * options.distance_m;
  trial.not_passed = trial.lost() || !arrived;
  if (trial.not_passed) trial.walk = no_walk();
  return trial;
}

Conclusions highest_levels(const Experiment& experiment, const ExperimentResult& result) {
  Conclusions conclusions;
  for (const Ladder& ladder : experiment.ladders) {
    const Climb climb = climb_of(ladder, result);
    conclusions.lines += climb_line(experiment, ladder, climb);
    nlohmann::ordered_json& passed = conclusions.values[ladder.name + "_passed"];
    if (climb.highest) passed = level_of(experiment.cells[*climb.highest]);
    conclusions.values[ladder.name + "_ended_by"] = stop_name(climb.stop);
  }
  conclusions.figure = ladder_figure("Terrain: what is not passed", experiment, result);
  return conclusions;
}

}  // namespace

const std::vector<std::string>& TerrainOptions::all_kinds() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const Kind& kind : grounds()) names.push_back(kind.name);
    return names;
  }();
  return kNames;
}

const FieldTable<TerrainTrial>& terrain_fields() {
  using T = TerrainTrial;
  using Walk = simulation::WalkSummary;
  static const FieldTable<T> kFields{
      Fields<T>{
          {{.name = "not_passed", .label = "not passed", .max_share = kMaxFailureShare, .is_loss = true},
           &T::not_passed}},
      outcome_fields<T>(&T::outcome),
      Fields<T>{{{"speed_m_per_s", "speed [m/s]"}, &T::walk, &Walk::speed_m_per_s},
                {{"lateral_drift_m", "drift [m]", 2}, &T::walk, &Walk::lateral_drift_m},
                {{"heading_drift_rad", "turned [rad]", 2}, &T::walk, &Walk::heading_drift_rad}}};
  return kFields;
}

Experiment make_terrain(const TerrainOptions& options) {
  if (!std::ranges::is_sorted(options.levels))
    throw InputError("--levels", 0, fmt::format("{}", fmt::join(options.levels, ",")), "rising levels");
  std::vector<StandingStart> starts;
  std::vector<Cell> cells;
  std::vector<Ladder> ladders;
  for (const Kind& kind : grounds()) {
    if (std::ranges::find(options.kinds, kind.name) == options.kinds.end()) continue;
    if (!options.levels.empty() && !ladders.empty() && ladders.front().unit != kind.unit)
      throw InputError("--levels", 0, "levels for " + ladders.front().name + " and " + kind.name,
                       "kinds of ground with one unit in --only");
    ladders.push_back({.name = kind.name, .unit = kind.unit, .cells = {}});
    for (const double level : options.levels.empty() ? kind.levels : options.levels) {
      std::vector<Override> overrides = options.overrides;
      if (level > 0.0) std::ranges::copy(kind.ground(level), std::back_inserter(overrides));
      ladders.back().cells.push_back(starts.size());
      starts.push_back(read_standing_start(options, overrides));
      const std::string text = number_text(level);
      cells.push_back({kind.name + "-" + text, {{"ground", kind.name}, {"level", text}}});
    }
  }
  require_permitted_speed("--speed", options.speed_m_per_s, starts.front().scenario);
  Experiment experiment =
      begin_experiment("terrain", "What ground it walks over", options, starts.front().scenario,
                       {{"speed_m_per_s", options.speed_m_per_s}, {"distance_m", options.distance_m}});
  experiment.cells = std::move(cells);
  experiment.ladders = std::move(ladders);
  set_trials(experiment, terrain_fields(),
             [options, starts = std::move(starts)](std::size_t cell, std::uint64_t seed) {
               return play(starts[cell], options, seed);
             });
  experiment.conclude = highest_levels;
  return experiment;
}

}  // namespace koboshi::lab
