#include "tools/lab/catalogue/stand_up.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <numbers>

#include "sim_board/engine/make_world.h"
#include "sim_board/input/text.h"
#include "sim_board/random/random_stream.h"
#include "sim_board/robot/load.h"
#include "tools/lab/trial/fall_observer.h"
#include "tools/lab/trial/getting_up.h"
#include "tools/lab/trial/scenario_trial.h"

namespace koboshi::tools {
namespace {

constexpr std::uint64_t kCommand_us = 4'000'000;  // it has settled, and its gyro is calibrated
constexpr double kPatience_s = 45.0;              // for all attempts

const std::vector<std::pair<std::string, behaviour::Reason>>& lying_poses() {
  static const std::vector<std::pair<std::string, behaviour::Reason>> kPoses{
      {"prone", behaviour::Reason::kProne},
      {"supine", behaviour::Reason::kSupine},
      {"left_side", behaviour::Reason::kOnLeftSide},
      {"right_side", behaviour::Reason::kOnRightSide},
      {"seat", behaviour::Reason::kOnSeat}};
  return kPoses;
}

// Uniform over all rotations (Shoemake 1992).
Eigen::Quaterniond random_rotation(sim::RandomStream& random) {
  const double u = random.uniform();
  const double a = 2.0 * std::numbers::pi * random.uniform();
  const double b = 2.0 * std::numbers::pi * random.uniform();
  return {std::sqrt(u) * std::cos(b), std::sqrt(1.0 - u) * std::sin(a), std::sqrt(1.0 - u) * std::cos(a),
          std::sqrt(u) * std::sin(b)};
}

// Whether links of the robot are inside each other.
bool is_tangled(const sim::RobotDescription& robot, const std::vector<double>& angles_rad) {
  sim::WorldOptions options;
  options.fixed_base = true;
  options.X_WB.translation().z() = 1.0;
  options.joint_positions_rad = angles_rad;
  const std::unique_ptr<sim::World> world = sim::make_world(robot, options);
  world->step();
  return !world->contacts().empty();
}

// The first of the seed's poses that a robot can be in.
std::vector<double> random_pose(const sim::RobotDescription& robot, double share, std::uint64_t seed) {
  sim::RandomStream random(seed, "pose of the drop");
  std::vector<double> angles_rad(robot.joints.size());
  do {
    for (std::size_t i = 0; i < angles_rad.size(); ++i) {
      const sim::JointDescription& joint = robot.joints[i];
      const double half_range_rad = 0.5 * share * (joint.upper_rad - joint.lower_rad);
      angles_rad[i] = 0.5 * (joint.lower_rad + joint.upper_rad) + random.within(half_range_rad);
    }
  } while (is_tangled(robot, angles_rad));
  return angles_rad;
}

sim::Scenario dropped(const sim::Scenario& start, const sim::RobotDescription& robot,
                      const StandUpOptions& options, std::uint64_t seed) {
  sim::Scenario scenario = start;
  sim::RandomStream attitude(seed, "attitude of the drop");
  scenario.initial = {};
  scenario.initial.drop_m = options.drop_m;
  scenario.initial.R_WB = random_rotation(attitude).toRotationMatrix();
  const std::vector<double> angles_rad = random_pose(robot, options.joint_share, seed);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    scenario.initial.joints.push_back(
        {.joint = {robot.joints[i].name, "a drop of an experiment", 0}, .position_rad = angles_rad[i]});
  }
  scenario.commands = {{.at_us = kCommand_us, .kind = sim::Command::Kind::kGetUp}};
  scenario.duration_us = kCommand_us + static_cast<std::uint64_t>(1e6 * kPatience_s);
  return scenario;
}

Values play(const sim::Scenario& start, const sim::RobotDescription& robot, const StandUpOptions& options,
            std::uint64_t seed) {
  FallObserver observer;
  double stood_s = 0.0;
  behaviour::State state = behaviour::State::kBoot;
  const Values played =
      watch_in_world(dropped(start, robot, options, seed), kRoughWorld, seed,
                     [&](const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
                       observer.observe(simulation, recorder);
                       state = recorder.telemetry().state;
                       if (observer.stands() > 0 && stood_s == 0.0) {
                         const bool upright = recorder.truth().tilt_rad < kUpright_rad;
                         if (upright) stood_s = simulation.board().world().time_s();
                       }
                       return stood_s > 0.0 || state == behaviour::State::kFault;
                     });
  const bool faulted = state == behaviour::State::kFault || state == behaviour::State::kEmergencyStop;
  Values values{{"gave_up", faulted ? 1.0 : 0.0},
                {"low_supply", state == behaviour::State::kLowBattery ? 1.0 : 0.0},
                {"energy_guard", played.at("energy_guard")},
                {"failed", played.at("failed")},
                {"down", stood_s > 0.0 ? 0.0 : 1.0},
                {"not_at_once", stood_s > 0.0 && observer.attempts() == 1 ? 0.0 : 1.0},
                {"attempts", observer.attempts()},
                {"lay", static_cast<double>(observer.lay())},
                {"peak_torque_Nm", observer.peak_torque_Nm()},
                {"peak_motor_torque_Nm", observer.peak_motor_torque_Nm()},
                {"peak_winding_C", observer.peak_winding_C()}};
  values.error = played.error;
  if (stood_s > 0.0) values["time_s"] = stood_s - 1e-6 * static_cast<double>(kCommand_us);
  return values;
}

std::vector<Trial> that_lay(const CellResult& cell, behaviour::Reason pose) {
  std::vector<Trial> trials;
  for (const Trial& trial : cell.played) {
    if (trial.values.at("lay") == static_cast<double>(pose)) trials.push_back(trial);
  }
  return trials;
}

}  // namespace

