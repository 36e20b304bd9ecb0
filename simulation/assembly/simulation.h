#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim_board/board/controller_host.h"
#include "sim_board/board/sim_board.h"
#include "simulation/assembly/prepared_scenario.h"
#include "simulation/assembly/snapshot.h"
#include "simulation/disturbance/disturbed_world.h"
#include "simulation/host/host_factory.h"
#include "simulation/scenario/player.h"

namespace koboshi::simulation {

// Modifies the robot in the world, for example its mass. Names, number and order of links and joints must
// stay.
using RobotChange = std::function<void(sim_board::RobotDescription&)>;

// A scenario ready to run: files read, motions compiled, firmware and board connected.
class Simulation {
 public:
  // Firmware and motions are compiled for the robot in its file; `change` affects only the robot in the
  // world. Throws InputError for an error in a file of the scenario, and what `make_host` throws.
  explicit Simulation(const Scenario& scenario, const HostFactory& make_host = in_process(),
                      const RobotChange& change = {});
  // The same with files that are already read and compiled, and another seed. Simulations may share them, in
  // any threads: nobody writes to them.
  Simulation(std::shared_ptr<const PreparedScenario> prepared, std::uint64_t seed,
             const HostFactory& make_host = in_process(), const RobotChange& change = {});

  void advance() { player_->advance(); }
  bool finished() const { return player_->finished(); }
  // Adds an operator's command to those of the scenario (ScenarioPlayer).
  void command(const Command& command) { player_->command(command); }
  void push(const Push& push) { player_->push(push); }
  // Sends a set of the joint target stream, which a command has begun: one target for each joint of the
  // robot, and as many torque limits, or none. The firmware follows it from its next control cycle on if the
  // frames arrive before: on the bus of the default robot, if it was sent 3 ms before. played() does not
  // contain it. Throws std::invalid_argument for another number of values, or values that are not finite.
  void stream(const StreamSet& set);
  // Throws InputError as resolve_parameters does.
  void write(const ParameterSetting& setting);
  // Begins a fault, which has been checked against the robot, at the next advance(). Throws InputError
  // for a babbling node, which must be on the bus from the start.
  void fault(const Fault& fault);
  // Accesses an object of a node on the bus by SDO from the operator's PC. Answers come in the order of the
  // requests; a snapshot contains the requests under way.
  void request(ObjectRequest request) { player_->request(std::move(request)); }
  [[nodiscard]] std::vector<ObjectAnswer> take_answers() { return player_->take_answers(); }
  // The scenario's and the operator's pushes, in order of time.
  const std::vector<Push>& pushes() const { return player_->pushes(); }
  // Saves the state between two calls of advance(). A restored simulation continues with the same bits as an
  // uninterrupted one. Throws sim_board::NotSaveable, with one line, if a part of the state is outside this
  // process: firmware in QEMU, a bridge to a live bus, a recorder of files.
  Snapshot snapshot();
  // Restores a snapshot of this simulation, any number of times. Throws std::logic_error, which says which,
  // for a snapshot of another simulation or from before a reset(), and if the companions or the nodes on the
  // bus have changed since.
  void restore(const Snapshot& snapshot);
  // Includes a companion in each snapshot. The companion must outlive the simulation or be detached before.
  void attach(Companion& companion) { companions_.push_back(&companion); }
  void detach(const Companion& companion) { std::erase(companions_, &companion); }

  // Restarts the scenario with another seed without reading and compiling its files again. The run has the
  // same bits as a new Simulation with this seed. Discards all operator input and invalidates references to
  // robot, board, bus and world. Throws std::logic_error while a companion is attached.
  void reset(std::uint64_t seed);

  // Returns the scenario so far, including the operator's input, as a scenario without an operator. A
  // scenario cannot contain accesses to objects.
  Scenario played() const;

  const Scenario& scenario() const { return scenario_; }
  // Returns the drawn factors; null if the scenario has no world.
  const DisturbedWorld* world() const { return world_ ? &*world_ : nullptr; }
  // The robot in the world, after the change and with what the seed has drawn.
  const sim_board::RobotDescription& robot() const { return *robot_; }
  const NamedModel& model() const { return prepared_->model; }
  // Plan of the scenario's gait; null without a gait.
  const GaitPlan* gait_plan() const { return prepared_->gait_plan ? &*prepared_->gait_plan : nullptr; }
  sim_board::SimBoard& board() { return *board_; }
  const sim_board::SimBoard& board() const { return *board_; }

 private:
  void power_on();

  const std::shared_ptr<const PreparedScenario> prepared_;
  Scenario scenario_;  // the prepared one with this simulation's seed
  // The prepared one where nothing is changed.
  const std::shared_ptr<const sim_board::RobotDescription> robot_before_draw_;
  std::shared_ptr<const sim_board::RobotDescription> robot_;
  std::optional<DisturbedWorld> world_;
  const HostFactory make_host_;
  std::unique_ptr<sim_board::ControllerHost> host_;
  std::unique_ptr<sim_board::SimBoard> board_;
  std::unique_ptr<ScenarioPlayer> player_;
  std::vector<Companion*> companions_;
  std::shared_ptr<const Snapshot::Run> run_ =
      std::make_shared<Snapshot::Run>(Snapshot::Run{std::make_shared<Snapshot::Identity>()});
};

}  // namespace koboshi::simulation
