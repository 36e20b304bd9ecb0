#include "lab/catalogue/stand_up.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <utility>

#include "lab/experiment/report.h"
#include "lab/trial/getting_up.h"
#include "lab/trial/scenario_trial.h"
#include "sim_board/description/load.h"
#include "sim_board/engine/make_world.h"
#include "sim_board/random/random_stream.h"
#include "simulation/observe/posture.h"

namespace koboshi::lab {
namespace {

constexpr std::uint64_t kCommand_us = 4'000'000;  // it has settled, and its gyro is calibrated
constexpr double kPatience_s = 45.0;              // for all attempts

constexpr std::array<std::pair<const char*, behaviour::Reason>, 5> kLyingPoses{
    {{"prone", behaviour::Reason::kProne},
     {"supine", behaviour::Reason::kSupine},
     {"left_side", behaviour::Reason::kOnLeftSide},
     {"right_side", behaviour::Reason::kOnRightSide},
     {"seat", behaviour::Reason::kOnSeat}}};

// Uniform over all rotations (Shoemake 1992).
Eigen::Quaterniond random_rotation(sim_board::RandomStream& random) {
  const double u = random.uniform();
  const double a = 2.0 * std::numbers::pi * random.uniform();
  const double b = 2.0 * std::numbers::pi * random.uniform();
  return {std::sqrt(u) * std::cos(b), std::sqrt(1.0 - u) * std::sin(a), std::sqrt(1.0 - u) * std::cos(a),
          std::sqrt(u) * std::sin(b)};
}

// Whether links of the robot are inside each other.
bool is_tangled(const sim_board::RobotDescription& robot, const std::vector<double>& angles_rad) {
  sim_board::WorldOptions options;
  options.fixed_base = true;
  options.X_WB.translation().z() = 1.0;
  options.joint_positions_rad = angles_rad;
  const std::unique_ptr<sim_board::World> world = sim_board::make_world(robot, options);
  world->step();
  return !world->contacts().empty();
}

// The first of the seed's poses that a robot can be in.
std::vector<double> random_pose(const sim_board::RobotDescription& robot, double share, std::uint64_t seed) {
  sim_board::RandomStream random(seed, "pose of the drop");
  std::vector<double> angles_rad(robot.joints.size());
  do {
    for (std::size_t i = 0; i < angles_rad.size(); ++i) {
      const sim_board::JointDescription& joint = robot.joints[i];
      const double half_range_rad = 0.5 * share * (joint.upper_rad - joint.lower_rad);
      angles_rad[i] = 0.5 * (joint.lower_rad + joint.upper_rad) + random.within(half_range_rad);
    }
  } while (is_tangled(robot, angles_rad));
  return angles_rad;
}

simulation::Scenario dropped(const simulation::Scenario& start, const sim_board::RobotDescription& robot,
                             const StandUpOptions& options, std::uint64_t seed) {
  simulation::Scenario scenario = start;
  sim_board::RandomStream attitude(seed, "attitude of the drop");
  scenario.initial = {};
  scenario.initial.drop_m = options.drop_m;
  scenario.initial.R_WB = random_rotation(attitude).toRotationMatrix();
  const std::vector<double> angles_rad = random_pose(robot, options.joint_share, seed);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    scenario.initial.joints.push_back(
        {.joint = {robot.joints[i].name, "a drop of an experiment", 0}, .position_rad = angles_rad[i]});
  }
  scenario.commands = {{.at_us = kCommand_us, .kind = simulation::Command::Kind::kGetUp}};
  scenario.duration_us = kCommand_us + static_cast<std::uint64_t>(1e6 * kPatience_s);
  return scenario;
}

Conclusions conclude(const std::vector<StandUpTrial>& trials) {
  const ShareEstimate down = share_of(trials, &StandUpTrial::down);
  const ShareEstimate not_at_once = share_of(trials, &StandUpTrial::not_at_once);
  Conclusions conclusions;
  conclusions.values["success_rate"] = 1.0 - down.share;
  conclusions.values["first_attempt_rate"] = 1.0 - not_at_once.share;
  conclusions.values["attempts_mean"] =
      mean_of(trials, [](const StandUpTrial& trial) { return trial.history.attempts; }).mean;
  conclusions.lines = fmt::format("stands in {} of {}, at the first attempt in {}\n",
                                  down.count - down.events, down.count, down.count - not_at_once.events);
  for (const auto& [pose, reason] : kLyingPoses) {
    const std::string name = pose;
    std::vector<StandUpTrial> lay;
    std::ranges::copy_if(trials, std::back_inserter(lay),
                         [&](const StandUpTrial& trial) { return trial.history.lay == reason; });
    const QuantileEstimate median = estimate_quantile(values_of(lay, &StandUpTrial::time_s), 0.5);
    const ShareEstimate stays = share_of(lay, &StandUpTrial::down);
    const ShareEstimate again = share_of(lay, &StandUpTrial::not_at_once);
    conclusions.values[name + "_median_s"] = median.value;
    conclusions.values[name + "_trials"] = stays.count;
    conclusions.values[name + "_down"] = stays.events;
    conclusions.values[name + "_not_at_once"] = again.events;
    conclusions.lines +=
        fmt::format("{}: {} trials, {} stay down, {} need more than one attempt, median {:.2f} s\n", name,
                    stays.count, stays.events, again.events - stays.events, median.value);
  }
  return conclusions;
}

}  // namespace

