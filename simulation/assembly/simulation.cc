#include "simulation/assembly/simulation.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/text/error.h"
#include "base/text/text.h"
#include "simulation/assembly/parameters.h"
#include "simulation/assembly/world.h"

namespace koboshi::simulation {
namespace {

using Prepared = std::shared_ptr<const PreparedScenario>;

std::shared_ptr<const sim_board::RobotDescription> changed(const Prepared& prepared,
                                                           const RobotChange& change) {
  if (!change) return {prepared, &prepared->robot_in_world()};
  auto robot = std::make_shared<sim_board::RobotDescription>(prepared->robot_in_world());
  change(*robot);
  return robot;
}

// The parts in the order of their states in a snapshot.
struct Parts {
  void archive(sim_board::StateArchive& archive) {
    archive(board, player);
    for (Companion* companion : companions) archive(*companion);
  }

  sim_board::SimBoard& board;
  ScenarioPlayer& player;
  std::span<Companion* const> companions;
};

}  // namespace

Simulation::Simulation(const Scenario& scenario, const HostFactory& make_host, const RobotChange& change)
    : Simulation(std::make_shared<const PreparedScenario>(prepare(scenario)), scenario.seed, make_host,
                 change) {}

Simulation::Simulation(Prepared prepared, std::uint64_t seed, const HostFactory& make_host,
                       const RobotChange& change)
    : prepared_(std::move(prepared)),
      scenario_(prepared_->scenario),
      robot_before_draw_(changed(prepared_, change)),
      make_host_(make_host) {
  scenario_.seed = seed;
  power_on();
}

void Simulation::power_on() {
  host_ = make_host_(prepared_->storage_contents);
  robot_ = robot_before_draw_;
  world_ = draw_world(scenario_, *robot_before_draw_);
  Scenario in_world = scenario_;
  if (world_) {
    auto robot = std::make_shared<sim_board::RobotDescription>(*robot_before_draw_);
    apply(*world_, *robot);
    apply(*world_, in_world);
    robot_ = std::move(robot);
  }
  board_ = make_board(in_world, *robot_, board_options(in_world, *robot_), *host_);
  player_ = std::make_unique<ScenarioPlayer>(scenario_, *board_, resolve_parameters(scenario_.parameters));
}

void Simulation::stream(const StreamSet& set) {
  const std::size_t joints = robot_->joints.size();
  const auto is_right = [&](const std::vector<double>& values) {
    return values.size() == joints &&
           std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  if (!is_right(set.targets_rad) ||
      !(set.torque_limits_percent.empty() || is_right(set.torque_limits_percent)))
    throw std::invalid_argument("found a set with other values, expected " + std::to_string(joints) +
                                " finite numbers, one for each joint");
  for (const double percent : set.torque_limits_percent)
    if (percent < 1.0 || percent > 100.0)
      throw std::invalid_argument("found a torque limit of " + number_text(percent) +
                                  " percent, expected 1 to 100");
  player_->stream(set);
}

void Simulation::write(const ParameterSetting& setting) {
  for (SdoWrite& write : resolve_parameters(std::span(&setting, 1))) player_->write(std::move(write));
}

void Simulation::reset(std::uint64_t seed) {
  if (!companions_.empty())
    throw std::logic_error("a simulation is reset while observers are attached to it");
  player_.reset();
  board_.reset();
  host_.reset();
  run_ = std::make_shared<Snapshot::Run>(*run_);
  scenario_.seed = seed;
  power_on();
}

Snapshot Simulation::snapshot() {
  Snapshot snapshot;
  snapshot.run_ = run_;
  snapshot.companions_.assign(companions_.begin(), companions_.end());
  snapshot.time_us_ = board_->now_us();
  Parts parts{*board_, *player_, companions_};
  snapshot.state_ = sim_board::StateArchive::save(parts);
  return snapshot;
}

void Simulation::restore(const Snapshot& snapshot) {
  if (snapshot.run_->simulation != run_->simulation)
    throw std::logic_error(
        "found a snapshot of another simulation, expected one that this simulation has made");
  if (snapshot.run_ != run_)
    throw std::logic_error(
        "found a snapshot from before the last reset of this simulation, expected one from after it");
  if (!std::ranges::equal(snapshot.companions_, companions_))
    throw std::logic_error("a snapshot was taken with other observers attached than there are now");
  Parts parts{*board_, *player_, companions_};
  sim_board::StateArchive::restore(snapshot.state_, parts);
}

void Simulation::fault(const Fault& fault) {
  if (fault.kind == Fault::Kind::kBabblingNode)
    throw InputError("faults", 0, "babbling_node", "a kind of fault that can begin during a run");
  player_->fault(fault);
}

Scenario Simulation::played() const {
  Scenario played = scenario_;
  played.teleop = false;
  played.duration_us = board_->now_us();
  played.commands = player_->commands();
  played.pushes = player_->pushes();
  played.faults = player_->faults();
  return played;
}

}  // namespace koboshi::simulation
