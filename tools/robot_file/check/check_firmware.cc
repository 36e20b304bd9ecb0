// Finds robots that the firmware cannot run, R028, R029, and what it cannot do with others, R040.

#include "simulation/assembly/robot_parameters.h"
#include "simulation/model/abilities.h"
#include "simulation/model/robot_model.h"
#include "simulation/scenario/reader.h"
#include "tools/robot_file/check/checked_model.h"

namespace koboshi::tools {
namespace {

void add_error(CheckedModel& model, const char* code, const InputError& error) {
  model.add(code, simulation::Severity::kError, {.line = error.line()}, error.found(), error.expected());
}

}  // namespace

void check_firmware(CheckedModel& model) {
  const std::vector<InputError> errors = simulation::find_model_errors(model.robot);
  for (const InputError& error : errors) add_error(model, "R028", error);
  if (!errors.empty()) return;
  const simulation::NamedModel named = simulation::load_named_model(model.robot);
  for (const simulation::LostAbility& lost : simulation::find_lost_abilities(named.model)) {
    const bool walks = lost.ability != robot::Ability::kWalking;
    model.add("R040", walks ? simulation::Severity::kNote : simulation::Severity::kWarning,
              {.line = model.robot.line}, lost.found, lost.expected);
  }
  try {
    const simulation::RobotParameters parameters = simulation::read_robot_parameters(model.robot.file);
    simulation::check(parameters, model.robot);
    static_cast<void>(simulation::compile_robot_parameters(parameters, named.model));
  } catch (const InputError& error) {
    add_error(model, "R029", error);
    model.last().file = error.file();
  }
}

}  // namespace koboshi::tools