Experiment make_stand_up(const StandUpOptions& options) {
  const auto start =
      std::make_shared<StandingStart>(read_standing_start(options.scenario, options.overrides));
  const auto robot = std::make_shared<sim::RobotDescription>(sim::load_robot(start->scenario.robot));
  Experiment experiment = begin_experiment(
      "stand-up", options, start->scenario,
      {{"drop_m", sim::number_text(options.drop_m)}, {"joint_share", sim::number_text(options.joint_share)}});
  using enum Measure::Kind;
  experiment.measures = {{.name = "down", .kind = kEvent, .label = "stays down"},
                         {.name = "not_at_once", .kind = kEvent, .label = "not at the first attempt"},
                         {.name = "attempts", .label = "attempts", .decimals = 2},
                         {.name = "time_s", .label = "time [s]", .decimals = 2},
                         {.name = "peak_motor_torque_Nm", .label = "motor, peak [N m]", .decimals = 2},
                         {.name = "peak_torque_Nm", .label = "gears, peak [N m]", .decimals = 2},
                         {.name = "peak_winding_C", .label = "hottest winding [C]", .decimals = 1},
                         {.name = "lay"},
                         {.name = "gave_up", .kind = kEvent, .label = "given up"},
                         {.name = "low_supply", .kind = kEvent, .label = "low supply"},
                         {.name = "energy_guard", .kind = kEvent, .label = "energy guard"},
                         {.name = "failed", .kind = kEvent}};
  experiment.cells = {{"dropped", {{"lies", "as it was dropped"}}}};
  experiment.play = [options, start, robot](std::size_t, std::uint64_t seed) {
    return play(start->scenario, *robot, options, seed);
  };
  return experiment;
}

Conclusions stand_up_conclusions(const Experiment& experiment, const ExperimentResult& result) {
  const CellResult& cell = result.cells.front();
  const ShareEstimate down = share_of(cell, experiment.measures[0]);
  const ShareEstimate not_at_once = share_of(cell, experiment.measures[1]);
  Conclusions conclusions;
  conclusions.values["success_rate"] = 1.0 - down.share;
  conclusions.values["first_attempt_rate"] = 1.0 - not_at_once.share;
  conclusions.values["attempts_mean"] = mean_of(cell, experiment.measures[2]).mean;
  conclusions.lines = fmt::format("stands in {} of {}, at the first attempt in {}\n",
                                  down.count - down.events, down.count, down.count - not_at_once.events);
  for (const auto& [name, pose] : lying_poses()) {
    const CellResult lay{.played = that_lay(cell, pose)};
    const QuantileEstimate median = estimate_quantile(values_of(lay, experiment.measures[3]), 0.5);
    const ShareEstimate stays = share_of(lay, experiment.measures[0]);
    const ShareEstimate again = share_of(lay, experiment.measures[1]);
    conclusions.values[name + "_median_s"] = median.count > 0 ? median.value : std::nan("");
    conclusions.values[name + "_trials"] = stays.count;
    conclusions.values[name + "_down"] = stays.events;
    conclusions.values[name + "_not_at_once"] = again.events;
    conclusions.lines +=
        fmt::format("{}: {} trials, {} stay down, {} need more than one attempt, median {:.2f} s\n", name,
                    stays.count, stays.events, again.events - stays.events, median.value);
  }
  return conclusions;
}

}  // namespace koboshi::tools
