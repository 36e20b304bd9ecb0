#include "simulation/scenario/simulation.h"

#include <span>
#include <utility>

#include "simulation/host/in_process_host.h"
#include "simulation/scenario/parameters.h"

namespace koboshi::simulation {
namespace {

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
    : prepared_(prepare(scenario)), robot_(changed(prepared_.robot, change)) {
  host_ = make_host(prepared_.storage_contents);
  board_ = std::make_unique<sim::SimBoard>(robot_, sim::board_options(prepared_.scenario, robot_), *host_);
  player_ = std::make_unique<sim::ScenarioPlayer>(prepared_.scenario, *board_,
                                                  resolve_parameters(prepared_.scenario.parameters));
}

void Simulation::write(const sim::ParameterSetting& setting) {
  for (sim::SdoWrite& write : resolve_parameters(std::span(&setting, 1))) player_->write(std::move(write));
}

sim::Scenario Simulation::played() const {
  sim::Scenario played = prepared_.scenario;
  played.teleop = false;
  played.duration_us = board_->now_us();
  played.commands = player_->commands();
  played.pushes = player_->pushes();
  return played;
}

}  // namespace koboshi::simulation
