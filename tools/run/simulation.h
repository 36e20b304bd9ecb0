#pragma once

#include <memory>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "sim_board/scenario/player.h"
#include "sim_board/scenario/scenario.h"
#include "tools/model/robot_model.h"
#include "tools/run/in_process_host.h"

namespace koboshi::tools {

// A scenario made ready to run: the robot's files read, its motions compiled, firmware and board put
// together.
class Simulation {
 public:
  // Throws sim::InputError for whatever a file of the scenario has wrong.
  explicit Simulation(const sim::Scenario& scenario);

  void advance() { player_->advance(); }
  bool finished() const { return player_->finished(); }

  const sim::Scenario& scenario() const { return scenario_; }
  const sim::RobotDescription& robot() const { return robot_; }
  const NamedModel& model() const { return model_; }
  const app::Controller& controller() const { return host_->controller(); }
  sim::SimBoard& board() { return *board_; }
  const sim::SimBoard& board() const { return *board_; }

 private:
  const sim::Scenario scenario_;
  const sim::RobotDescription robot_;
  const NamedModel model_;
  std::unique_ptr<InProcessHost> host_;
  std::unique_ptr<sim::SimBoard> board_;
  std::unique_ptr<sim::ScenarioPlayer> player_;
};

}  // namespace koboshi::tools
