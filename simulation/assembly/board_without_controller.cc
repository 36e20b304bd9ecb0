#include "simulation/assembly/board_without_controller.h"

#include <fmt/format.h>

#include "base/text/error.h"
#include "simulation/assembly/plant.h"
#include "simulation/assembly/world.h"
#include "simulation/model/bus_load.h"
#include "simulation/scenario/reader.h"

namespace koboshi::simulation {
namespace {

const Scenario& without_controller(const Scenario& scenario) {
  check_without_controller(scenario);
  return scenario;
}

// A board with its sensors on the bus carries more than one with the controller's own.
const sim_board::RobotDescription& checked(const sim_board::RobotDescription& robot) {
  const double load = bus_load(robot.joints.size(), true).longest;
  if (load <= kMaxBusLoad) return robot;
  throw InputError(robot.file, robot.line,
                   fmt::format("{} drives, which load the bus together with the sensors by up to {:.1f} %",
                               robot.joints.size(), 100.0 * load),
                   fmt::format("at most {:.0f} %", 100.0 * kMaxBusLoad));
}

}  // namespace

void check_without_controller(const Scenario& scenario) {
  const char* found = !scenario.commands.empty()     ? "commands"
                      : !scenario.parameters.empty() ? "parameters"
                      : !scenario.motions.empty()    ? "motions"
                      : scenario.gait                ? "a gait"
                                                     : nullptr;
  if (found != nullptr)
    throw InputError(scenario.file, 0, found, "none of them: a board without controller has no use for them");
}

void BoardWithoutController::NoController::exchange(const hal::BatchInput&, hal::BatchOutput& output) {
  output = {};
  output.watchdog_kicked = true;
  output.drive_enabled = true;
}

BoardWithoutController::BoardWithoutController(const Scenario& scenario)
    : scenario_(without_controller(scenario)), robot_(robot_in_world(scenario_)) {
  Scenario in_world = scenario_;
  if (const auto world = draw_world(scenario_, robot_)) {
    apply(*world, robot_);
    apply(*world, in_world);
  }
  sim_board::BoardOptions options = board_options(in_world, checked(robot_));
  options.sensors_on_bus = true;
  board_ = make_board(in_world, robot_, options, host_);
  board_->electronics().unplug_controller();
  player_ = std::make_unique<ScenarioPlayer>(scenario_, *board_);
}

}  // namespace koboshi::simulation
