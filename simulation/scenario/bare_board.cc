#include "simulation/scenario/bare_board.h"

#include "sim_board/input/error.h"
#include "sim_board/scenario/reader.h"

namespace koboshi::simulation {
namespace {

const sim::Scenario& without_controller(const sim::Scenario& scenario) {
  const char* found = !scenario.commands.empty()     ? "commands"
                      : !scenario.parameters.empty() ? "parameters"
                      : !scenario.motions.empty()    ? "motions"
                      : scenario.gait                ? "a gait"
                                                     : nullptr;
  if (found != nullptr)
    throw sim::InputError(scenario.file, 0, found,
                          "none of them: a board without controller has no use for them");
  return scenario;
}

}  // namespace

void BareBoard::NoController::exchange(const hal::BatchInput&, hal::BatchOutput& output) {
  output = {};
  output.watchdog_kicked = true;
  output.drive_enabled = true;
}

BareBoard::BareBoard(const sim::Scenario& scenario)
    : scenario_(without_controller(scenario)), robot_(sim::read_robot(scenario_)) {
  sim::BoardOptions options = sim::board_options(scenario_, robot_);
  options.sensors_on_bus = true;
  board_ = sim::make_board(scenario_, robot_, options, host_);
  board_->unplug_controller();
  player_ = std::make_unique<sim::ScenarioPlayer>(scenario_, *board_);
}

}  // namespace koboshi::simulation
