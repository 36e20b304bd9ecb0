#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sim_board/board/controller_host.h"
#include "sim_board/board/sim_board.h"
#include "sim_board/scenario/player.h"
#include "simulation/scenario/prepared_scenario.h"
#include "simulation/scenario/snapshot.h"

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
  // Saves the state between two calls of advance(). A simulation that is restored goes on to the same bits as
  // one that was never interrupted. Throws sim::NotSaveable, with one line, where a part of the simulation is
  // outside of this process: firmware in QEMU, a bus that is bridged to a live one, a recorder of files.
  Snapshot snapshot();
  // Goes back, or forth, to a snapshot of this simulation, any number of times. Throws std::logic_error for a
  // snapshot of another simulation or from before a reset(), and where the companions or the nodes on the bus
  // are others than then.
  void restore(const Snapshot& snapshot);
  // Makes a companion part of each snapshot. It must outlive the simulation or be detached before.
  void attach(Companion& companion) { companions_.push_back(&companion); }
  void detach(const Companion& companion) { std::erase(companions_, &companion); }

  // Begins the scenario anew with another seed, without reading and compiling its files again: the run is, to
  // the bit, that of a Simulation that was made with this seed. References to board, bus and world end here,
  // and so does what an operator has added. Throws std::logic_error while a companion is attached.
  void reset(std::uint64_t seed);

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
  void power_on();

  PreparedScenario prepared_;
  const sim::RobotDescription robot_;
  const HostFactory make_host_;
  std::unique_ptr<sim::ControllerHost> host_;
  std::unique_ptr<sim::SimBoard> board_;
  std::unique_ptr<sim::ScenarioPlayer> player_;
  std::vector<Companion*> companions_;
  std::shared_ptr<const Snapshot::Run> run_ = std::make_shared<Snapshot::Run>();
};

}  // namespace koboshi::simulation
