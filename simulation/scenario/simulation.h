#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "sim_board/board/controller_host.h"
#include "sim_board/board/sim_board.h"
#include "sim_board/scenario/player.h"
#include "simulation/scenario/prepared_scenario.h"

namespace koboshi::simulation {

// Makes the host of the firmware for a board whose storage holds these contents.
using HostFactory =
    std::function<std::unique_ptr<sim::ControllerHost>(std::span<const std::byte> storage_contents)>;

// The firmware in this process, its storage in a file if one is named (FlashMemory).
[[nodiscard]] HostFactory in_process(const std::filesystem::path& storage_file = {});

// What makes the robot in the world another than its file says, such as heavier. Names, numbers and order of
// links and joints stay.
using RobotChange = std::function<void(sim::RobotDescription&)>;

// A scenario made ready to run: the robot's files read, its motions compiled, firmware and board put
// together.
class Simulation {
 public:
  // The firmware and its motions are made for the robot as its file describes it, whatever `change` makes of
  // the one in the world. Throws sim::InputError for whatever a file of the scenario has wrong, and what
  // `make_host` throws.
  explicit Simulation(const sim::Scenario& scenario, const HostFactory& make_host = in_process(),
                      const RobotChange& change = {});

  void advance() { player_->advance(); }
  bool finished() const { return player_->finished(); }
  // What an operator does besides the scenario (sim::ScenarioPlayer).
  void command(const sim::Command& command) { player_->command(command); }
  void push(const sim::Push& push) { player_->push(push); }
  // Throws sim::InputError as resolve_parameters does.
  void write(const sim::ParameterSetting& setting);
  // The scenario's and the operator's, in the order of time.
  const std::vector<sim::Push>& pushes() const { return player_->pushes(); }
  // The scenario as it was played so far: with what the operator did, and nobody to do more.
  sim::Scenario played() const;

  const sim::Scenario& scenario() const { return prepared_.scenario; }
  // The one in the world.
  const sim::RobotDescription& robot() const { return robot_; }
  const NamedModel& model() const { return prepared_.model; }
  // What the gait of the scenario intends; null without one.
  const GaitPlan* gait_plan() const { return prepared_.gait_plan ? &*prepared_.gait_plan : nullptr; }
  sim::SimBoard& board() { return *board_; }
  const sim::SimBoard& board() const { return *board_; }

 private:
  const PreparedScenario prepared_;
  const sim::RobotDescription robot_;
  std::unique_ptr<sim::ControllerHost> host_;
  std::unique_ptr<sim::SimBoard> board_;
  std::unique_ptr<sim::ScenarioPlayer> player_;
};

}  // namespace koboshi::simulation
