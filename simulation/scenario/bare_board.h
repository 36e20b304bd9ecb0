#pragma once

#include <memory>

#include "sim_board/board/sim_board.h"
#include "sim_board/scenario/player.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::simulation {

// The robot of a scenario without a controller: drives and sensors on their bus, for whatever CANopen master
// comes. Its drive-enable line, which no bus carries, is high.
class BareBoard {
 public:
  // Throws sim::InputError for whatever a file of the scenario has wrong, and for a scenario that tells a
  // controller what to do: there is none.
  explicit BareBoard(const sim::Scenario& scenario);

  void advance() { player_->advance(); }
  bool finished() const { return player_->finished(); }
  sim::SimBoard& board() { return *board_; }

 private:
  // In place of the firmware.
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
