#include "simulation/scenario/simulation.h"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>

#include "simulation/host/in_process_host.h"
#include "simulation/scenario/parameters.h"

namespace koboshi::simulation {
namespace {

sim::RobotDescription changed(sim::RobotDescription robot, const RobotChange& change) {
  if (change) change(robot);
  return robot;
}

// The parts in the order of their states in a snapshot.
struct Parts {
  void archive(sim::StateArchive& archive) {
    archive(board, player);
    for (Companion* companion : companions) archive(*companion);
  }

  sim::SimBoard& board;
  sim::ScenarioPlayer& player;
  std::span<Companion* const> companions;
};

}  // namespace

HostFactory in_process(const std::filesystem::path& storage_file) {
  return [storage_file](std::span<const std::byte> contents) {
    return std::make_unique<InProcessHost>(contents, storage_file);
  };
}

Simulation::Simulation(const sim::Scenario& scenario, const HostFactory& make_host, const RobotChange& change)
    : prepared_(prepare(scenario)), robot_(changed(prepared_.robot, change)), make_host_(make_host) {
  power_on();
}

void Simulation::power_on() {
  host_ = make_host_(prepared_.storage_contents);
  board_ = std::make_unique<sim::SimBoard>(robot_, sim::board_options(prepared_.scenario, robot_), *host_);
  player_ = std::make_unique<sim::ScenarioPlayer>(prepared_.scenario, *board_,
                                                  resolve_parameters(prepared_.scenario.parameters));
}

void Simulation::write(const sim::ParameterSetting& setting) {
  for (sim::SdoWrite& write : resolve_parameters(std::span(&setting, 1))) player_->write(std::move(write));
}

void Simulation::reset(std::uint64_t seed) {
  if (!companions_.empty())
    throw std::logic_error("a simulation is reset while observers are attached to it");
  player_.reset();
  board_.reset();
  host_.reset();
  run_ = std::make_shared<Snapshot::Run>();
  prepared_.scenario.seed = seed;
  power_on();
}

Snapshot Simulation::snapshot() {
  Snapshot snapshot;
  snapshot.run_ = run_;
  snapshot.companions_.assign(companions_.begin(), companions_.end());
  snapshot.time_us_ = board_->now_us();
  Parts parts{*board_, *player_, companions_};
  snapshot.state_ = sim::StateArchive::save(parts);
  return snapshot;
}

void Simulation::restore(const Snapshot& snapshot) {
  if (snapshot.run_ != run_) throw std::logic_error("a snapshot of another simulation cannot be restored");
  if (!std::ranges::equal(snapshot.companions_, companions_))
    throw std::logic_error("a snapshot was taken with other observers attached than there are now");
  Parts parts{*board_, *player_, companions_};
  sim::StateArchive::restore(snapshot.state_, parts);
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