StandUpTrial play_stand_up(const simulation::Scenario& start, const sim_board::RobotDescription& robot,
                           const StandUpOptions& options, std::uint64_t seed) {
  FallObserver observer;
  double stood_s = 0.0;
  behaviour::State state = behaviour::State::kBoot;
  const ScenarioTrial played =
      watch_in_world(dropped(start, robot, options, seed), seed,
                     [&](const simulation::Simulation& simulation, const simulation::RunRecorder& recorder) {
                       observer.observe(simulation, recorder);
                       state = recorder.telemetry().state;
                       if (observer.history().stands > 0 && stood_s == 0.0) {
                         const bool upright = recorder.truth().tilt_rad < simulation::kUpright_rad;
                         if (upright) stood_s = simulation.board().world().time_s();
                       }
                       return stood_s > 0.0 || state == behaviour::State::kFault;
                     });
  const bool stood = stood_s > 0.0;
  StandUpTrial trial{.outcome = outcome_at_end(played, state),
                     .error = played.error,
                     .down = !stood,
                     .not_at_once = !stood || observer.history().attempts != 1,
                     .history = observer.history()};
  if (stood) trial.time_s = stood_s - 1e-6 * static_cast<double>(kCommand_us);
  return trial;
}

const FieldTable<StandUpTrial>& stand_up_fields() {
  using T = StandUpTrial;
  static const FieldTable<T> kFields{
      Fields<T>{
          {{.name = "down", .label = "stays down", .is_loss = true}, &T::down},
          {{"not_at_once", "not at the first attempt"}, &T::not_at_once},
          {{"attempts", "attempts", 2}, &T::history, &FallHistory::attempts},
          {{"time_s", "time [s]", 2}, &T::time_s},
          {{"peak_motor_torque_Nm", "motor, peak [N m]", 2}, &T::history, &FallHistory::peak_motor_torque_Nm},
          {{"peak_torque_Nm", "gears, peak [N m]", 2}, &T::history, &FallHistory::peak_torque_Nm},
          {{"peak_winding_C", "hottest winding [C]", 1}, &T::history, &FallHistory::peak_winding_C},
          {{"lay"}, &T::history, &FallHistory::lay}},
      outcome_fields<T>(&T::outcome, kLossesButFalls)};
  return kFields;
}

Experiment make_stand_up(const StandUpOptions& options) {
  const StandingStart start = read_standing_start(options, options.overrides);
  Experiment experiment =
      begin_experiment("stand-up", "How it gets up", options, start.scenario,
                       {{"drop_m", options.drop_m}, {"joint_share", options.joint_share}});
  experiment.cells = {{"dropped", {{"lies", "as it was dropped"}}}};
  set_trials(
      experiment, stand_up_fields(),
      [options, start, robot = sim_board::load_robot(start.scenario.robot)](std::size_t, std::uint64_t seed) {
        return play_stand_up(start.scenario, robot, options, seed);
      });
  experiment.conclude = [](const Experiment&, const ExperimentResult& result) {
    return conclude(stand_up_fields().trials(result.cells.front()));
  };
  return experiment;
}

}  // namespace koboshi::lab
