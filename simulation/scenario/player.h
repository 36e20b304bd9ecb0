#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "sim_board/board/sim_board.h"
#include "simulation/scenario/operator_pc.h"
#include "simulation/scenario/scenario.h"

namespace koboshi::simulation {

// Returns the options of world and board for a scenario that has been checked against the robot.
sim_board::BoardOptions board_options(const Scenario& scenario, const sim_board::RobotDescription& robot);

// Makes the board. Throws InputError, which names the scenario, if its physics engine refuses the robot or
// the ground.
std::unique_ptr<sim_board::SimBoard> make_board(const Scenario& scenario,
                                                const sim_board::RobotDescription& robot,
                                                const sim_board::BoardOptions& options,
                                                sim_board::ControllerHost& host);

// Applies a scenario to a board at the given times: commands from the operator's PC, faults, pushes, and the
// release of the stand. An operator may add commands and pushes during the run.
class ScenarioPlayer final : private sim_board::StepListener {
 public:
  // Scenario and board must outlive the player. The scenario has been checked against the board's robot.
  // `parameters` are the scenario's parameters as SDO writes, sent before the first command.
  ScenarioPlayer(const Scenario& scenario, sim_board::SimBoard& board, std::vector<SdoWrite> parameters = {});
  ~ScenarioPlayer() { board_.set_step_listener(nullptr); }
  ScenarioPlayer(const ScenarioPlayer&) = delete;
  ScenarioPlayer& operator=(const ScenarioPlayer&) = delete;

  // Advances board and scenario by one millisecond. Throws what the board throws, and SdoFailed.
  void advance() {
    act();
    board_.advance();
  }
  // Does what the scenario and the operator do at the present time, for an owner who advances the board
  // itself. Throws SdoFailed.
  void act();
  bool finished() const { return board_.now_us() >= scenario_.duration_us; }

  // Takes effect at the next advance(), like a command of the scenario at the present time.
  void command(Command command);
  void push(Push push);
  // Sends a set of the joint target stream (OperatorPc::stream). It is not a part of commands().
  void stream(const StreamSet& set) { operator_.stream(set); }
  // Writes a controller parameter by SDO; commands wait for it. `advance` throws SdoFailed if the controller
  // refuses it.
  void write(SdoWrite write) { operator_.write(std::move(write)); }
  // Begins a fault at the next advance(). It has been checked against the board's robot.
  // Precondition: not kBabblingNode, whose node must be on the bus from the start.
  void fault(Fault fault);
  // Accesses an object of a node by SDO.
  void request(ObjectRequest request) { operator_.request(std::move(request)); }
  [[nodiscard]] std::vector<ObjectAnswer> take_answers() { return operator_.take_answers(); }
  // The scenario's and the operator's commands, in order of time.
  const std::vector<Command>& commands() const { return commands_; }
  const std::vector<Push>& pushes() const { return pushes_; }
  const std::vector<Fault>& faults() const { return faults_; }

  // Excludes the board, which has its own archive function.
  void archive(sim_board::StateArchive& archive);

 private:
  void schedule(std::size_t fault);
  void before_step(sim_board::World& world, std::uint64_t start_us, std::uint64_t end_us) override;
  void cause(const Fault& fault);
  void disturb_frames(const Fault& fault);
  void add_babbler(const Fault& fault);
  void mend(const Fault& fault);
  std::size_t joint_of(const Fault& fault) const;

  const Scenario& scenario_;
  sim_board::SimBoard& board_;
  OperatorPc operator_;
  std::vector<Command> commands_;
  std::vector<Push> pushes_;
  std::vector<Fault> faults_;
  std::vector<int> pushed_links_;  // indexed by push
  std::size_t next_command_ = 0;
  // Beginning or end of a fault, in order of time; at equal times the ends come first.
  struct FaultEvent {
    std::uint64_t at_us;
    bool begins;
    std::size_t fault;
  };
  std::vector<FaultEvent> fault_events_;
  std::size_t next_fault_event_ = 0;
  bool held_;
};

}  // namespace koboshi::simulation
