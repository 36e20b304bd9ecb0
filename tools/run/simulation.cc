#include "tools/run/simulation.h"

#include <utility>

#include "sim_board/robot/load.h"
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

HostFactory in_process() {
  return [](std::span<const std::byte> contents) { return std::make_unique<InProcessHost>(contents); };
}

Simulation::Simulation(const sim::Scenario& scenario, const HostFactory& make_host, const RobotChange& change)
    : scenario_(scenario),
      nominal_robot_(load_checked(scenario_)),
      robot_(changed(nominal_robot_, change)),
      model_(load_named_model(nominal_robot_)) {
  std::vector<sim::SdoWrite> parameters = resolve_parameters(scenario_.parameters);
  std::vector<std::vector<std::byte>> motions;
  for (const auto& file : scenario_.motions) motions.push_back(compile_motion(file, model_));
  host_ = make_host(make_storage_contents(model_.image, motions));
  board_ = std::make_unique<sim::SimBoard>(robot_, sim::board_options(scenario_, robot_), *host_);
  player_ = std::make_unique<sim::ScenarioPlayer>(scenario_, *board_, std::move(parameters));
}

}  // namespace koboshi::tools
