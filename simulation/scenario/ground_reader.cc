#include "simulation/scenario/ground_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/text/user_units.h"
#include "simulation/scenario/height_file.h"
#include "simulation/scenario/paths.h"

namespace koboshi::simulation {
namespace {

namespace fs = std::filesystem;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSteepest_deg = 45.0;

constexpr NumberRange kFriction{.min = 0.0, .max = 10.0};
constexpr NumberRange kStiffness_N_per_m{.min = 100.0, .max = 1e8};
constexpr NumberRange kDamping_N_s_per_m{.min = 0.0, .max = 1e6};
constexpr NumberRange kBounce{.min = 0.0, .max = 1.0};
constexpr NumberRange kBounceThreshold_m_per_s{.min = 0.0, .max = 10.0};
constexpr NumberRange kSlip_m_per_N_s{.min = 0.0, .max = 10.0};
constexpr NumberRange kPosition_m{.min = -100.0, .max = 100.0};
constexpr NumberRange kLength_m{.min = 0.001, .max = 100.0};
constexpr NumberRange kHeight_m{.min = 0.0001, .max = 10.0};
constexpr NumberRange kTurn_deg{.min = -360.0, .max = 360.0};
constexpr std::int64_t kMaxGroundSteps = 200;

// Reads one number for all directions, or a list of two.
std::array<double, 2> read_friction(const YamlValue& value) {
  if (!value.is_list()) {
    const double friction = value.number(kFriction);
    return {friction, friction};
  }
  const std::vector<double> friction = value.numbers(2, kFriction);
  return {friction[0], friction[1]};
}

std::optional<double> read_optional(const YamlMap& map, const std::string& key, const NumberRange& range) {
  if (!map.has(key)) return std::nullopt;
  return map.number(key, range);
}

// A stiffness requires a damping; a damping alone is reported as an unknown key.
std::optional<std::array<double, 2>> read_spring(const YamlMap& map) {
  if (!map.has("stiffness_N_per_m")) return std::nullopt;
  return std::array{map.number("stiffness_N_per_m", kStiffness_N_per_m),
                    map.number("damping_N_s_per_m", kDamping_N_s_per_m)};
}

GroundSurface read_surface(const YamlMap& map) {
  GroundSurface surface;
  if (map.has("material")) surface.material = map.text("material");
  if (map.has("friction")) {
    const auto friction = read_friction(map.value("friction"));
    surface.friction = friction[0];
    surface.friction_second = friction[1];
  }
  if (const auto direction_deg = read_optional(map, "friction_direction_deg", kTurn_deg))
    surface.friction_direction_rad = *direction_deg * kRadPerDegree;
  if (const auto spring = read_spring(map)) surface.softness = {(*spring)[0], (*spring)[1]};
  surface.bounce = read_optional(map, "bounce", kBounce);
  surface.bounce_threshold_m_per_s = read_optional(map, "bounce_threshold_m_per_s", kBounceThreshold_m_per_s);
  surface.slip_m_per_N_s = read_optional(map, "slip_m_per_N_s", kSlip_m_per_N_s);
  return surface;
}

// Reads the pose of a shape on the plane: position and rotation about the plane's normal.
Isometry3d read_place(const YamlMap& map) {
  const std::vector<double> p_m = map.numbers("position_m", 2, kPosition_m);
  const double yaw_rad = map.number("yaw_deg", kTurn_deg, 0.0) * kRadPerDegree;
  return Translation3d(p_m[0], p_m[1], 0.0) * AngleAxisd(yaw_rad, Vector3d::UnitZ());
}

Vector2d read_area(const YamlMap& map) {
  const std::vector<double> size_m = map.numbers("size_m", 2, kLength_m);
  return {size_m[0], size_m[1]};
}

double read_bottom_m(const YamlMap& map) { return map.number("bottom_m", {.min = -10.0, .max = 10.0}, 0.0); }

sim_board::GroundBox read_box(const YamlMap& map) {
  const std::vector<double> size_m = map.numbers("size_m", 3, kLength_m);
  sim_board::GroundBox box;
  box.size_m = {size_m[0], size_m[1], size_m[2]};
  box.X_WG = read_place(map) * Translation3d(0.0, 0.0, read_bottom_m(map));
  if (map.has("tilt_deg")) {
    const std::vector<double> tilt = map.numbers("tilt_deg", 2, kTurn_deg);
    box.X_WG = box.X_WG * AngleAxisd(tilt[1] * kRadPerDegree, Vector3d::UnitY()) *
               AngleAxisd(tilt[0] * kRadPerDegree, Vector3d::UnitX());
  }
  box.X_WG = box.X_WG * Translation3d(0.0, 0.0, 0.5 * box.size_m.z());
  return box;
}

sim_board::GroundBox read_ramp(const YamlMap& map) {
  return sim_board::ramp_box(
      {.X_WR = read_place(map),
       .length_m = map.number("length_m", kLength_m),
       .width_m = map.number("width_m", kLength_m),
       .angle_rad = map.number("angle_deg", {.min = 0.1, .max = kSteepest_deg}) * kRadPerDegree});
}

std::vector<sim_board::GroundBox> read_steps(const YamlMap& map) {
  return sim_board::stair_boxes(
      {.X_WR = read_place(map),
       .count = static_cast<int>(map.integer("count", {.min = 1, .max = kMaxGroundSteps})),
       .rise_m = map.number("rise_m", kHeight_m),
       .run_m = map.number("run_m", kLength_m),
       .width_m = map.number("width_m", kLength_m)});
}

sim_board::FrictionPatch read_patch(const YamlMap& map) {
  sim_board::FrictionPatch patch;
  patch.X_WP = read_place(map);
  if (map.has("size_m") && map.has("radius_m"))
    throw map.error_at("radius_m", "radius_m beside size_m", "one of the two");
  if (map.has("radius_m")) {
    patch.outline = sim_board::FrictionPatch::Outline::kDisc;
    patch.size_m = Vector2d::Constant(2.0 * map.number("radius_m", kLength_m));
  } else {
    patch.size_m = read_area(map);
  }
  return patch;
}

sim_board::HeightField read_height_map(const YamlMap& map, const fs::path& folder) {
  const YamlValue file = map.value("file");
  HeightFile heights = read_height_file(read_path(file, folder));
  if (heights.is_image) {
    const double white_m = map.number("height_m", kHeight_m);
    for (double& height_m : heights.field.heights_m) height_m *= white_m;
  } else if (map.has("height_m")) {
    throw map.error_at("height_m", "height_m of a file that is no image",
                       "heights in m in the file, and no height_m");
  }
  heights.field.X_WF = read_place(map) * Translation3d(0.0, 0.0, read_bottom_m(map));
  heights.field.size_m = read_area(map);
  return heights.field;
}

RoughGround read_rough(const YamlMap& map) {
  RoughGround rough;
  rough.X_WF = read_place(map) * Translation3d(0.0, 0.0, read_bottom_m(map));
  rough.size_m = read_area(map);
  rough.height_m = map.number("height_m", kHeight_m);
  rough.wavelength_m = map.number("wavelength_m", kLength_m);
  constexpr double kPointsOfWave = 5.0;
  const double finest_m = rough.size_m.maxCoeff() / (kMaxHeightPoints - 1.0);
  const double default_m = std::max(finest_m, rough.wavelength_m / kPointsOfWave);
  rough.spacing_m = map.number("spacing_m", {.min = finest_m, .max = 1.0}, default_m);
  if (map.has("seed")) rough.seed = static_cast<std::uint64_t>(map.integer("seed", {.min = 0}));
  return rough;
}

// Reads a height field from a file, or a randomly generated one.
GroundShape read_height_field(const YamlMap& map, const fs::path& folder) {
  if (map.has("file")) return {read_height_map(map, folder), read_surface(map)};
  if (!map.has("wavelength_m"))
    throw map.error_at("size_m", "a height field without file and wavelength_m", "one of the two");
  return {read_rough(map), read_surface(map)};
}

void read_shape(const YamlValue& item, const fs::path& folder, std::vector<GroundShape>& shapes) {
  static const std::vector<std::string> kKinds{"box", "ramp", "steps", "patch", "height_field"};
  const YamlMap map = item.map();
  const auto has = [&](const std::string& kind) { return map.has(kind); };
  const auto count = std::ranges::count_if(kKinds, has);
  if (count != 1)
    throw item.error("a shape of " + std::to_string(count) + " kinds",
                     "just one of " + join_alternatives(kKinds));
  const std::string kind = *std::ranges::find_if(kKinds, has);
  const YamlMap shape = map.child(kind);
  if (kind == "height_field") return shapes.push_back(read_height_field(shape, folder));
  const GroundSurface surface = read_surface(shape);
  if (kind == "box") shapes.push_back({read_box(shape), surface});
  if (kind == "ramp") shapes.push_back({read_ramp(shape), surface});
  if (kind == "patch") shapes.push_back({read_patch(shape), surface});
  if (kind == "steps")
    for (const sim_board::GroundBox& box : read_steps(shape)) shapes.push_back({box, surface});
}

NamedMaterialPair read_pair(const YamlValue& item) {
  const YamlMap map = item.map();
  const std::vector<YamlValue> names = map.list("between");
  if (names.size() != 2)
    throw map.error_at("between", std::to_string(names.size()) + " materials", "a list of two");
  NamedMaterialPair named;
  for (std::size_t i = 0; i < 2; ++i) {
    named.names[i] = {names[i].text(), names[i].source(), names[i].line()};
    named.pair.between[i] = names[i].text();
  }
  if (map.has("friction")) named.pair.friction = read_friction(map.value("friction"));
  named.pair.bounce = read_optional(map, "bounce", kBounce);
  named.pair.bounce_threshold_m_per_s =
      read_optional(map, "bounce_threshold_m_per_s", kBounceThreshold_m_per_s);
  if (const auto spring = read_spring(map)) named.pair.spring = {(*spring)[0], (*spring)[1]};
  named.pair.slip_m_per_N_s = read_optional(map, "slip_m_per_N_s", kSlip_m_per_N_s);
  return named;
}

// A ball has a diameter, a box a size.
FreeBody read_body(const YamlValue& item) {
  constexpr NumberRange kMass_kg{.min = 0.001, .max = 100.0};
  constexpr NumberRange kSize_m{.min = 0.005, .max = 10.0};
  constexpr NumberRange kSpeed_m_per_s{.min = -50.0, .max = 50.0};
  const YamlMap map = item.map();
  FreeBody body;
  body.name = {map.text("name"), item.source(), item.line()};
  body.body.name = body.name.text;
  sim_board::FreeBodyDescription& described = body.body;
  if (map.has("diameter_m") && map.has("size_m"))
    throw map.error_at("size_m", "size_m beside diameter_m", "one of the two");
  if (map.has("size_m")) {
    const std::vector<double> size_m = map.numbers("size_m", 3, kSize_m);
    described.shape = sim_board::FreeBodyDescription::Shape::kBox;
    described.size_m = {size_m[0], size_m[1], size_m[2]};
  } else {
    described.size_m = Vector3d::Constant(map.number("diameter_m", kSize_m));
  }
  described.mass_kg = map.number("mass_kg", kMass_kg);
  described.friction = map.number("friction", kFriction, described.friction);
  if (described.shape == sim_board::FreeBodyDescription::Shape::kSphere)
    described.rolling_friction = map.number("rolling_friction", {.min = 0.0, .max = 1.0}, 0.0);
  described.bounce = map.number("bounce", kBounce, described.bounce);
  described.contact_time_s =
      1e-3 * map.number("contact_time_ms", {.min = 1.0, .max = 50.0}, 1e3 * described.contact_time_s);
  const std::vector<double> p_m = map.numbers("position_m", 2, kPosition_m);
  described.X_WF = Translation3d(p_m[0], p_m[1], 0.0) *
                   AngleAxisd(map.number("yaw_deg", kTurn_deg, 0.0) * kRadPerDegree, Vector3d::UnitZ());
  body.on_ground = !map.has("height_m");
  if (!body.on_ground)
    described.X_WF.translation().z() = map.number("height_m", {.min = -10.0, .max = 100.0});
  if (map.has("velocity_m_per_s")) {
    const std::vector<double> v = map.numbers("velocity_m_per_s", 3, kSpeed_m_per_s);
    described.v_WF_W = {v[0], v[1], v[2]};
  }
  return body;
}

bool same_materials(const sim_board::MaterialPair& a, const sim_board::MaterialPair& b) {
  return a.between == b.between || a.between == std::array{b.between[1], b.between[0]};
}

}  // namespace

Ground read_ground(const YamlMap& root, const fs::path& folder) {
  Ground ground;
  const auto map = root.optional_child("ground");
  if (!map) return ground;
  static_cast<GroundSurface&>(ground) = read_surface(*map);
  if (map->has("tilt_deg")) {
    const std::vector<double> tilt =
        map->numbers("tilt_deg", 2, {.min = -kSteepest_deg, .max = kSteepest_deg});
    ground.roll_rad = tilt[0] * kRadPerDegree;
    ground.pitch_rad = tilt[1] * kRadPerDegree;
  }
  if (map->has("shapes"))
    for (const YamlValue& item : map->list("shapes")) read_shape(item, folder, ground.shapes);
  return ground;
}

std::vector<NamedMaterialPair> read_materials(const YamlMap& root) {
  std::vector<NamedMaterialPair> pairs;
  if (!root.has("materials")) return pairs;
  for (const YamlValue& item : root.list("materials")) {
    NamedMaterialPair pair = read_pair(item);
    const auto is_same = [&](const NamedMaterialPair& other) {
      return same_materials(pair.pair, other.pair);
    };
    if (std::ranges::any_of(pairs, is_same))
      throw item.error(
          "a second pair of " + one_line(pair.names[0].text) + " and " + one_line(pair.names[1].text),
          "each pair once");
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

std::vector<FreeBody> read_bodies(const YamlMap& root) {
  std::vector<FreeBody> bodies;
  if (!root.has("bodies")) return bodies;
  for (const YamlValue& item : root.list("bodies")) {
    FreeBody body = read_body(item);
    const auto is_same = [&](const FreeBody& other) { return other.body.name == body.body.name; };
    if (std::ranges::any_of(bodies, is_same))
      throw item.error("a second body " + one_line(body.body.name), "bodies of different names");
    bodies.push_back(std::move(body));
  }
  if (bodies.size() > 16)
    throw root.error_at("bodies", std::to_string(bodies.size()) + " bodies", "at most 16");
  return bodies;
}

}  // namespace koboshi::simulation
