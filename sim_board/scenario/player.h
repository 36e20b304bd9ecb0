#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "sim_board/scenario/operator_pc.h"
#include "sim_board/scenario/scenario.h"

namespace koboshi::sim {

// World and board as a scenario asks for them. The scenario has been checked against the robot.
BoardOptions board_options(const Scenario& scenario, const RobotDescription& robot);

// Does to a board what its scenario says, each thing in its time: commands from the operator's PC, faults,
// pushes, and letting go of the stand. An operator who takes part in the run may command and push besides.
class ScenarioPlayer final : private StepListener {
 public:
  // Scenario and board must outlive the player. The scenario has been checked against the board's robot.
  // `parameters` are the scenario's, as the controller knows them; they are set before the first command.
  ScenarioPlayer(const Scenario& scenario, SimBoard& board, std::vector<SdoWrite> parameters = {});
  ~ScenarioPlayer() { board_.set_step_listener(nullptr); }
  ScenarioPlayer(const ScenarioPlayer&) = delete;
  ScenarioPlayer& operator=(const ScenarioPlayer&) = delete;

  // One millisecond of board and scenario. Throws what the board throws, and SdoFailed.
  void advance();
  bool finished() const { return board_.now_us() >= scenario_.duration_us; }

  // With the next advance(), as if it stood in the scenario with the time that it is now.
  void command(Command command);
  void push(Push push);
  // Sets a parameter of the controller by SDO; commands wait until it is set. `advance` throws SdoFailed if
  // the controller refuses it.
  void write(SdoWrite write) { operator_.write(std::move(write)); }
  // The scenario's and these, in the order of time.
  const std::vector<Command>& commands() const { return commands_; }
  const std::vector<Push>& pushes() const { return pushes_; }

  // Not of the board.
  void archive(StateArchive& archive) {
    archive(operator_, commands_, pushes_, pushed_links_, next_command_, next_fault_event_, held_);
  }

 private:
  void before_step(World& world, std::uint64_t start_us, std::uint64_t end_us) override;
  void cause(const Fault& fault);
  void disturb_frames(const Fault& fault);
  void add_babbler(const Fault& fault);
  void mend(const Fault& fault);
  std::size_t joint_of(const Fault& fault) const;

  const Scenario& scenario_;
  SimBoard& board_;
  OperatorPc operator_;
  std::vector<Command> commands_;
  std::vector<Push> pushes_;
  std::vector<int> pushed_links_;  // by push
  std::size_t next_command_ = 0;
  // Faults begin and end; in the order of time, of equal times the ends first.
  struct FaultEvent {
    std::uint64_t at_us;
    bool begins;
    std::size_t fault;
  };
  std::vector<FaultEvent> fault_events_;
  std::size_t next_fault_event_ = 0;
  bool held_;
};

}  // namespace koboshi::sim
