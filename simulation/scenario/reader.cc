#include "simulation/scenario/reader.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/text/user_units.h"
#include "firmware/motion/roles.h"
#include "sim_board/description/load.h"
#include "sim_board/engine/make_world.h"
#include "simulation/scenario/events.h"
#include "simulation/scenario/ground_reader.h"
#include "simulation/scenario/motion_set_reader.h"
#include "simulation/scenario/paths.h"

namespace koboshi::simulation {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxRun_s = 86400.0;

// Motions with a purpose: those that the behaviour plays by itself, and the way to the standing pose, which
// is else a straight line in joint angles. A robot without one lacks an ability, but works.
bool has_purpose(const std::string& name) {
  return name == "stand" || std::ranges::find(motion::kMotionNames, name) != motion::kMotionNames.end();
}

// The parameter file with a purpose: the feedback of a robot that stands. Without it the robot stands by its
// servos alone.
constexpr const char* kStandingParameters = "standing";

std::vector<MotionChoice> read_motions(const YamlMap& root, const fs::path& folder, const fs::path& robot,
                                       std::vector<std::string>& missing) {
  std::vector<MotionChoice> motions;
  if (!root.has("motions")) return motions;
  for (const YamlValue& value : root.list("motions")) {
    if (has_purpose(value.text()) && !has_robot_file(value, folder, robot, "motions")) {
      missing.push_back(value.text());
      continue;
    }
    const MotionChoice motion{.file = read_robot_file(value, folder, robot, "motions")};
    if (std::ranges::find(motions, motion.name(), &MotionChoice::name) != motions.end()) {
      throw value.error("a second motion named " + motion.name(), "motions of different names");
    }
    motions.push_back(motion);
  }
  read_motion_set(root, motions);
  return motions;
}

std::optional<GaitChoice> read_gait(const YamlMap& root, const fs::path& folder, const fs::path& robot) {
  const auto map = root.optional_child("gait");
  if (!map) return std::nullopt;
  GaitChoice gait{.file = read_robot_file(map->value("file"), folder, robot, "gaits"), .overrides = {}};
  gait.feedback = map->boolean("feedback", true);
  if (map->has("points")) {
    const YamlValue points = map->value("points");
    gait.overrides.push_back({"points", points.text(), points.source().string()});
  }
  if (const auto set = map->optional_child("set")) {
    for (const auto& [key, value] : set->entries())
      gait.overrides.push_back({key, value.text(), value.source().string()});
  }
  return gait;
}

void check_motion_names(const Scenario& scenario, const YamlMap& root) {
  if (!scenario.gait) return;
  if (std::ranges::find(scenario.motions, kGaitMotion, &MotionChoice::name) != scenario.motions.end()) {
    throw root.error_at("gait", std::string("a gait beside a motion named ") + kGaitMotion, "one of the two");
  }
}

// Keys may have dots or be nested: left_shank.mass: 80 g, or left_shank: {mass: 80 g}.
void add_plant(const YamlMap& map, const std::string& prefix, std::vector<PlantSetting>& plant) {
  for (const auto& [key, value] : map.entries()) {
    const std::string path = prefix + key;
    if (value.is_map()) {
      add_plant(value.map(), path + ".", plant);
    } else {
      plant.push_back({{path, value.source().string(), value.line()}, value.text()});
    }
  }
}

// Reads true, false, or a factor.
double read_noise_scale(const YamlMap& root) {
  if (!root.has("noise")) return 1.0;
  const YamlValue value = root.value("noise");
  const bool is_word =
      !value.is_map() && !value.is_list() && (value.text() == "true" || value.text() == "false");
  if (is_word) return value.boolean() ? 1.0 : 0.0;
  return value.number({.min = 0.0, .max = 100.0});
}

// Reads the name of a world, or a map of its name and the seed of its draw.
std::optional<WorldChoice> read_world(const YamlMap& root) {
  if (!root.has("world")) return std::nullopt;
  const YamlValue value = root.value("world");
  if (!value.is_map()) return WorldChoice{world_named(root.one_of("world", world_names())), std::nullopt};
  const YamlMap map = value.map();
  WorldChoice world{world_named(map.one_of("name", world_names())), std::nullopt};
  if (map.has("seed")) world.seed = static_cast<std::uint64_t>(map.integer("seed", {.min = 0}));
  return world;
}

// A tick that is late and its computing time end before the next tick.
void read_controller(const YamlMap& root, Scenario& scenario) {
  constexpr std::int64_t kMaxTick_us = 9000;
  const auto controller = root.optional_child("controller");
  if (controller) {
    scenario.computing_time_us = static_cast<std::uint64_t>(
        controller->integer("computing_time_us", {.min = 0, .max = kMaxTick_us}, 500));
    scenario.tick_jitter_us =
        static_cast<std::uint64_t>(controller->integer("tick_jitter_us", {.min = 0, .max = kMaxTick_us}, 0));
  }
  const double drawn_us = scenario.world ? 1e6 * scenario.world->ranges.tick_jitter_s.high : 0.0;
  const auto latest_us = scenario.computing_time_us + scenario.tick_jitter_us +
                         static_cast<std::uint64_t>(std::llround(drawn_us));
  if (latest_us > kMaxTick_us) {
    throw root.error_at(
        "controller",
        std::to_string(latest_us) + " us of computing time and jitter, that of the world included",
        "at most " + std::to_string(kMaxTick_us) + " us");
  }
}

sim_board::Stepper read_stepper(const YamlMap& physics, sim_board::Stepper preset) {
  const sim_board::Stepper stepper = *sim_board::stepper_named(
      physics.one_of("stepper", sim_board::stepper_names(), std::string(sim_board::name_of(preset))));
  if (stepper == sim_board::Stepper::kMujoco && !sim_board::has_mujoco()) {
    throw physics.error_at("stepper", "mujoco, which this program was built without",
                           "world or lumped, or a program built where libmujoco-dev is installed");
  }
  return stepper;
}

Physics read_physics(const YamlMap& root) {
  Physics physics;
  const auto map = root.optional_child("physics");
  if (!map) return physics;
  const double step_us = 1000.0 * map->number("step_ms", {.min = 0.01, .max = 1.0}, 1.0);
  physics.step_us = static_cast<std::uint64_t>(std::llround(step_us));
  if (std::abs(step_us - std::round(step_us)) > 1e-6 || 1000 % physics.step_us != 0) {
    throw map->value("step_ms").error("a whole number of microseconds that divides 1 ms");
  }
  physics.stepper = read_stepper(*map, physics.stepper);
  const std::string friction = map->one_of("friction", {"rows", "lock_and_check"}, "lock_and_check");
  physics.friction =
      friction == "rows" ? sim_board::FrictionMethod::kRows : sim_board::FrictionMethod::kLockAndCheck;
  return physics;
}

// Reads fixed-axis angles as in an SDF pose: about the world's x, then y, then z axis.
Eigen::Matrix3d read_attitude(const YamlMap& map) {
  constexpr NumberRange kTurn{.min = -360.0, .max = 360.0};
  const auto about = [&](const char* name, const Eigen::Vector3d& axis_W) {
    return Eigen::AngleAxisd(map.number(name, kTurn, 0.0) * kRadPerDegree, axis_W);
  };
  return (about("yaw", Eigen::Vector3d::UnitZ()) * about("pitch", Eigen::Vector3d::UnitY()) *
          about("roll", Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

InitialState read_initial(const YamlMap& root) {
  InitialState initial;
  const auto map = root.optional_child("initial");
  if (!map) return initial;
  if (map->has("height_m")) initial.base_height_m = map->number("height_m", {.min = 0.0, .max = 10.0});
  if (map->has("drop_m")) {
    if (initial.base_height_m) throw map->error_at("drop_m", "drop_m beside height_m", "one of the two");
    initial.drop_m = map->number("drop_m", {.min = 0.0, .max = 10.0});
  }
  if (const auto attitude = map->optional_child("attitude_deg")) initial.R_WB = read_attitude(*attitude);
  initial.fixed_base = map->boolean("fixed_base", false);
  if (map->has("held_until_s")) {
    if (initial.fixed_base)
      throw map->error_at("held_until_s", "held_until_s beside fixed_base", "one of the two");
    initial.fixed_base = true;
    initial.release_us = to_us(map->number("held_until_s", {.min = 0.0, .max = kMaxRun_s}));
  }
  if (const auto joints = map->optional_child("joints_deg")) {
    for (const auto& [name, value] : joints->entries()) {
      const double position_deg = value.number({.min = -360.0, .max = 360.0});
      initial.joints.push_back({{name, value.source(), value.line()}, position_deg * kRadPerDegree});
    }
  }
  return initial;
}

void add_parameters(const YamlMap& root, std::vector<ParameterSetting>& parameters) {
  const auto map = root.optional_child("parameters");
  if (!map) return;
  for (const auto& [name, value] : map->entries()) {
    std::erase_if(parameters, [&](const ParameterSetting& before) { return before.name.text == name; });
    parameters.push_back({{name, value.source(), value.line()}, value.number()});
  }
}

void add_parameters_of_file(const fs::path& file, std::vector<ParameterSetting>& parameters) {
  const YamlFile yaml(file);
  const YamlMap root = yaml.root();
  root.require_version(1);
  if (root.has("robot")) {
    throw root.error_at("robot", "the parameters of a robot, which its storage holds in every run",
                        "a file of further parameters, with version and parameters");
  }
  add_parameters(root, parameters);
  yaml.finish();
}

void read_parameter_file(const YamlMap& root, const fs::path& folder, Scenario& scenario) {
  if (!root.has("parameter_file")) return;
  const YamlValue value = root.value("parameter_file");
  if (value.text() == kStandingParameters && !has_robot_file(value, folder, scenario.robot)) {
    scenario.missing_parameter_file = value.text();
    return;
  }
  scenario.parameter_file = read_robot_file(value, folder, scenario.robot);
  add_parameters_of_file(*scenario.parameter_file, scenario.parameters);
}

}  // namespace

RobotParameters read_robot_parameters(const fs::path& robot) {
  const fs::path file = robot.parent_path() / "parameters.yaml";
  if (!fs::exists(file)) return {};
  return read_robot_parameters(YamlFile(file));
}

RobotParameters read_robot_parameters(const YamlFile& yaml) {
  const YamlMap root = yaml.root();
  root.require_version(1);
  RobotParameters parameters{.file = yaml.path(), .robot = {}, .settings = {}};
  parameters.robot = {root.text("robot"), yaml.path().string(), root.line_of("robot")};
  add_parameters(root, parameters.settings);
  yaml.finish();
  return parameters;
}

std::vector<PlantSetting> read_plant_settings(const YamlMap& root) {
  std::vector<PlantSetting> plant;
  if (const auto map = root.optional_child("plant")) add_plant(*map, "", plant);
  return plant;
}

Scenario read_scenario(const fs::path& file, std::span<const Override> overrides) {
  const YamlFile yaml(file, overrides);
  const YamlMap root = yaml.root();
  const fs::path folder = file.parent_path();
  Scenario scenario;
  scenario.file = file;
  scenario.document = yaml.tree();
  root.require_version(1);
  scenario.robot = read_input(root.value("robot"), folder, InputKind::kRobot);
  scenario.robot_parameters = read_robot_parameters(scenario.robot);
  scenario.plant = read_plant_settings(root);
  scenario.motions = read_motions(root, folder, scenario.robot, scenario.missing_motions);
  scenario.gait = read_gait(root, folder, scenario.robot);
  scenario.duration_us = to_us(root.number("duration_s", {.min = 0.01, .max = kMaxRun_s}));
  scenario.seed = static_cast<std::uint64_t>(root.integer("seed", {.min = 0}, 1));
  scenario.noise_scale = read_noise_scale(root);
  scenario.world = read_world(root);
  read_controller(root, scenario);
  scenario.teleop = root.boolean("teleop", false);
  scenario.physics = read_physics(root);
  scenario.ground = read_ground(root, folder);
  scenario.materials = read_materials(root);
  scenario.bodies = read_bodies(root);
  scenario.initial = read_initial(root);
  if (root.has("policy")) scenario.policy = read_robot_file(root.value("policy"), folder, scenario.robot);
  read_parameter_file(root, folder, scenario);
  add_parameters(root, scenario.parameters);
  check_motion_names(scenario, root);
  scenario.commands = read_commands(root, motion_names(scenario));
  scenario.pushes = read_pushes(root);
  scenario.faults = read_faults(root);
  yaml.finish();
  return scenario;
}

sim_board::RobotDescription read_robot(const Scenario& scenario) {
  sim_board::RobotDescription robot = sim_board::load_robot(scenario.robot);
  check(scenario, robot);
  return robot;
}

}  // namespace koboshi::simulation
