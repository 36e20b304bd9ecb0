#include "tools/run/simulation.h"

#include <string>
#include <utility>

#include "firmware/app/catalogue.h"
#include "firmware/fixed/host/convert.h"
#include "sim_board/input/error.h"
#include "sim_board/robot/load.h"
#include "tools/gait/gait_motion.h"
#include "tools/motion/compile.h"
#include "tools/run/in_process_host.h"
#include "tools/run/parameters.h"
#include "tools/run/storage_contents.h"

namespace koboshi::tools {
namespace {

sim::RobotDescription load_checked(const sim::Scenario& scenario) {
  sim::RobotDescription robot = sim::load_robot(scenario.robot);
  sim::check(scenario, robot);
  return robot;
}

sim::RobotDescription changed(sim::RobotDescription robot, const RobotChange& change) {
  if (change) change(robot);
  return robot;
}

}  // namespace

HostFactory in_process(const std::filesystem::path& storage_file) {
  return [storage_file](std::span<const std::byte> contents) {
    return std::make_unique<InProcessHost>(contents, storage_file);
  };
}

Simulation::Simulation(const sim::Scenario& scenario, const HostFactory& make_host, const RobotChange& change)
    : scenario_(scenario),
      nominal_robot_(load_checked(scenario_)),
      robot_(changed(nominal_robot_, change)),
      model_(load_named_model(nominal_robot_)) {
  host_ = make_host(make_storage_contents(model_.image, compile_motions()));
  board_ = std::make_unique<sim::SimBoard>(robot_, sim::board_options(scenario_, robot_), *host_);
  player_ =
      std::make_unique<sim::ScenarioPlayer>(scenario_, *board_, resolve_parameters(scenario_.parameters));
}

std::vector<std::vector<std::byte>> Simulation::compile_motions() {
  const std::size_t count = scenario_.motions.size() + (scenario_.gait ? 1 : 0);
  if (count > app::kMaxMotions) {
    throw sim::InputError(scenario_.file, 0, std::to_string(count) + " motions",
                          "at most " + std::to_string(app::kMaxMotions) + ", a gait's included");
  }
  std::vector<std::vector<std::byte>> motions;
  for (const auto& file : scenario_.motions) motions.push_back(compile_motion(file, model_));
  if (scenario_.gait)
    motions.push_back(compile_gait(read_gait(scenario_.gait->file, scenario_.gait->overrides)));
  return motions;
}

// What a gait brings into the scenario besides its motion: the plan to judge it by, the gains of its
// feedback, and a robot that begins in its stand.
std::vector<std::byte> Simulation::compile_gait(const Gait& gait) {
  gait_plan_.emplace(gait);
  const MotionSource motion = make_gait_motion(gait, nominal_robot_, model_);
  if (scenario_.initial.joints.empty()) {
    const PoseSource& stand = motion.poses.front();
    for (std::size_t joint = 0; joint < stand.angles.size(); ++joint) {
      scenario_.initial.joints.push_back(
          {{model_.joint_names[joint], gait.file, 0}, fixed::to_double(*stand.angles[joint])});
    }
  }
  if (scenario_.gait->feedback) {
    const auto add = [&](const char* name, double gain_s) {
      scenario_.parameters.push_back({{name, gait.file, 0}, gain_s});
    };
    add("feedback_ankle_pitch_s", gait.feedback.ankle_pitch_s);
    add("feedback_ankle_roll_s", gait.feedback.ankle_roll_s);
    add("feedback_hip_roll_s", gait.feedback.hip_roll_s);
    add("feedback_knee_s", gait.feedback.knee_s);
  }
  return compile_motion(motion, model_);
}

}  // namespace koboshi::tools
