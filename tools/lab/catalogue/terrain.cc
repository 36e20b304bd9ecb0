#include "tools/lab/catalogue/terrain.h"

#include <fmt/core.h>

#include <functional>
#include <memory>
#include <optional>

#include "sim_board/input/text.h"
#include "tools/lab/trial/outcome.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

constexpr double kTerrainPatience = 2.0;  // times what the command promises

// A kind of ground, and what of a scenario makes it at a level other than 0, which is a floor.
struct Kind {
  std::string name;
  std::string unit;
  std::vector<double> levels;
  std::function<sim::Override(double level)> ground;
};

// A mat to step up to, and down from, across the way.
sim::Override mat(double height_mm) {
  return {"ground.shapes",
          fmt::format("[{{box: {{position_m: [0.7, 0], size_m: [0.6, 3, {}]}}}}]", 1e-3 * height_mm)};
}

sim::Override tilted(double roll_deg, double pitch_deg) {
  return {"ground.tilt_deg", fmt::format("[{}, {}]", roll_deg, pitch_deg)};
}

// Strips across the way, half as long again as a foot.
sim::Override slippery_patches(double slipperiness) {
  std::string shapes;
  for (const double x_m : {0.3, 0.6, 0.9, 1.2}) {
    shapes += fmt::format("{}{{patch: {{position_m: [{}, 0], size_m: [0.15, 3], friction: {:.2f}}}}}",
                          shapes.empty() ? "" : ", ", x_m, 1.0 - slipperiness);
  }
  return {"ground.shapes", "[" + shapes + "]"};
}

sim::Override bumps(double height_mm) {
  return {
      "ground.shapes",
      fmt::format(
          "[{{height_field: {{position_m: [1.0, 0], size_m: [1.6, 2], height_m: {}, wavelength_m: 0.1}}}}]",
          1e-3 * height_mm)};
}

const std::vector<Kind>& kinds() {
  static const std::vector<double> kHeights_mm{0, 2, 4, 6, 8, 10};
  static const std::vector<double> kAngles_deg{0, 2, 4, 6, 8, 10};
  static const std::vector<Kind> kKinds{
      {"step", "mm", kHeights_mm, mat},
      {"uphill", "deg", kAngles_deg, [](double angle_deg) { return tilted(0.0, -angle_deg); }},
      {"downhill", "deg", kAngles_deg, [](double angle_deg) { return tilted(0.0, angle_deg); }},
      {"across", "deg", kAngles_deg, [](double angle_deg) { return tilted(angle_deg, 0.0); }},
      {"slippery", "less than mu 1", {0, 0.7, 0.8, 0.85, 0.9, 0.95}, slippery_patches},
      {"bumps", "mm", kHeights_mm, bumps}};
  return kKinds;
}

std::vector<Measure> terrain_measures() {
  using enum Measure::Kind;
  std::vector<Measure> measures{
      {.name = "not_passed", .kind = kEvent, .label = "not passed", .most_share = kMostFailures}};
  const std::vector<Measure> outcomes = outcome_measures();
  measures.insert(measures.end(), outcomes.begin(), outcomes.end());
  measures.insert(measures.end(), {{.name = "speed_m_per_s", .label = "speed [m/s]"},
                                   {.name = "lateral_drift_m", .label = "drift [m]", .decimals = 2},
                                   {.name = "heading_drift_rad", .label = "turned [rad]", .decimals = 2}});
  return measures;
}

Values play(const StandingStart& start, const TerrainOptions& options, std::uint64_t seed) {
  const double patience_s = kTerrainPatience * options.way_m / options.speed_m_per_s;
  Values values = play_in_world(start.walking({options.speed_m_per_s, 0.0, 0.0}, patience_s), kRoughWorld,
                                seed, [&](const simulation::RunRecorder& recorder) {
                                  return recorder.walk().made_good().x() >= options.way_m;
                                });
  const bool arrived =
      values.contains("distance_m") && values.at("distance_m") >= (1.0 - 1e-9) * options.way_m;
  values["not_passed"] = values.at(kLost) != 0.0 || !arrived ? 1.0 : 0.0;
  if (values["not_passed"] != 0.0) {
    for (const char* name : {"speed_m_per_s", "lateral_drift_m", "heading_drift_rad"}) values.erase(name);
  }
  return values;
}

}  // namespace

Terrain make_terrain(const TerrainOptions& options) {
  auto starts = std::make_shared<std::vector<StandingStart>>();
  Terrain terrain;
  std::vector<Cell> cells;
  for (const Kind& kind : kinds()) {
    terrain.ladders.push_back({.name = kind.name, .unit = kind.unit, .cells = {}});
    for (const double level : kind.levels) {
      std::vector<sim::Override> overrides = options.overrides;
      if (level > 0.0) overrides.push_back(kind.ground(level));
      terrain.ladders.back().cells.push_back(starts->size());
      starts->push_back(read_standing_start(options.scenario, overrides));
      const std::string text = sim::number_text(level);
      cells.push_back({kind.name + "-" + text, {{"ground", kind.name}, {"level", text}}});
    }
  }
  terrain.experiment = begin_experiment("terrain", options, starts->front().scenario,
                                        {{"speed_m_per_s", sim::number_text(options.speed_m_per_s)},
                                         {"way_m", sim::number_text(options.way_m)}});
  terrain.experiment.measures = terrain_measures();
  terrain.experiment.cells = std::move(cells);
  terrain.experiment.play = [options, starts](std::size_t cell, std::uint64_t seed) {
    return play(starts->at(cell), options, seed);
  };
  return terrain;
}

Conclusions terrain_conclusions(const Terrain& terrain, const ClimbResult& result) {
  Conclusions conclusions;
  for (std::size_t i = 0; i < terrain.ladders.size(); ++i) {
    const std::string& name = terrain.ladders[i].name;
    const Climb& climb = result.climbs[i];
    conclusions.lines += climb_line(terrain.ladders[i], climb, result);
    conclusions.values[name + "_passed"] =
        climb.highest ? nlohmann::ordered_json(level_of(result.experiment.cells[*climb.highest]))
                      : nlohmann::ordered_json(nullptr);
    conclusions.values[name + "_ended_by"] = stop_name(climb.stop);
  }
  return conclusions;
}

}  // namespace koboshi::tools
