#pragma once

#include <memory>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "sim_board/scenario/player.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::simulation {

// The robot of a scenario without a controller: drives and sensors on their bus, for an external CANopen
// master. The drive-enable line, which no bus carries, is high.
class BareBoard {
 public:
  // Throws sim::InputError for an error in a file of the scenario, and for a scenario with commands or
  // parameters for a controller.
  explicit BareBoard(const sim::Scenario& scenario);

  void advance() { player_->advance(); }
  bool finished() const { return player_->finished(); }
  sim::SimBoard& board() { return *board_; }
  const sim::SimBoard& board() const { return *board_; }
  const sim::Scenario& scenario() const { return scenario_; }
  const sim::RobotDescription& robot() const { return robot_; }
  const std::vector<sim::Push>& pushes() const { return player_->pushes(); }

 private:
  // Replaces the firmware.
  class NoController final : public sim::ControllerHost {
    void exchange(const hal::BatchInput&, hal::BatchOutput& output) override;
    void archive(sim::StateArchive&) override {}
  };

  const sim::Scenario scenario_;
  const sim::RobotDescription robot_;
  NoController host_;
  std::unique_ptr<sim::SimBoard> board_;
  std::unique_ptr<sim::ScenarioPlayer> player_;
};

}  // namespace koboshi::simulation
