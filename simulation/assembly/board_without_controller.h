#pragma once

#include <memory>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "simulation/scenario/player.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Throws InputError for a scenario with commands, parameters, motions or a gait, which need a controller.
void check_without_controller(const Scenario& scenario);

// The robot of a scenario without a controller: drives and sensors on their bus, for an external CANopen
// master. The drive-enable line, which no bus carries, is high.
class BoardWithoutController {
 public:
  // Throws InputError for an error in a file of the scenario, and for a scenario with commands or
  // parameters for a controller.
  explicit BoardWithoutController(const Scenario& scenario);

  void advance() { player_->advance(); }
  bool finished() const { return player_->finished(); }
  sim_board::SimBoard& board() { return *board_; }
  const sim_board::SimBoard& board() const { return *board_; }
  const Scenario& scenario() const { return scenario_; }
  const sim_board::RobotDescription& robot() const { return robot_; }
  const std::vector<Push>& pushes() const { return player_->pushes(); }

 private:
  // Replaces the firmware.
  class NoController final : public sim_board::ControllerHost {
    void exchange(const hal::BatchInput&, hal::BatchOutput& output) override;
    void archive(sim_board::StateArchive&) override {}
  };

  const Scenario scenario_;
  sim_board::RobotDescription robot_;  // in the world
  NoController host_;
  std::unique_ptr<sim_board::SimBoard> board_;
  std::unique_ptr<ScenarioPlayer> player_;
};

}  // namespace koboshi::simulation
